//! Masks and pictures of every sequence that experiments use.
//! The person is in all views, and the same seed gives the same pixels.

use sinew_body::points::{Trajectories, points_of_states};
use sinew_motion::convert;
use sinew_motion::recorded::from_points;
use sinew_tests::combo::{Sequence, TURN_RADIUS_M, comfortable_radius_m, synthetic_combo};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::Level;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::recorded_motion::{recorded, recorded_combo};

const RATE_HZ: f64 = 30.0;

fn walk(duration_s: f64) -> Trajectories {
    let walker = Walker::new(Gait { duration_s, ..Gait::default() });
    points_of_states(&walker.body, &walker_states(&walker, RATE_HZ))
}

fn footage(motion: Trajectories) -> SyntheticFootage {
    SyntheticFootage::new(motion, RATE_HZ, &Ring::SMALL_PICTURES, 3).unwrap()
}

/// Pixels of a silhouette at least, where a person stays within 4 m and where the cameras stand back for 8 m.
const LEAST_PIXELS: [u64; 2] = [250, 100];

/// No pixel of a silhouette is at the border of an image, and there are enough of them.
fn is_in_all_views(name: &str, motion: Trajectories, least: u64) {
    let footage = footage(motion);
    for frame in (0..footage.frames()).step_by(4) {
        for (camera, calibrated) in footage.cameras.iter().enumerate() {
            let silhouette = footage.silhouette(camera, frame);
            let (width, height) = (silhouette.width(), silhouette.height());
            let at_border = (0..width).any(|x| silhouette.get(x, 0) || silhouette.get(x, height - 1))
                || (0..height).any(|y| silhouette.get(0, y) || silhouette.get(width - 1, y));
            assert!(!at_border, "{name}: frame {frame} leaves {}", calibrated.name);
            assert!(silhouette.count() > least, "{name}: {} pixels in frame {frame}", silhouette.count());
        }
    }
}

#[test]
fn synthetic_people_are_in_all_views() {
    is_in_all_views("walk", walk(5.0), LEAST_PIXELS[0]);
    is_in_all_views("synthetic CMB", synthetic_combo(RATE_HZ).unwrap().motion, LEAST_PIXELS[0]);
}

#[test]
fn recorded_people_are_in_all_views() {
    let Some(folder) = sinew_tests::data::shared("cmu_amc") else { return };
    for (name, skeleton) in [
        ("07_01", "07"),
        ("07_02", "07"),
        ("07_05", "07"),
        ("09_06", "09"),
        ("131_04", "131"),
        ("49_18", "49"),
        ("charleston1", "charleston"),
        ("01_01", "01"),
        ("135_06", "135"),
    ] {
        let [motion, skeleton] = [format!("{name}.amc"), format!("{skeleton}.asf")].map(|file| folder.join(file));
        is_in_all_views(name, recorded(&motion, &skeleton, RATE_HZ).unwrap(), LEAST_PIXELS[0]);
    }
    let radii: [&dyn Fn(&Trajectories) -> f64; 2] =
        [&|_| TURN_RADIUS_M, &|motion| comfortable_radius_m(motion, RATE_HZ)];
    for ((radius_m, widest_m), least) in radii.into_iter().zip([4.0, 8.0]).zip(LEAST_PIXELS) {
        let Sequence { name, motion, phases, .. } = recorded_combo(&folder, RATE_HZ, radius_m).unwrap();
        assert_eq!((name.as_str(), phases.len()), ("CMB", 3));
        let [low, high] = motion.bounds().unwrap();
        assert!((0..2).all(|i| high[i] - low[i] < widest_m) && low[2] > -0.1, "{low:?} {high:?}");
        is_in_all_views("CMB", motion, least);
    }
}

/// A foreign skeleton of another unit is the same person: BVH against the ASF/AMC that it was made from, where they agree.
#[test]
fn a_skeleton_of_others_has_the_same_legs() {
    let Some(folder) = sinew_tests::data::shared("cmu_amc") else { return };
    let bvh = folder.with_file_name("cmu_bvh").join("01_01.bvh");
    let bvh = convert::read(&bvh, None, None).unwrap();
    let (bvh, unit) = from_points(&bvh.points().unwrap(), bvh.rate_hz, false, 120.0).unwrap();
    assert_eq!(unit, Some("CMU's unit"));
    let amc = recorded(&folder.join("01_01.amc"), &folder.join("01.asf"), 120.0).unwrap();
    for name in ["LKnee", "RKnee", "LAnkle", "RAnkle"] {
        let [a, b] = [&bvh, &amc].map(|found| found.index(name).unwrap());
        for frame in [0, 700, 2000] {
            let (p, q) = (bvh.frames[frame + 1][a], amc.frames[frame][b]);
            assert!((0..3).all(|i| (p[i] - q[i]).abs() < 1e-4), "{name}: {p:?} {q:?}");
        }
    }
}

#[test]
fn a_frame_alone_is_the_frame_in_sequence() {
    let (whole, again) = (footage(walk(1.0)), footage(walk(1.0)));
    let masks: Vec<_> = (0..30).map(|frame| whole.mask(1, frame, Level::Hard)).collect();
    assert_eq!(again.mask(1, 29, Level::Hard), masks[29]);
    assert_eq!(again.mask(1, 7, Level::Hard), masks[7]);
    assert_eq!(again.picture(2, 7), whole.picture(2, 7));
    assert!(masks[7] != masks[8]);
    let other = SyntheticFootage::new(walk(1.0), RATE_HZ, &Ring::SMALL_PICTURES, 4).unwrap();
    assert!(other.mask(1, 7, Level::Clean) != whole.mask(1, 7, Level::Clean));
    // Cameras err apart from each other, and a level keeps what is clean below it.
    assert_eq!(whole.mask(0, 3, Level::Clean), whole.silhouette(0, 3));
}

/// Share of a frame's silhouette that segmentation gets wrong: little where it is normal, more where it is hard.
#[test]
fn levels_are_ordered() {
    let footage = footage(walk(2.0));
    let wrong = |level| {
        let (mut wrong, mut all) = (0, 0);
        for frame in (0..footage.frames()).step_by(10) {
            for camera in 0..4 {
                let (clean, mask) = (footage.silhouette(camera, frame), footage.mask(camera, frame, level));
                let differs = |&(x, y): &(usize, usize)| clean.get(x, y) != mask.get(x, y);
                wrong += (0..240).flat_map(|y| (0..320).map(move |x| (x, y))).filter(differs).count();
                all += clean.count() as usize;
            }
        }
        wrong as f64 / all as f64
    };
    let (normal, hard) = (wrong(Level::Normal), wrong(Level::Hard));
    assert!((0.05..0.35).contains(&normal) && hard > 1.5 * normal, "{normal} {hard}");
}
