//! Silhouettes, edges and colours of a frame as a log density of the body's state.
//!
//! For each body and view: the outlines of all solids (the module `outline` has the geometry) become spans of pixels; spans say what hides what; measurement points of each solid are looked up in the frame's images; an
//! [`ImageScore`] turns what was found into a number. Views add up.
//!
//! Kinematics, projection and the places of points are computed for eight bodies at once, spans and look-ups for one after the other, with scratch that is used again: nothing is allocated once every thread has been here.
//!
//! The score is a step function of the state: a pixel is in or out. There is no gradient.

use crate::bit_image::{BitImage, Overlap, overlap};
use crate::colour_histogram::{Counts, Reference};
use crate::image_score::{ImageScore, Looked};
use crate::measurement::{Hiders, Hiding, Place, Points};
use crate::outline::{Eye, Outline, Project};
use crate::raster::Spans;
use crate::solid_body::{MOST_SOLIDS, SolidBody};
use crate::{Camera, Map, ObservationModel, RgbImage};
use core::ops::Range;
use sinew_body::point_positions_block;
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch, dispatch_one};
use std::sync::{Arc, Mutex, PoisonError};

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

/// A body before cameras that see silhouettes.
#[derive(Clone, Debug)]
pub struct ImageModel {
    /// The body.
    pub body: Arc<SolidBody>,
    /// Cameras with a perfect lens, sized like the images.
    pub cameras: Vec<Camera>,
    /// The weighting function.
    pub score: ImageScore,
    /// For each camera and solid the colours to be found again; cameras without an entry use no colours.
    pub colours: Arc<Vec<Vec<Option<Reference>>>>,
    /// Instruction set.
    pub isa: Isa,
}

/// Log density of the body's state given one frame's images.
#[derive(Debug)]
pub struct ImageLikelihood {
    model: ImageModel,
    eyes: Vec<Eye>,
    /// Cameras that saw something.
    views: Vec<(usize, Cues)>,
    /// Pixels of each of their silhouettes.
    pixels: Vec<u64>,
    pool: Mutex<Vec<Scratch>>,
}

impl ObservationModel for ImageModel {
    type Frame<'a> = Vec<Option<Cues>>;
    type Bound = ImageLikelihood;

    fn bind(&self, frame: Vec<Option<Cues>>) -> ImageLikelihood {
        let views = frame.into_iter().take(self.cameras.len()).enumerate();
        let views: Vec<(usize, Cues)> = views.filter_map(|(camera, cues)| Some((camera, cues?))).collect();
        ImageLikelihood {
            eyes: self.cameras.iter().map(Eye::of).collect(),
            pixels: views.iter().map(|(_, cues)| cues.silhouette.count()).collect(),
            views,
            model: self.clone(),
            pool: Mutex::default(),
        }
    }
}

impl ImageModel {
    /// Silhouettes of a body in all cameras.
    #[must_use]
    pub fn silhouettes(&self, state: &[f64]) -> Vec<BitImage> {
        let size = |camera: &Camera| camera.image_size_px.map(|x| x as usize);
        self.with_spans(state, |camera, spans, _| {
            let [width, height] = size(camera);
            let mut image = BitImage::new(width, height);
            spans.iter().for_each(|spans| spans.draw(&mut image));
            image
        })
    }

    /// Corners of the outline of each solid in each camera, pixels; `None` for solids that are not in front of it as a whole. Nearest centres last.
    #[must_use]
    pub fn outlines(&self, state: &[f64]) -> Vec<Vec<(usize, Vec<[f64; 2]>)>> {
        let pixel = |x: i32| f64::from(x) / f64::from(crate::raster::PARTS);
        self.with_spans(state, |_, _, outlines| {
            let mut seen: Vec<(usize, &Outline)> =
                outlines.iter().enumerate().filter(|(_, outline)| outline.is_seen(0)).collect();
            seen.sort_by(|(_, a), (_, b)| b.depth.0[0].total_cmp(&a.depth.0[0]));
            seen.into_iter()
                .map(|(solid, outline)| (solid, outline.corners(0).map(|corner| corner.map(pixel)).to_vec()))
                .collect()
        })
    }

    /// Colours of the visible region of each solid of a body in one camera's picture, to be found again.
    #[must_use]
    pub fn colours_of(&self, camera: usize, state: &[f64], picture: &RgbImage) -> Vec<Option<Reference>> {
        let mut scratch = Scratch::new(&self.body);
        let Some(eye) = self.cameras.get(camera).map(Eye::of) else { return vec![] };
        scratch.project_state(self, state, &eye);
        scratch.scan(self.isa, picture.width);
        scratch.hide(self.isa, self.score.hiding(), &self.body);
        let histogram = |solid: usize| {
            let mut counts = Counts::default();
            let mut points = scratch.points.clone();
            dispatch(self.isa, Place { outline: &scratch.outlines[solid], with_region: true, points: &mut points });
            let body = &scratch.bodies[0];
            if body.seen >> solid & 1 == 1 {
                points.colours(0, picture, body.hiders[solid], &body.spans, &mut counts);
            }
            counts.reference()
        };
        (0..self.body.count()).map(histogram).collect()
    }

    fn with_spans<T>(&self, state: &[f64], mut each: impl FnMut(&Camera, &[Spans], &[Outline]) -> T) -> Vec<T> {
        let mut scratch = Scratch::new(&self.body);
        let mut out = Vec::with_capacity(self.cameras.len());
        for camera in &self.cameras {
            scratch.project_state(self, state, &Eye::of(camera));
            scratch.scan(self.isa, camera.image_size_px[0] as usize);
            out.push(each(camera, &scratch.bodies[0].spans, &scratch.outlines));
        }
        out
    }
}

/// What is known of one body in one view.
#[derive(Debug, Default)]
struct Body {
    /// Pixels of each solid; none where it is not seen.
    spans: Vec<Spans>,
    hiders: Vec<Hiders>,
    /// Set of the solids that are in front of the camera as a whole.
    seen: u32,
}

/// Memory of one thread.
#[derive(Debug)]
struct Scratch {
    frames: Vec<Block>,
    plan: Vec<Block>,
    outlines: Vec<Outline>,
    points: Box<Points>,
    bodies: [Body; LANES],
    looked: Vec<[Looked; LANES]>,
    counts: Counts,
    image: BitImage,
}

impl Scratch {
    fn new(body: &SolidBody) -> Self {
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

    fn project_state(&mut self, model: &ImageModel, state: &[f64], eye: &Eye) {
        let blocks: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
        point_positions_block(&model.body.plan, model.isa, &blocks, &mut self.frames, &mut self.plan);
        self.project(model.isa, &model.body, eye);
    }

    fn project(&mut self, isa: Isa, body: &SolidBody, eye: &Eye) {
        dispatch(isa, Project { eye, solids: &body.solids, frames: &self.frames, out: &mut self.outlines });
    }

    fn scan(&mut self, isa: Isa, width: usize) {
        dispatch_one(isa, Scan { width, outlines: &self.outlines, bodies: &mut self.bodies });
    }

    fn hide(&mut self, isa: Isa, hiding: Hiding, body: &SolidBody) {
        dispatch_one(isa, Hide { hiding, body, outlines: &self.outlines, bodies: &mut self.bodies });
    }
}

/// Spans of all solids.
struct Scan<'a> {
    width: usize,
    outlines: &'a [Outline],
    bodies: &'a mut [Body; LANES],
}

impl Kernel<f64> for Scan<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (lane, body) in self.bodies.iter_mut().enumerate() {
            body.seen = 0;
            for (solid, (outline, spans)) in self.outlines.iter().zip(&mut body.spans).enumerate() {
                if outline.is_seen(lane) {
                    body.seen |= 1 << solid;
                    spans.scan(&outline.corners(lane), self.width);
                } else {
                    spans.scan(&[], self.width);
                }
            }
        }
    }
}

/// What may hide what.
struct Hide<'a> {
    hiding: Hiding,
    body: &'a SolidBody,
    outlines: &'a [Outline],
    bodies: &'a mut [Body; LANES],
}

impl Kernel<f64> for Hide<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (lane, body) in self.bodies.iter_mut().enumerate() {
            for (solid, outline) in self.outlines.iter().enumerate() {
                let columns = body.spans[solid].columns();
                let mut middle = 0;
                for (other, spans) in body.spans.iter().enumerate() {
                    // An edge point may lie in a pixel next to those that its solid covers.
                    let overlaps = spans.columns().start <= columns.end && columns.start <= spans.columns().end;
                    let may_hide = match self.hiding {
                        Hiding::Nearer => self.outlines[other].depth.0[lane] < outline.depth.0[lane],
                        Hiding::Others => other != solid,
                    };
                    middle |= u32::from(overlaps && may_hide) << other;
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
struct LookUp<'a> {
    solid: usize,
    outline: &'a Outline,
    points: &'a Points,
    bodies: &'a [Body; LANES],
    cues: &'a Cues,
    colours: Option<&'a Reference>,
    counts: &'a mut Counts,
    hides_region: bool,
    /// Whether the region is looked up at all; not where whole silhouettes are compared.
    with_region: bool,
    looked: &'a mut [Looked; LANES],
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
            let of_region = if self.hides_region { hiders } else { Hiders::default() };
            if self.with_region {
                looked.region = self.points.region(lane, silhouette, of_region, &body.spans);
            }
            looked.edges = edges.as_ref().map(|map| self.points.edges(lane, map, hiders, &body.spans));
            if let (Some(reference), Some(picture)) = (self.colours, picture) {
                *self.counts = Counts::default();
                self.points.colours(lane, picture, of_region, &body.spans, self.counts);
                looked.colour = Some(reference.matched(self.counts));
            }
        }
    }
}

/// Compares the pixels of each body with a silhouette.
struct Compare<'a> {
    bodies: &'a [Body; LANES],
    silhouette: &'a BitImage,
    pixels_of_silhouette: u64,
    image: &'a mut BitImage,
    out: &'a mut [Overlap; LANES],
}

impl Kernel<f64> for Compare<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        for (body, out) in self.bodies.iter().zip(&mut *self.out) {
            let used = body.spans.iter().map(Spans::columns).filter(|columns| !columns.is_empty());
            let columns = used.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end)).unwrap_or_default();
            self.image.clear(columns.clone());
            body.spans.iter().for_each(|spans| spans.draw(self.image));
            let inside = overlap(self.silhouette, self.image, columns);
            *out = Overlap { first_only: self.pixels_of_silhouette - inside.both, ..inside };
        }
    }
}

impl ImageLikelihood {
    /// Whether its score is made for solids one by one, so that the value of a solid is its factor of the whole.
    #[must_use]
    pub const fn is_of_parts(&self) -> bool {
        matches!(self.model.score, ImageScore::Parts)
    }

    /// Number of cameras that saw something.
    #[must_use]
    pub fn views(&self) -> usize {
        self.views.len()
    }

    /// Pixels of the silhouette and of each of eight bodies, view by view.
    pub fn overlaps_block(&self, x: &[Block], mut each: impl FnMut(usize, &[Overlap; LANES])) {
        self.with_scratch(x, |scratch| {
            for ((camera, cues), &pixels_seen) in self.views.iter().zip(&self.pixels) {
                scratch.project(self.model.isa, &self.model.body, &self.eyes[*camera]);
                scratch.scan(self.model.isa, cues.silhouette.width());
                each(*camera, &self.compare(scratch, cues, pixels_seen));
            }
        });
    }

    fn compare(&self, scratch: &mut Scratch, cues: &Cues, pixels_of_silhouette: u64) -> [Overlap; LANES] {
        let silhouette = &cues.silhouette;
        if (scratch.image.width(), scratch.image.height()) != (silhouette.width(), silhouette.height()) {
            scratch.image = BitImage::new(silhouette.width(), silhouette.height());
        }
        let mut out = [Overlap::default(); LANES];
        let kernel = Compare {
            bodies: &scratch.bodies,
            silhouette,
            pixels_of_silhouette,
            image: &mut scratch.image,
            out: &mut out,
        };
        dispatch_one(self.model.isa, kernel);
        out
    }

    /// Lends the scratch of a thread, with the frames of the solids of these bodies.
    fn with_scratch<T>(&self, x: &[Block], work: impl FnOnce(&mut Scratch) -> T) -> T {
        let pooled = self.pool.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut scratch = pooled.unwrap_or_else(|| Scratch::new(&self.model.body));
        let body = &self.model.body;
        point_positions_block(&body.plan, self.model.isa, x, &mut scratch.frames, &mut scratch.plan);
        let out = work(&mut scratch);
        self.pool.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
        out
    }

    /// Shows what was looked up of some solids to `each`, view by view.
    fn look(
        &self,
        x: &[Block],
        solids: Range<usize>,
        with_region: bool,
        mut each: impl FnMut(&[[Looked; LANES]], Option<&[Overlap; LANES]>),
    ) {
        let ImageModel { body, score, colours, isa, .. } = &self.model;
        self.with_scratch(x, |scratch| {
            for ((camera, cues), &pixels_seen) in self.views.iter().zip(&self.pixels) {
                scratch.project(*isa, body, &self.eyes[*camera]);
                scratch.scan(*isa, cues.silhouette.width());
                scratch.hide(*isa, score.hiding(), body);
                for solid in solids.clone() {
                    let outline = &scratch.outlines[solid];
                    dispatch(*isa, Place { outline, with_region, points: &mut scratch.points });
                    let kernel = LookUp {
                        solid,
                        outline,
                        points: &scratch.points,
                        bodies: &scratch.bodies,
                        cues,
                        colours: colours.get(*camera).and_then(|of| of.get(solid)?.as_ref()),
                        counts: &mut scratch.counts,
                        hides_region: score.hiding() == Hiding::Nearer,
                        with_region,
                        looked: &mut scratch.looked[solid],
                    };
                    dispatch_one(*isa, kernel);
                }
                let pixels = (!with_region).then(|| self.compare(scratch, cues, pixels_seen));
                each(&scratch.looked[solids.clone()], pixels.as_ref());
            }
        });
    }
}

impl LogDensity for ImageLikelihood {
    fn dim(&self) -> usize {
        self.model.body.dof()
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        self.log_density_block(&block, &mut []).0[0]
    }

    fn log_density_block(&self, x: &[Block], _ws: &mut [Block]) -> Block {
        let score = &self.model.score;
        let mut out = Block::ZERO;
        let parts = &mut [Looked::default(); MOST_SOLIDS][..self.model.body.count()];
        self.look(x, 0..self.model.body.count(), !score.counts_pixels(), |looked, pixels| {
            for (lane, out) in out.0.iter_mut().enumerate() {
                parts.iter_mut().zip(looked).for_each(|(part, looked)| *part = looked[lane]);
                *out += score.of_view(parts, pixels.map(|pixels| pixels[lane]));
            }
        });
        out
    }
}

impl PartLogDensity for ImageLikelihood {
    fn parts(&self) -> usize {
        self.model.body.count()
    }

    fn log_density_parts_block(&self, parts: Range<usize>, x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        let score = &self.model.score;
        out.fill(Block::ZERO);
        self.look(x, parts, true, |looked, _| {
            for (out, looked) in out.iter_mut().zip(looked) {
                for (out, looked) in out.0.iter_mut().zip(looked) {
                    *out += score.of_part(looked);
                }
            }
        });
    }
}
