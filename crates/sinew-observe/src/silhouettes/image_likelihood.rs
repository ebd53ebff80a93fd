//! Silhouettes, edges and colours of a frame as a log density of the body's state.
//!
//! For each body and view: the outlines of all solids (the module `outline` has the geometry) become spans of pixels; spans say what hides what; measurement points of each solid are looked up in the frame's images; an
//! [`ImageScore`] turns what was found into a number. Views add up.
//!
//! Kinematics, projection and the places of points are computed for eight bodies at once, spans and look-ups for one after the other, with scratch that is used again: nothing is allocated once every thread has been here.
//!
//! The score is a step function of the state: a pixel is in or out. There is no gradient.

use crate::silhouettes::bit_image::{BitImage, Overlap};
use crate::silhouettes::colour_histogram::{Counts, Reference};
pub use crate::silhouettes::image_lookup::Cues;
use crate::silhouettes::image_lookup::{Compare, LookUp, Scratch};
use crate::silhouettes::image_score::{ImageScore, Looked};
use crate::silhouettes::measurement::{Hiding, Place};
use crate::silhouettes::outline::{Eye, Outline};
use crate::silhouettes::raster::Spans;
use crate::silhouettes::solid_body::{MOST_SOLIDS, SolidBody};
use crate::{Camera, ObservationModel, RgbImage};
use sinew_body::point_positions_block;
use sinew_core::density::{Global, LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa, LANES, dispatch, dispatch_one};
use std::sync::{Arc, Mutex, PoisonError};

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
        let pixel = |x: i32| f64::from(x) / f64::from(crate::silhouettes::raster::PARTS);
        self.with_spans(state, |_, _, outlines| {
            let mut seen: Vec<(usize, &Outline)> =
                outlines.iter().enumerate().filter(|(_, outline)| outline.is_seen(0)).collect();
            seen.sort_by(|(_, a), (_, b)| b.depth.0[0].total_cmp(&a.depth.0[0]));
            seen.into_iter()
                .map(|(solid, outline)| (solid, outline.corners(0).map(|corner| corner.map(pixel)).to_vec()))
                .collect()
        })
    }

    /// Colours of the visible region of each solid of a body in one camera's picture.
    #[must_use]
    pub fn colours_of(&self, camera: usize, state: &[f64], picture: &RgbImage) -> Vec<Counts> {
        let mut scratch = Scratch::new(&self.body);
        let Some(eye) = self.cameras.get(camera).map(Eye::of) else { return vec![] };
        scratch.project_state(self.isa, &self.body, state, &eye);
        let all = &ALL[..self.body.count()];
        scratch.hide(self.isa, self.score.hiding(), &self.body, all);
        scratch.scan_hiders(self.isa, all, picture.width);
        let histogram = |solid: usize| {
            let mut counts = Counts::default();
            let mut points = scratch.points.clone();
            dispatch(self.isa, Place { outline: &scratch.outlines[solid], with_region: true, points: &mut points });
            let body = &scratch.bodies[0];
            if body.seen >> solid & 1 == 1 {
                points.colours(0, picture, body.hiders[solid], &body.spans, &mut counts);
            }
            counts
        };
        (0..self.body.count()).map(histogram).collect()
    }

    fn with_spans<T>(&self, state: &[f64], mut each: impl FnMut(&Camera, &[Spans], &[Outline]) -> T) -> Vec<T> {
        let mut scratch = Scratch::new(&self.body);
        let mut out = Vec::with_capacity(self.cameras.len());
        for camera in &self.cameras {
            scratch.project_state(self.isa, &self.body, state, &Eye::of(camera));
            scratch.scan(self.isa, camera.image_size_px[0] as usize);
            out.push(each(camera, &scratch.bodies[0].spans, &scratch.outlines));
        }
        out
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

    /// Shows the spans of eight bodies to `each`, view by view, with the number of the camera and its silhouette.
    pub(crate) fn each_view(&self, x: &[Block], mut each: impl FnMut(&mut Scratch, usize, &BitImage)) {
        self.with_scratch(x, |scratch| {
            for (camera, cues) in &self.views {
                scratch.project(self.model.isa, &self.model.body, &self.eyes[*camera]);
                scratch.scan(self.model.isa, cues.silhouette.width());
                each(scratch, *camera, &cues.silhouette);
            }
        });
    }

    pub(crate) fn isa(&self) -> Isa {
        self.model.isa
    }

    fn compare(&self, scratch: &mut Scratch, cues: &Cues, pixels_of_silhouette: u64) -> [Overlap; LANES] {
        let silhouette = &cues.silhouette;
        scratch.image.fit(silhouette);
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

    /// Shows what was looked up of some solids, no more than there are, to `each`, view by view.
    fn look(
        &self,
        x: &[Block],
        solids: &[usize],
        with_region: bool,
        mut each: impl FnMut(&[[Looked; LANES]], Option<&[Overlap; LANES]>),
    ) {
        let ImageModel { body, score, colours, isa, .. } = &self.model;
        self.with_scratch(x, |scratch| {
            for ((camera, cues), &pixels_seen) in self.views.iter().zip(&self.pixels) {
                scratch.project(*isa, body, &self.eyes[*camera]);
                scratch.hide(*isa, score.hiding(), body, solids);
                match with_region {
                    true => scratch.scan_hiders(*isa, solids, cues.silhouette.width()),
                    false => scratch.scan(*isa, cues.silhouette.width()),
                }
                for (place, &solid) in solids.iter().enumerate() {
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
                        looked: &mut scratch.looked[place],
                    };
                    dispatch_one(*isa, kernel);
                }
                let pixels = (!with_region).then(|| self.compare(scratch, cues, pixels_seen));
                each(&scratch.looked[..solids.len()], pixels.as_ref());
            }
        });
    }
}

/// The numbers of all solids that a body may have.
const ALL: [usize; MOST_SOLIDS] = {
    let mut all = [0; MOST_SOLIDS];
    let mut solid = 0;
    while solid < MOST_SOLIDS {
        all[solid] = solid;
        solid += 1;
    }
    all
};

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
        let count = self.model.body.count();
        let parts = &mut [Looked::default(); MOST_SOLIDS][..count];
        self.look(x, &ALL[..count], !score.counts_pixels(), |looked, pixels| {
            for (lane, out) in out.0.iter_mut().enumerate() {
                parts.iter_mut().zip(looked).for_each(|(part, looked)| *part = looked[lane]);
                *out += score.score_view(parts, pixels.map(|pixels| pixels[lane]));
            }
        });
        out
    }
}

impl PartLogDensity for ImageLikelihood {
    fn parts(&self) -> usize {
        self.model.body.count()
    }

    /// The alignment of silhouettes, whatever the score.
    fn global_block(&self, x: &[Block], _ws: &mut [Block]) -> Global {
        self.alignment_block(x)
    }

    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        let score = &self.model.score;
        out.fill(Block::ZERO);
        self.look(x, parts, true, |looked, _| {
            for (out, looked) in out.iter_mut().zip(looked) {
                for (out, looked) in out.0.iter_mut().zip(looked) {
                    *out += score.score_part(looked);
                }
            }
        });
    }
}
