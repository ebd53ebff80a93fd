//! Masks and images of a real recording: counts of pixels that were taken when the masks were made.

use sinew::formats::calib_toml;
use sinew::input::pictures::Pictures;
use sinew::input::silhouettes::{ImageFolderOptions, Silhouettes};
use sinew_tests::data::shared;
use std::path::PathBuf;

fn folder() -> Option<PathBuf> {
    shared("pose2sim_silhouettes")
}

#[test]
fn masks_have_the_pixels_that_they_were_made_with() {
    let Some(folder) = folder() else { return };
    let calibration = std::fs::read_to_string(folder.join("Calib.toml")).unwrap();
    let cameras = calib_toml::read("Calib.toml", &calibration).unwrap().cameras;
    let options = ImageFolderOptions { scale: Some(0.5), ..ImageFolderOptions::default() };
    let mut silhouettes = Silhouettes::open(&folder.join("silhouettes"), &cameras, &options).unwrap();
    assert_eq!(silhouettes.frames(), 0..100);
    for (frame, counts) in
        [(0, [42499, 26258, 43353, 46302]), (50, [38605, 33234, 39423, 38883]), (99, [46715, 35101, 32934, 30119])]
    {
        let masks = silhouettes.frame(frame).unwrap();
        let found: Vec<u64> = masks.iter().flatten().map(|mask| mask.count()).collect();
        assert_eq!(found, counts);
        assert_eq!(masks[0].as_ref().map(|mask| [mask.width(), mask.height()]), Some([540, 960]));
        assert_eq!(masks[3].as_ref().map(|mask| [mask.width(), mask.height()]), Some([544, 960]));
    }
    let warnings = silhouettes.warnings();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(
        warnings[0].ends_with("calibrated at 1088x1920, times 0.5 is 544x960, masks are 540x960; taken as they are")
    );

    let mut pictures = Pictures::open(&folder.join("images"), &cameras, &options).unwrap();
    assert_eq!(pictures.numbers(), (0..100).step_by(5).collect::<Vec<_>>());
    let images = pictures.frame(95).unwrap();
    assert!(images.iter().flatten().count() == 4);
    // As libjpeg-turbo decodes it, to the rounding of the cosine transform.
    let first = pictures.frame(0).unwrap()[0].clone().unwrap();
    for ([x, y], wanted) in
        [([0, 0], [1, 2, 0]), ([270, 480], [149, 160, 143]), ([539, 959], [5, 1, 0]), ([100, 700], [69, 79, 70])]
    {
        let found = first.pixels[y * first.width + x];
        assert!((0..3).all(|c| found[c].abs_diff(wanted[c]) <= 6), "{found:?} for {wanted:?} at {x}, {y}");
    }
    // A decoder that goes astray leaves images grey, black or white.
    for image in images.iter().flatten() {
        let grey = image.grey();
        let mean = grey.values.iter().sum::<f32>() / grey.values.len() as f32;
        let contrast = grey.values.iter().map(|value| (value - mean).abs()).sum::<f32>() / grey.values.len() as f32;
        assert!((0.1..0.9).contains(&mean) && contrast > 0.05, "{mean} {contrast}");
    }
}
