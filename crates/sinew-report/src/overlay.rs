//! Pictures of tracked bodies: solids and joints of each frame's mean pose over what the cameras saw.
//!
//! Outlines are computed for a camera with a perfect lens and then bent by the lens, in short pieces, so that they lie in the image as it was taken; joints are projected through the lens at once. The person's left, right and middle have a
//! colour each ([`colour_of`]); of several people, everybody has one colour and a number.

mod drawing;
pub(crate) mod error;
mod everybody;

pub use error::OverlayError;

use crate::Error;
use drawing::{disc, line, number};
use everybody::colour_of_person;
use rayon::prelude::*;
use sinew::input::image_folder;
use sinew::input::lag::ClockLag;
use sinew::input::pictures::Pictures;
use sinew::input::silhouettes::Silhouettes;
use sinew_core::lanes::Isa;
use sinew_formats::picture;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::silhouettes::image_likelihood::ImageModel;
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, Lens, RgbImage};
use sinew_results::claim;
use sinew_results::tracked::{self, Tracked};
use sinew_setup::posed_body::pose;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What bodies are drawn on.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Ground {
    /// Images of this folder.
    Images(PathBuf),
    /// Masks of this folder, in grey.
    Silhouettes(PathBuf),
    /// Black.
    #[default]
    Black,
}

/// What to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayRequest {
    /// Calibration of the run.
    pub calibration: PathBuf,
    /// Background.
    pub ground: Ground,
    /// Size of the pictures over that of the calibrated images.
    pub scale: Option<f64>,
    /// Frames, by number; all if `None`.
    pub frames: Option<Range<u64>>,
    /// Every n-th of them.
    pub every: usize,
}

/// What was drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// Pictures written.
    pub pictures: u64,
    /// Frames of a camera that were left out, since there is no image or mask.
    pub lacking: u64,
    /// What is odd.
    pub warnings: Vec<String>,
}

/// Left or right half of a body, or neither.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Left,
    Right,
    Middle,
}

impl Side {
    /// By how names of links (`l_thigh`, `left_thigh`) and points (`LKnee`) begin.
    fn of(name: &str) -> Self {
        let begins = |word: &str, letter: char| {
            let mut letters = name.chars();
            let is_point = letters.next() == Some(letter) && letters.next().is_some_and(char::is_uppercase);
            let lower = name.to_ascii_lowercase();
            is_point || lower.starts_with(word) || lower.starts_with(&format!("{}_", &word[..1]))
        };
        match (begins("left", 'L'), begins("right", 'R')) {
            (true, _) => Self::Left,
            (_, true) => Self::Right,
            _ => Self::Middle,
        }
    }
}

/// Colour of a link or point of that name: orange on the person's left, blue on their right, green in the middle.
#[must_use]
pub fn colour_of(name: &str) -> [u8; 3] {
    match Side::of(name) {
        Side::Left => [255, 128, 32],
        Side::Right => [64, 160, 255],
        Side::Middle => [96, 224, 96],
    }
}

/// Grey of the person and of the background in a mask.
const MASK_GREY: [u8; 2] = [112, 24];
/// Longest side of a picture for each pixel of the lines' width.
const SIDE_OF_LINE: f64 = 640.0;
/// Length of the pieces that a lens bends, pixels, and most of them in an edge.
const PIECE_PX: f64 = 4.0;
const MOST_PIECES: f64 = 256.0;

/// Draws a body.
pub struct Artist {
    tree: sinew_body::KinematicTree,
    cameras: Vec<Camera>,
    model: ImageModel,
    colours: Vec<[u8; 3]>,
    /// Number of the person, where there are several.
    person: Option<usize>,
}

impl Artist {
    /// Draws the body of a run in cameras that are sized like the pictures.
    ///
    /// # Errors
    /// A body without flesh.
    pub fn new(tracked: &Tracked, cameras: Vec<Camera>) -> Result<Self, Error> {
        let (tree, flesh) = (tracked.setup.tree(), tracked.setup.flesh()?);
        let body = SolidBody::new(&tree, &flesh).map_err(OverlayError::Solids)?;
        let perfect = |camera: &Camera| Camera { lens: Lens::default(), ..camera.clone() };
        let model = ImageModel {
            body: Arc::new(body),
            cameras: cameras.iter().map(perfect).collect(),
            score: ImageScore::Parts,
            colours: Arc::default(),
            isa: Isa::baseline(),
        };
        let colours = flesh.solids().iter().map(|solid| colour_of(&solid.name)).collect();
        Ok(Self { tree, cameras, model, colours, person: None })
    }

    /// Draws all of the body in the colour of a person, with their number.
    fn with_number(mut self, person: Option<usize>) -> Self {
        if let Some(number) = person {
            self.colours.fill(colour_of_person(number));
        }
        Self { person, ..self }
    }

    /// Draws a state into the picture of each camera; cameras without one are left out.
    pub fn draw(&self, state: &[f64], pictures: &mut [Option<RgbImage>]) {
        let outlines = self.model.outlines(state);
        let pose = pose(&self.tree, state);
        let views: Vec<_> = self.cameras.iter().zip(&outlines).zip(pictures).collect();
        views.into_par_iter().for_each(|((camera, outlines), picture)| {
            let Some(picture) = picture else { return };
            let half_width = 0.5 * (picture.width.max(picture.height) as f64 / SIDE_OF_LINE).max(1.0);
            for (solid, corners) in outlines {
                let ends = corners.iter().zip(corners.iter().cycle().skip(1));
                for (&a, &b) in ends {
                    bent(camera, [a, b], |piece| line(picture, piece, half_width, self.colours[*solid]));
                }
            }
            let mut top: Option<[f64; 2]> = None;
            for (point, at) in self.tree.points().iter().zip(&pose.points) {
                if let Some(pixel) = camera.project(*at).pixel() {
                    disc(picture, pixel, 3.0 * half_width, [0; 3]);
                    disc(
                        picture,
                        pixel,
                        2.2 * half_width,
                        self.person.map_or(colour_of(&point.name), colour_of_person),
                    );
                    top = top.filter(|top| top[1] <= pixel[1]).or(Some(pixel));
                }
            }
            if let (Some(person), Some(top)) = (self.person, top) {
                number(picture, top, half_width, person, colour_of_person(person));
            }
        });
    }
}

/// The image of a straight line behind a lens, in pieces; what the lens cannot show is left out.
fn bent(camera: &Camera, [a, b]: [[f64; 2]; 2], mut draw: impl FnMut([[f64; 2]; 2])) {
    let is_perfect = camera.lens.is_perfect();
    let pieces =
        if is_perfect { 1.0 } else { ((b[0] - a[0]).hypot(b[1] - a[1]) / PIECE_PX).ceil().clamp(1.0, MOST_PIECES) };
    let seen = |step: f64| {
        let share = step / pieces;
        let at = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
        if is_perfect {
            return Some(at);
        }
        let ray = camera.normalised_from_pixel(at);
        camera.lens.distorted(ray).map(|at| camera.pixel_from_normalised(at))
    };
    let mut before = seen(0.0);
    for step in 1..=pieces as u32 {
        let next = seen(f64::from(step));
        if let (Some(before), Some(next)) = (before, next) {
            draw([before, next]);
        }
        before = next;
    }
}

/// Where the pictures to draw on come from.
enum Source {
    Images(Pictures),
    Silhouettes(Silhouettes),
    Black(Vec<Camera>),
}

impl Source {
    fn open(
        request: &OverlayRequest,
        cameras: &[Camera],
        calibrated: Vec<String>,
        frames: Range<u64>,
        lag: Vec<(String, ClockLag)>,
    ) -> Result<Self, Error> {
        let options = image_folder::ImageFolderOptions {
            scale: request.scale,
            frames: Some(frames),
            trim: true,
            lag,
            calibrated,
        };
        Ok(match &request.ground {
            Ground::Images(folder) => Self::Images(Pictures::open(folder, cameras, &options)?),
            Ground::Silhouettes(folder) => Self::Silhouettes(Silhouettes::open(folder, cameras, &options)?),
            Ground::Black => {
                let scale = request.scale.unwrap_or(1.0);
                if !(scale > 0.0 && scale.is_finite()) {
                    return Err(OverlayError::Scale { scale }.into());
                }
                Self::Black(cameras.iter().map(|camera| camera.resized(scale)).collect())
            }
        })
    }

    fn cameras(&self) -> Vec<Camera> {
        match self {
            Self::Images(images) => images.cameras(),
            Self::Silhouettes(masks) => masks.cameras(),
            Self::Black(cameras) => cameras.clone(),
        }
    }

    fn frame(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        match self {
            Self::Images(images) => Ok(images.frame(number)?),
            Self::Silhouettes(masks) => Ok(masks.frame(number)?.iter().map(|mask| mask.as_ref().map(grey)).collect()),
            Self::Black(cameras) => Ok(cameras.iter().map(|camera| Some(black(camera))).collect()),
        }
    }

    fn warnings(&self) -> Vec<String> {
        match self {
            Self::Images(images) => images.warnings(),
            Self::Silhouettes(masks) => masks.warnings(),
            Self::Black(_) => vec![],
        }
    }
}

fn grey(mask: &BitImage) -> RgbImage {
    let (width, height) = (mask.width(), mask.height());
    let [person, ground] = MASK_GREY;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| [if mask.get(x, y) { person } else { ground }; 3]).collect();
    RgbImage { width, height, pixels }
}

fn black(camera: &Camera) -> RgbImage {
    let [width, height] = camera.image_size_px.map(|side| side.round().max(1.0) as usize);
    RgbImage { width, height, pixels: vec![[0; 3]; width * height] }
}

/// A person of several, drawn in the cameras that their set-up knows.
struct Drawer<'a> {
    tracked: &'a Tracked,
    artist: Artist,
    /// Places of these cameras among all.
    places: Vec<usize>,
}

impl<'a> Drawer<'a> {
    fn new(
        (number, tracked): &'a (Option<usize>, Tracked),
        calibration: &Path,
        all: &[Camera],
        resized: &[Camera],
    ) -> Result<Self, Error> {
        let own = tracked.cameras(calibration)?.0;
        let place = |camera: &Camera| all.iter().position(|known| known.name == camera.name);
        let places: Vec<usize> = own.iter().filter_map(place).collect();
        let seen: Vec<Camera> = places.iter().map(|&place| resized[place].clone()).collect();
        let artist = Artist::new(tracked, tracked.as_seen(&seen, &own))?.with_number(*number);
        Ok(Self { tracked, artist, places })
    }

    fn draw(&self, frame: u64, pictures: &mut [Option<RgbImage>]) {
        let Some((_, state)) = self.tracked.frames.iter().find(|(number, _)| *number == frame) else { return };
        let mut own: Vec<Option<RgbImage>> = self.places.iter().map(|&place| pictures[place].take()).collect();
        self.artist.draw(state, &mut own);
        for (&place, picture) in self.places.iter().zip(own) {
            pictures[place] = picture;
        }
    }
}

/// Cameras that anybody's set-up knows, and the names of all that are calibrated.
fn cameras_of(people: &[(Option<usize>, Tracked)], calibration: &Path) -> Result<(Vec<Camera>, Vec<String>), Error> {
    let (mut cameras, mut calibrated): (Vec<Camera>, _) = (vec![], vec![]);
    for (_, tracked) in people {
        let (own, names) = tracked.cameras(calibration)?;
        let is_new = |camera: &Camera| cameras.iter().all(|known| known.name != camera.name);
        let new: Vec<Camera> = own.into_iter().filter(is_new).collect();
        cameras.extend(new);
        calibrated = names;
    }
    Ok((cameras, calibrated))
}

/// Draws the body of each frame of a result folder, or everybody's where it has several people, and writes `<camera>_<frame>.png`; the callback `progress` gets the number of frames done, and of all.
///
/// # Errors
/// Errors of [`Tracked::read`]; images or masks that do not fit the calibration; frames without any; an output folder that holds something (unless forced), is an input or cannot be written.
pub fn overlay(
    results: &Path,
    request: &OverlayRequest,
    out: &Path,
    force: bool,
    mut progress: impl FnMut(u64, u64),
) -> Result<Drawn, Error> {
    let people = everybody::read(results)?;
    let chosen = everybody::frames(&people, request.frames.as_ref(), request.every)?;
    let (cameras, calibrated) = cameras_of(&people, &request.calibration)?;
    let all = match (chosen.first(), chosen.last()) {
        (Some(first), Some(last)) => *first..last + 1,
        _ => 0..0,
    };
    let lag = people.first().map(|(_, tracked)| tracked.lag.clone()).unwrap_or_default();
    let mut source = Source::open(request, &cameras, calibrated, all, lag)?;
    let resized = source.cameras();
    let drawer = |person| Drawer::new(person, &request.calibration, &cameras, &resized);
    let drawers = people.iter().map(drawer).collect::<Result<Vec<_>, _>>()?;
    let images = match &request.ground {
        Ground::Images(folder) | Ground::Silhouettes(folder) => Some(folder),
        Ground::Black => None,
    };
    let claim = claim(out, &tracked::inputs(results, &request.calibration, images), force)?;
    let staged = claim.staged()?;
    let mut drawn = Drawn::default();
    let total = chosen.len() as u64;
    for (done, number) in chosen.into_iter().enumerate() {
        let mut pictures = source.frame(number)?;
        drawers.iter().for_each(|drawer| drawer.draw(number, &mut pictures));
        let written = pictures.par_iter().zip(&cameras).map(|(picture, camera)| -> Result<u64, Error> {
            let Some(picture) = picture else { return Ok(0) };
            let (name, mut bytes) = (format!("{}_{number:06}.png", camera.name), Vec::new());
            picture::write_png(&mut bytes, picture).map_err(sinew::Error::io("write", &name))?;
            Ok(staged.write(&name, &bytes).map(|()| 1)?)
        });
        let written: u64 = written.collect::<Result<Vec<u64>, Error>>()?.into_iter().sum();
        drawn.pictures += written;
        drawn.lacking += cameras.len() as u64 - written;
        progress(done as u64 + 1, total);
    }
    drawn.warnings = source.warnings();
    if drawn.pictures == 0 {
        return Err(OverlayError::NoImages.into());
    }
    staged.finish(is_picture)?;
    Ok(drawn)
}

/// Whether a file is a picture that an earlier call wrote into its folder.
fn is_picture(name: &str) -> bool {
    name.ends_with(".png") && !name.contains('/')
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_observe::cameras::lens::Brown;

    #[test]
    fn sides_follow_from_names() {
        let check = |name, side| assert_eq!(Side::of(name), side, "{name}");
        for name in ["l_thigh", "left_arm", "LKnee", "LeftFoot"] {
            check(name, Side::Left);
        }
        for name in ["r_thigh", "Right hand", "RHip"] {
            check(name, Side::Right);
        }
        for name in ["spine", "Nose", "lumbar", "rib_cage", "Larynx", ""] {
            check(name, Side::Middle);
        }
    }

    /// Pieces of a bent line end where the camera sees the points of the straight one.
    #[test]
    fn bent_lines_pass_through_what_the_camera_sees() {
        let camera = Camera::look_at("C", [640.0, 480.0], 500.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0]).expect("a view");
        let lens = Camera { lens: Brown { k1: -0.2, p1: 0.003, ..Brown::default() }.into(), ..camera.clone() };
        let ends = [[-1.2, 0.3, 0.2], [1.4, 0.3, 0.2]];
        let straight = ends.map(|end| camera.project(end).pixel().expect("in front"));
        let mut pieces = vec![];
        bent(&lens, straight, |piece| pieces.push(piece));
        assert!(pieces.len() > 50);
        for (pixel, end) in [(pieces[0][0], ends[0]), (pieces[pieces.len() - 1][1], ends[1])] {
            let seen = lens.project(end).pixel().expect("in front");
            assert!((pixel[0] - seen[0]).hypot(pixel[1] - seen[1]) < 1e-9, "{pixel:?} {seen:?}");
        }
        let chord = (pieces[0][0], pieces[pieces.len() - 1][1]);
        let middle = pieces[pieces.len() / 2][0];
        let (dx, dy) = (chord.1[0] - chord.0[0], chord.1[1] - chord.0[1]);
        let off = (dx * (middle[1] - chord.0[1]) - dy * (middle[0] - chord.0[0])) / dx.hypot(dy);
        assert!(off.abs() > 0.5, "{off}");
    }
}
