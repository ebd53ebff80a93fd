//! What the program says about bad folders of masks and images.
//! Good ones are read alike in every layout.

use sinew::formats::{mask, picture};
use sinew::input::pictures::Pictures;
use sinew::input::silhouettes::{ImageFolderOptions, Silhouettes};
use sinew::observe::silhouettes::bit_image::BitImage;
use sinew::observe::{Camera, RgbImage};
use sinew_input::Error as InputError;
use std::fs;
use std::path::{Path, PathBuf};

const SIZE: [usize; 2] = [64, 48];
const FRAMES: u64 = 4;

/// Cameras `cam_01` and `cam_02` of 64 x 48 pixels.
fn cameras() -> Vec<Camera> {
    let camera =
        |name, x| Camera::look_at(name, SIZE.map(|size| size as f64), 50.0, [x, -4.0, 2.0], [0.0, 0.0, 1.0]).unwrap();
    vec![camera("cam_01", -3.0), camera("cam_02", 3.0)]
}

fn square(size: [usize; 2], side: usize) -> BitImage {
    BitImage::from_fn(size[0], size[1], |x, y| x.max(y) < side)
}

fn write(path: &Path, image: &BitImage) {
    let mut bytes = Vec::new();
    mask::write(&mut bytes, image).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

fn write_grey(path: &Path, values: &[u8], channels: usize) {
    let pixels: Vec<[u8; 3]> = match channels {
        3 => values.as_chunks::<3>().0.to_vec(),
        _ => values.iter().map(|&value| [value; 3]).collect(),
    };
    let mut bytes = Vec::new();
    picture::write_png(&mut bytes, &RgbImage { width: SIZE[0], height: SIZE[1], pixels }).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Masks by frame and camera.
type Frames = Vec<Vec<Option<BitImage>>>;

/// A folder of masks side by side: four frames of two cameras.
struct Trial(tempfile::TempDir);

impl Trial {
    fn new() -> Self {
        let trial = Self(tempfile::tempdir().unwrap());
        for (camera, frame) in [1, 2].into_iter().flat_map(|camera| (0..FRAMES).map(move |frame| (camera, frame))) {
            write(&trial.mask(camera, frame), &square(SIZE, 10 * camera as usize + frame as usize));
        }
        trial
    }

    fn root(&self) -> PathBuf {
        self.0.path().join("masks")
    }

    fn mask(&self, camera: u64, frame: u64) -> PathBuf {
        self.root().join(format!("cam{camera:02}_{frame:03}.png"))
    }

    fn all(&self, options: &ImageFolderOptions) -> Result<(Frames, Silhouettes), InputError> {
        let mut silhouettes = Silhouettes::open(&self.root(), &cameras(), options)?;
        let frames = silhouettes.frames().map(|number| silhouettes.frame(number)).collect::<Result<_, _>>()?;
        Ok((frames, silhouettes))
    }

    /// The error with its help and exit code, or the warnings.
    fn printed(&self, options: &ImageFolderOptions) -> String {
        let text = match self.all(options) {
            Ok((_, silhouettes)) => silhouettes.warnings().join("\n"),
            Err(error) => printed(error),
        };
        self.without_name(&text)
    }

    fn without_name(&self, text: &str) -> String {
        text.replace(&self.0.path().display().to_string(), "[trial]")
    }
}

fn printed(error: InputError) -> String {
    let error = sinew_report::Error::from(error);
    format!("exit {}: {error}\nhelp: {}", sinew_words::exit_code(&error), sinew_words::help(&error).unwrap_or_default())
}

fn check(name: &str, harm: impl FnOnce(&Trial), options: &ImageFolderOptions) {
    let trial = Trial::new();
    harm(&trial);
    insta::assert_snapshot!(name, trial.printed(options));
}

fn check_default(name: &str, harm: impl FnOnce(&Trial)) {
    check(name, harm, &ImageFolderOptions::default());
}

#[test]
fn both_layouts_give_the_same() {
    let flat = Trial::new();
    let (masks, silhouettes) = flat.all(&ImageFolderOptions::default()).unwrap();
    assert_eq!(silhouettes.warnings(), Vec::<String>::new());
    assert_eq!(masks[3][1].as_ref(), Some(&square(SIZE, 23)));
    for folder in ["cam1", "Cam_01_masks"] {
        let nested = Trial::new();
        for (camera, frame) in [1, 2].into_iter().flat_map(|camera| (0..FRAMES).map(move |frame| (camera, frame))) {
            let name = if camera == 1 { folder } else { "cam02" };
            let path = nested.root().join(name).join(format!("{frame}.png"));
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::rename(nested.mask(camera, frame), path).unwrap();
        }
        let (same, other) = nested.all(&ImageFolderOptions::default()).unwrap();
        assert_eq!(same, masks);
        assert_eq!(other.input_hash(), silhouettes.input_hash());
    }
}

#[test]
fn cameras_come_in_the_order_in_which_they_are_given() {
    let trial = Trial::new();
    let mut cameras = cameras();
    cameras.reverse();
    let mut silhouettes = Silhouettes::open(&trial.root(), &cameras, &ImageFolderOptions::default()).unwrap();
    assert_eq!(silhouettes.frame(0).unwrap()[0], Some(square(SIZE, 20)));
    cameras.truncate(1);
    let options =
        ImageFolderOptions { calibrated: vec!["cam_01".into(), "cam_02".into()], ..ImageFolderOptions::default() };
    let mut one = Silhouettes::open(&trial.root(), &cameras, &options).unwrap();
    assert_eq!(one.frame(0).unwrap(), [Some(square(SIZE, 20))]);
    assert_eq!(one.warnings(), Vec::<String>::new());
}

#[test]
fn the_hash_is_of_the_masks_and_their_places_alone() {
    let trial = Trial::new();
    let hash = |numbers: &[u64]| {
        let mut silhouettes = Silhouettes::open(&trial.root(), &cameras(), &ImageFolderOptions::default()).unwrap();
        numbers.iter().for_each(|number| drop(silhouettes.frame(*number).unwrap()));
        silhouettes.input_hash()
    };
    let whole = hash(&[0, 1, 2, 3]);
    assert_eq!(hash(&[3, 1, 1, 0, 2, 3, 9]), whole);
    assert_ne!(hash(&[0, 1, 2]), whole);
    fs::copy(trial.mask(1, 0), trial.mask(1, 1)).unwrap();
    assert_ne!(hash(&[0, 1, 2, 3]), whole);
}

#[test]
fn names_that_do_not_fit() {
    check_default("not_calibrated", |trial| {
        (0..FRAMES).for_each(|frame| fs::rename(trial.mask(2, frame), trial.mask(3, frame)).unwrap());
    });
    check_default("no_masks_of_a_camera", |trial| {
        (0..FRAMES).for_each(|frame| fs::remove_file(trial.mask(2, frame)).unwrap());
    });
    check_default("two_files", |trial| {
        fs::copy(trial.mask(1, 1), trial.root().join("cam01_1.png")).unwrap();
    });
    check_default("no_number", |trial| {
        fs::copy(trial.mask(1, 1), trial.root().join("overview.png")).unwrap();
    });
    check_default("two_spellings", |trial| {
        fs::copy(trial.mask(1, 1), trial.root().join("cam1_7.png")).unwrap();
    });
    check_default("empty_camera_folder", |trial| {
        fs::remove_dir_all(trial.root()).unwrap();
        fs::create_dir_all(trial.root().join("cam01_masks")).unwrap();
    });
}

#[test]
fn folders_that_do_not_fit() {
    let empty = |trial: &Trial| {
        fs::remove_dir_all(trial.root()).unwrap();
        fs::create_dir(trial.root()).unwrap();
    };
    check_default("no_masks", empty);
    check_default("no_folder", |trial| fs::remove_dir_all(trial.root()).unwrap());
    check_default("mixed_layouts", |trial| write(&trial.root().join("cam01/7.png"), &square(SIZE, 3)));
    check_default("folder_of_one_camera", |trial| {
        empty(trial);
        write(&trial.root().join("0007.png"), &square(SIZE, 3));
    });
    let stranger = ImageFolderOptions {
        calibrated: vec!["cam01".into(), "cam02".into(), "cam03".into()],
        ..ImageFolderOptions::default()
    };
    let only_others = |trial: &Trial| {
        empty(trial);
        write(&trial.mask(3, 0), &square(SIZE, 3));
    };
    check("no_camera_in_use", only_others, &stranger);
}

#[test]
fn frames_that_do_not_fit() {
    let shorten = |trial: &Trial| fs::remove_file(trial.mask(2, 3)).unwrap();
    check_default("ends_apart", shorten);
    check("ends_apart_trimmed", shorten, &ImageFolderOptions { trim: true, ..ImageFolderOptions::default() });
    check_default("hole", |trial| fs::remove_file(trial.mask(2, 1)).unwrap());
    check("fewer_than_asked", |_| {}, &ImageFolderOptions { frames: Some(2..10), ..ImageFolderOptions::default() });
    check("no_such_frames", |_| {}, &ImageFolderOptions { frames: Some(100..200), ..ImageFolderOptions::default() });
}

#[test]
fn sizes_that_do_not_fit() {
    let small = |trial: &Trial, size: [usize; 2]| {
        for (camera, frame) in [1, 2].into_iter().flat_map(|camera| (0..FRAMES).map(move |frame| (camera, frame))) {
            write(&trial.mask(camera, frame), &square(size, 5));
        }
    };
    let half = ImageFolderOptions { scale: Some(0.5), ..ImageFolderOptions::default() };
    check_default("half_size", |trial| small(trial, [32, 24]));
    check("half_size_declared", |trial| small(trial, [32, 24]), &half);
    check("double_size", |trial| small(trial, [128, 96]), &half);
    check_default("turned", |trial| small(trial, [48, 64]));
    check_default("one_of_another_size", |trial| write(&trial.mask(1, 2), &square([60, 48], 5)));
    check("scale", |_| {}, &ImageFolderOptions { scale: Some(0.0), ..ImageFolderOptions::default() });
}

#[test]
fn contents_that_are_odd() {
    check_default("all_black", |trial| write(&trial.mask(1, 2), &square(SIZE, 0)));
    check_default("inverted", |trial| {
        write(&trial.mask(1, 2), &BitImage::from_fn(SIZE[0], SIZE[1], |x, y| x.max(y) > 14));
        write(&trial.mask(1, 3), &square(SIZE, 99));
    });
    let pixels = SIZE[0] * SIZE[1];
    check_default("three_equal_channels", |trial| {
        let values: Vec<u8> = (0..pixels).map(|i| if i < 500 { 255 } else { 0 }).collect();
        write_grey(&trial.mask(2, 1), &values, 1);
    });
    check_default("values_between", |trial| {
        let values: Vec<u8> = (0..pixels).map(|i| if i < 500 { (i / 2) as u8 } else { 0 }).collect();
        write_grey(&trial.mask(2, 1), &values, 1);
    });
    check_default("labels", |trial| {
        let values: Vec<u8> = (0..pixels).map(|i| (i % 4) as u8).collect();
        write_grey(&trial.mask(2, 1), &values, 1);
    });
    check_default("colours", |trial| {
        let values: Vec<u8> = (0..3 * pixels).map(|i| if i < 9 { 0 } else { (i % 251) as u8 }).collect();
        write_grey(&trial.mask(2, 1), &values, 3);
    });
}

#[test]
fn damaged_files() {
    let cut = |trial: &Trial, frame: u64, length: usize| {
        let bytes = fs::read(trial.mask(2, frame)).unwrap();
        fs::write(trial.mask(2, frame), &bytes[..length]).unwrap();
    };
    check_default("truncated", |trial| cut(trial, 2, 60));
    check_default("empty_file", |trial| cut(trial, 0, 0));
    check_default("jpeg", |trial| fs::write(trial.mask(2, 2), b"\xFF\xD8\xFF\xE0\0\x10JFIF").unwrap());
    check_default("text", |trial| fs::write(trial.mask(2, 2), "P1 2 2 0 1 1 0").unwrap());
    check_default("checksum", |trial| {
        let mut bytes = fs::read(trial.mask(2, 2)).unwrap();
        let place = bytes.windows(4).position(|kind| kind == b"IDAT").unwrap();
        bytes[place + 8] ^= 0x40;
        fs::write(trial.mask(2, 2), bytes).unwrap();
    });
}

#[test]
fn pictures_may_be_sparse() {
    let folder = tempfile::tempdir().unwrap();
    let image = |value: u8| RgbImage { width: 64, height: 48, pixels: vec![[value, 0, 1]; 64 * 48] };
    for (camera, frame) in [(1, 0), (1, 5), (1, 10), (2, 0), (2, 10)] {
        let mut bytes = Vec::new();
        picture::write_png(&mut bytes, &image(frame)).unwrap();
        fs::write(folder.path().join(format!("cam{camera:02}_{frame:03}.png")), bytes).unwrap();
    }
    let mut pictures = Pictures::open(folder.path(), &cameras(), &ImageFolderOptions::default()).unwrap();
    assert_eq!((pictures.frames(), pictures.numbers()), (0..11, vec![0, 5, 10]));
    assert_eq!(pictures.frame(10).unwrap(), [Some(image(10)), Some(image(10))]);
    assert_eq!(pictures.frame(5).unwrap(), [Some(image(5)), None]);
    assert_eq!(pictures.frame(1).unwrap(), [None, None]);
    assert_eq!(pictures.warnings(), ["camera cam_02: 1 frames have no image although others have one (first: 5)"]);
    fs::write(folder.path().join("cam02_000.png"), b"GIF89a").unwrap();
    let error = Pictures::open(folder.path(), &cameras(), &ImageFolderOptions::default()).unwrap_err();
    insta::assert_snapshot!("not_a_picture", printed(error).replace(&folder.path().display().to_string(), "[trial]"));
}
