//! The real recording, tracked from its keypoints: outlines of draws from the posterior over the images of four cameras.

use crate::support::outcome::Outcome;
use sinew::body::{Plan, point_positions};
use sinew::config::settings::Settings;
use sinew::core::lanes::Isa;
use sinew::formats::picture::write_png;
use sinew::input::pictures::Pictures;
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::input::silhouettes::ImageFolderOptions;
use sinew::observe::{Camera, RgbImage};
use sinew_report::overlay::Artist;
use sinew_results::tracked::Tracked;
use sinew_tests::evaluation;
use std::ops::Range;
use std::path::Path;

const FPS: f64 = 60.0;
/// Frames of the recording.
const FRAMES: Range<u64> = 0..100;
/// The frame that is shown; every fifth has images.
const SHOWN: u64 = 50;
/// Draws whose outlines are shown.
const DRAWS: usize = 32;
/// Size of the images over that of the calibrated ones.
const SCALE: f64 = 0.5;
/// Part of each image that is shown, pixels of the images; the picture has it at half the size.
const PANEL: [usize; 2] = [480, 560];
/// White between panels, pixels of the picture.
const GAP: usize = 8;

/// Whether the recording and its images are in the data folder.
pub(super) fn is_there(data: &Path) -> bool {
    ["pose2sim_single/Calib.toml", "pose2sim_silhouettes/images"].iter().all(|path| data.join(path).exists())
}

/// The picture.
pub(super) fn png(data: &Path) -> Outcome<Vec<u8>> {
    let recording = data.join("pose2sim_single");
    let options = RecordingOptions { layout: Some("BODY_25B".into()), ..RecordingOptions::default() };
    let mut recording =
        Recording::open(&recording.join("Calib.toml"), &recording.join("T01_BalancingTrial/pose"), &options)?;
    // One instruction set, so that every machine draws the same picture.
    let settings = Settings { fps: FPS, isa: Isa::baseline(), ..Settings::default() };
    let run = evaluation::run(&mut recording, FRAMES, 0..SHOWN + 1, &settings, None)?;
    let calibrated = recording.cameras().to_vec();
    let options = ImageFolderOptions {
        scale: Some(SCALE),
        frames: Some(FRAMES),
        trim: true,
        calibrated: calibrated.iter().map(|camera| camera.name.clone()).collect(),
        lag: vec![],
    };
    let mut images = Pictures::open(&data.join("pose2sim_silhouettes/images"), &calibrated, &options)?;
    let tracked = Tracked { setup: run.setup, image_scale: 1.0, lag: vec![], fps: FPS, frames: vec![] };
    let cameras = tracked.as_seen(&images.cameras(), &calibrated);
    let photos = images.frame(SHOWN)?;
    let estimate = run.filtered.last().ok_or("no frame was tracked")?;
    let states: Vec<&[f64]> = estimate.draws.states.chunks_exact(run.tree.dof()).take(DRAWS).collect();
    let drawn = outlined(&Artist::new(&tracked, cameras.clone())?, &states, &photos);
    let mut points = vec![0.0; 3 * run.tree.points().len()];
    point_positions(&Plan::with_all_points(&run.tree), Isa::baseline(), &estimate.mean_state, &mut points);
    let panels: Vec<RgbImage> =
        drawn.iter().zip(&cameras).map(|(image, camera)| panel(image, middle(camera, &points))).collect();
    let mut bytes = vec![];
    write_png(&mut bytes, &beside(&panels))?;
    Ok(bytes)
}

/// Photos with the mean of the outlines of all states over them: lines are thin where the states agree.
fn outlined(artist: &Artist, states: &[&[f64]], photos: &[Option<RgbImage>]) -> Vec<RgbImage> {
    let mut sums: Vec<Vec<[f64; 3]>> =
        photos.iter().flatten().map(|photo| vec![[0.0; 3]; photo.pixels.len()]).collect();
    for state in states {
        let mut pictures = photos.to_vec();
        artist.draw(state, &mut pictures);
        for (sum, picture) in sums.iter_mut().zip(pictures.iter().flatten()) {
            for (sum, pixel) in sum.iter_mut().zip(&picture.pixels) {
                (0..3).for_each(|k| sum[k] += f64::from(pixel[k]) / states.len() as f64);
            }
        }
    }
    let image = |(photo, sum): (&RgbImage, Vec<[f64; 3]>)| RgbImage {
        pixels: sum.into_iter().map(|pixel| pixel.map(|value| value.round() as u8)).collect(),
        ..photo.clone()
    };
    photos.iter().flatten().zip(sums).map(image).collect()
}

/// Middle of the rectangle around points of the world, pixels.
fn middle(camera: &Camera, points: &[f64]) -> [f64; 2] {
    let pixels = points.chunks_exact(3).filter_map(|p| camera.project([p[0], p[1], p[2]]).pixel());
    let (low, high) = pixels.fold(([f64::MAX; 2], [f64::MIN; 2]), |(low, high), p| {
        ([0, 1].map(|k: usize| low[k].min(p[k])), [0, 1].map(|k: usize| high[k].max(p[k])))
    });
    [0, 1].map(|k: usize| 0.5 * (low[k] + high[k]))
}

/// The part of an image around a pixel, at half the size.
fn panel(image: &RgbImage, [u, v]: [f64; 2]) -> RgbImage {
    let corner = |middle: f64, side: usize, whole: usize| {
        (middle as usize).saturating_sub(side / 2).min(whole - side.min(whole))
    };
    let [left, top] = [corner(u, PANEL[0], image.width), corner(v, PANEL[1], image.height)];
    let [width, height] = [PANEL[0].min(image.width) / 2, PANEL[1].min(image.height) / 2];
    let pixel = |x: usize, y: usize| {
        let four = [[0, 0], [0, 1], [1, 0], [1, 1]]
            .map(|[i, j]| image.pixels[(top + 2 * y + i) * image.width + left + 2 * x + j]);
        [0, 1, 2].map(|k: usize| (four.iter().map(|pixel| u32::from(pixel[k])).sum::<u32>() / 4) as u8)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    RgbImage { width, height, pixels }
}

/// Panels of one size in a row.
fn beside(panels: &[RgbImage]) -> RgbImage {
    let height = panels.iter().map(|panel| panel.height).max().unwrap_or(0);
    let width = panels.iter().map(|panel| panel.width + GAP).sum::<usize>().saturating_sub(GAP);
    let mut picture = RgbImage { width, height, pixels: vec![[255; 3]; width * height] };
    let mut left = 0;
    for panel in panels {
        for (row, pixels) in panel.pixels.chunks_exact(panel.width).enumerate() {
            picture.pixels[row * width + left..][..panel.width].copy_from_slice(pixels);
        }
        left += panel.width + GAP;
    }
    picture
}
