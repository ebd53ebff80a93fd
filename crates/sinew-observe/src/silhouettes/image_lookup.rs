//! Eight bodies in one view: spans of their solids, what hides what, what their points find.
//!
//! Kinematics and projection are computed for all eight at once, spans and look-ups for one after the other. A [`Scratch`] is the memory of one thread, used again from block to block.

use crate::silhouettes::bit_image::{BitImage, Overlap, overlap};
use crate::silhouettes::colour_histogram::{Counts, Reference};
use crate::silhouettes::image_score::Looked;
use crate::silhouettes::measurement::{Hiders, Hiding, Points};
use crate::silhouettes::outline::{Eye, Outline, Project};
use crate::silhouettes::raster::{PARTS, Spans};
use crate::silhouettes::solid_body::SolidBody;
use crate::{Map, RgbImage};
use core::ops::Range;
use sinew_body::point_positions_block;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch, dispatch_one};

/// What one camera saw in one frame, in the pixels of the model's camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Cues {
    /// The person.
    pub silhouette: BitImage,
    /// Edges, from 0 to 1.
    pub edges: Option<Map>,
    /// Colours.
    pub picture: Option<RgbImage>,
}

/// What is known of one body in one view.
#[derive(Debug, Default)]
pub(crate) struct Body {
    /// Pixels of each solid; none where it is not seen.
    pub spans: Vec<Spans>,
    pub hiders: Vec<Hiders>,
    /// Set of the solids that are in front of the camera as a whole.
    pub seen: u32,
}

/// Memory of one thread.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub frames: Vec<Block>,
    pub plan: Vec<Block>,
    pub outlines: Vec<Outline>,
    pub points: Box<Points>,
    pub bodies: [Body; LANES],
    pub looked: Vec<[Looked; LANES]>,
    pub counts: Counts,
    pub image: BitImage,
}

impl Scratch {
    pub fn new(body: &SolidBody) -> Self {
        let count = body.count();
        let one = || Body { spans: vec![Spans::default(); count], hiders: vec![Hiders::default(); count], seen: 0 };
        Self {
            frames: vec![Block::ZERO; body.frame_blocks()],
            plan: vec![Block::ZERO; body.plan.workspace()],
            outlines: vec![Outline::EMPTY; count],
            points: Box::new(Points::EMPTY),
            bodies: core::array::from_fn(|_| one()),
            looked: vec![[Looked::default(); LANES]; count],
            counts: Counts::default(),
            image: BitImage::new(0, 0),
        }
    }

    pub fn project_state(&mut self, isa: Isa, body: &SolidBody, state: &[f64], eye: &Eye) {
        let blocks: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
        point_positions_block(&body.plan, isa, &blocks, &mut self.frames, &mut self.plan);
        self.project(isa, body, eye);
    }

    pub fn project(&mut self, isa: Isa, body: &SolidBody, eye: &Eye) {
        dispatch(isa, Project { eye, solids: &body.solids, frames: &self.frames, out: &mut self.outlines });
    }

    /// Spans of all solids.
    pub fn scan(&mut self, isa: Isa, width: usize) {
        dispatch_one(isa, Scan { width, hidden: None, outlines: &self.outlines, bodies: &mut self.bodies });
    }

    /// Spans of what may hide some solids, which [`Scratch::hide`] has found.
    pub fn scan_hiders(&mut self, isa: Isa, solids: &[usize], width: usize) {
        dispatch_one(isa, Scan { width, hidden: Some(solids), outlines: &self.outlines, bodies: &mut self.bodies });
    }

    /// Finds what may hide some solids.
    pub fn hide(&mut self, isa: Isa, hiding: Hiding, body: &SolidBody, solids: &[usize]) {
        dispatch_one(isa, Hide { hiding, body, solids, outlines: &self.outlines, bodies: &mut self.bodies });
    }
}

/// Spans of all solids, or of those that may hide some.
struct Scan<'a> {
    width: usize,
    hidden: Option<&'a [usize]>,
    outlines: &'a [Outline],
    bodies: &'a mut [Body; LANES],
}

impl Kernel<f64> for Scan<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (lane, body) in self.bodies.iter_mut().enumerate() {
            let mut wanted = u32::MAX;
            if let Some(hidden) = self.hidden {
                wanted = 0;
                for &solid in hidden {
                    wanted |= body.hiders[solid].middle;
                }
            }
            body.seen = 0;
            for (solid, (outline, spans)) in self.outlines.iter().zip(&mut body.spans).enumerate() {
                let is_seen = outline.is_seen(lane);
                body.seen |= u32::from(is_seen) << solid;
                if is_seen && wanted >> solid & 1 == 1 {
                    spans.scan(&outline.corners(lane), self.width);
                } else {
                    spans.scan(&[], self.width);
                }
            }
        }
    }
}

/// What may hide some solids: what overlaps their bounds, widened by a pixel, since a point may lie in a pixel next to those that its solid covers.
struct Hide<'a> {
    hiding: Hiding,
    body: &'a SolidBody,
    solids: &'a [usize],
    outlines: &'a [Outline],
    bodies: &'a mut [Body; LANES],
}

impl Kernel<f64> for Hide<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (lane, body) in self.bodies.iter_mut().enumerate() {
            for &solid in self.solids {
                let outline = &self.outlines[solid];
                let [left, up, right, down] = outline.bounds(lane);
                let mut middle = 0;
                for (other, nearer) in self.outlines.iter().enumerate() {
                    let bounds = nearer.bounds(lane);
                    let beside = bounds[0] > right + PARTS || left > bounds[2] + PARTS;
                    let above = bounds[1] > down + PARTS || up > bounds[3] + PARTS;
                    let may_hide = match self.hiding {
                        Hiding::Nearer => nearer.depth.0[lane] < outline.depth.0[lane],
                        Hiding::Others => other != solid,
                    };
                    middle |= u32::from(may_hide && !beside && !above && nearer.is_seen(lane)) << other;
                }
                let ends = match self.hiding {
                    Hiding::Nearer => middle & !self.body.adjacent[solid],
                    Hiding::Others => middle,
                };
                body.hiders[solid] = Hiders { middle, ends };
            }
        }
    }
}

/// Looks the points of one solid up for all bodies.
pub(crate) struct LookUp<'a> {
    pub solid: usize,
    pub outline: &'a Outline,
    pub points: &'a Points,
    pub bodies: &'a [Body; LANES],
    pub cues: &'a Cues,
    pub colours: Option<&'a Reference>,
    pub counts: &'a mut Counts,
    pub hides_region: bool,
    /// Whether the region is looked up at all; not where whole silhouettes are compared.
    pub with_region: bool,
    pub looked: &'a mut [Looked; LANES],
}

impl Kernel<f64> for LookUp<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        let Cues { silhouette, edges, picture } = self.cues;
        for (lane, (body, looked)) in self.bodies.iter().zip(&mut *self.looked).enumerate() {
            *looked = Looked { edges: edges.as_ref().map(|_| Default::default()), ..Looked::default() };
            if body.seen >> self.solid & 1 == 0 || self.outline.has_sides.0[lane] == 0.0 {
                continue;
            }
            let hiders = body.hiders[self.solid];
            let region_hiders = if self.hides_region { hiders } else { Hiders::default() };
            if self.with_region {
                looked.region = self.points.region(lane, silhouette, region_hiders, &body.spans);
            }
            looked.edges = edges.as_ref().map(|map| self.points.edges(lane, map, hiders, &body.spans));
            if let (Some(reference), Some(picture)) = (self.colours, picture) {
                *self.counts = Counts::default();
                self.points.colours(lane, picture, region_hiders, &body.spans, self.counts);
                looked.colour = Some(reference.matched(self.counts));
            }
        }
    }
}

/// Draws all solids of a body into an image, where nothing is left of the one before in the columns that are used. Returns these.
#[inline(always)]
pub(crate) fn draw_union(body: &Body, image: &mut BitImage) -> Range<usize> {
    let used = body.spans.iter().map(Spans::columns).filter(|columns| !columns.is_empty());
    let columns = used.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or_default();
    image.clear(columns.clone());
    for spans in &body.spans {
        spans.draw(image);
    }
    columns
}

/// Compares the pixels of each body with a silhouette.
pub(crate) struct Compare<'a> {
    pub bodies: &'a [Body; LANES],
    pub silhouette: &'a BitImage,
    pub pixels_of_silhouette: u64,
    pub image: &'a mut BitImage,
    pub out: &'a mut [Overlap; LANES],
}

impl Kernel<f64> for Compare<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (body, out) in self.bodies.iter().zip(&mut *self.out) {
            let columns = draw_union(body, self.image);
            let inside = overlap(self.silhouette, self.image, columns);
            *out = Overlap { first_only: self.pixels_of_silhouette - inside.both, ..inside };
        }
    }
}
