//! Laws of lenses: derivatives, inverses, domains, and the numbers of OpenCV.

use proptest::prelude::*;
use sinew_observe::cameras::lens::{Brown, Fisheye, Lens, Rational};
use sinew_observe::{Camera, Intrinsics, Projection};

/// Every lens, with coefficients from mild to so strong that the domain ends inside the image.
fn lens() -> impl Strategy<Value = Lens> {
    let decentring = || (-2e-3..2e-3, -2e-3..2e-3);
    prop_oneof![
        ([-0.4..0.4, -0.2..0.3, -0.1..0.1], decentring()).prop_map(|([k1, k2, k3], (p1, p2))| Brown {
            k1,
            k2,
            p1,
            p2,
            k3
        }
        .into()),
        ([-0.4..0.6, -0.2..0.2, -0.05..0.05], [-0.4..0.6, -0.2..0.2, -0.05..0.05], decentring())
            .prop_map(|(numerator, denominator, (p1, p2))| Rational { numerator, denominator, p1, p2 }.into()),
        [-0.2..0.1, -0.05..0.05, -0.02..0.02, -0.01..0.01].prop_map(|k| Fisheye { k }.into()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn derivatives_match_central_differences(lens in lens(), radius in 0.0..3.0, angle in 0.0..6.3) {
        let radius = f64::min(radius, 0.98 * lens.valid_radius());
        let at = [radius * f64::cos(angle), radius * f64::sin(angle)];
        let (shown, derivative) = lens.distorted_with_derivative(at).expect("inside the domain");
        prop_assert_eq!(lens.distorted(at), Some(shown));
        let h = 1e-5;
        for column in 0..2 {
            let moved = |by: f64| { let mut at = at; at[column] += by; lens.distorted(at).expect("inside the domain") };
            let differences = [moved(h), moved(-h), moved(2.0 * h), moved(-2.0 * h)];
            for row in 0..2 {
                let [a, b, c, d] = differences.map(|shown| shown[row]);
                let numeric = (8.0 * (a - b) - (c - d)) / (12.0 * h);
                let largest = derivative.iter().flatten().fold(1.0_f64, |m, x| m.max(x.abs()));
                prop_assert!((numeric - derivative[row][column]).abs() < 1e-7 * largest,
                    "{lens:?} at {at:?}: {numeric} {}", derivative[row][column]);
            }
        }
    }

    #[test]
    fn a_lens_is_undone_inside_its_domain(lens in lens(), share in 0.0..0.95, angle in 0.0..6.3) {
        let radius = share * lens.valid_radius().min(3.0);
        let at = [radius * f64::cos(angle), radius * f64::sin(angle)];
        let shown = lens.distorted(at).expect("inside the domain");
        let back = lens.undistorted(shown).expect("inside the domain");
        prop_assert!((0..2).all(|k| (back[k] - at[k]).abs() < 1e-8), "{lens:?}: {back:?} for {at:?}");
    }

    /// Up to the domain's end the radius grows; where it ends before a right angle it does not grow beyond.
    #[test]
    fn a_domain_ends_where_the_radius_stops_growing(lens in lens()) {
        let radial = match lens.distortion() {
            sinew_observe::cameras::lens::Distortion::Brown(lens) => Brown { p1: 0.0, p2: 0.0, ..*lens }.into(),
            sinew_observe::cameras::lens::Distortion::Rational(lens) => Rational { p1: 0.0, p2: 0.0, ..*lens }.into(),
            _ => lens,
        };
        let limit = radial.valid_radius();
        let radius = |share: f64| radial.distorted([share * limit.min(1e3), 0.0]).expect("inside the domain")[0];
        for k in 1..=200 {
            prop_assert!(radius(f64::from(k) / 200.0) > radius(f64::from(k - 1) / 200.0), "{lens:?}");
        }
        if limit.is_finite() {
            prop_assert_eq!(lens.distorted([1.000_001 * limit, 0.0]), None);
            let (_, derivative) = radial.distorted_with_derivative([limit, 0.0]).expect("at the end");
            let ends_at_a_pole = derivative[0][0] > 1e3;
            prop_assert!(derivative[0][0].abs() < 1e-4 || ends_at_a_pole, "{lens:?}: {derivative:?}");
        }
    }
}

/// The camera of the reference numbers.
fn camera(lens: Lens) -> Camera {
    Camera {
        name: "C".into(),
        image_size_px: [1000.0, 1200.0],
        intrinsics: Intrinsics { fx: 900.0, fy: 880.0, cx: 500.0, cy: 610.0 },
        lens,
        rotation: [
            [0.950_580_617_906_091_4, -0.302_932_713_402_637_1, -0.068_031_316_404_940_02],
            [0.283_164_960_565_073_74, 0.935_754_803_277_891_8, -0.210_191_705_950_742_88],
            [0.127_334_574_917_630_28, 0.180_540_076_694_397_76, 0.975_290_308_953_045_7],
        ],
        translation: [0.05, -0.02, 0.4],
    }
}

const POINTS: [[f64; 3]; 5] =
    [[0.1, 0.2, 1.0], [-0.55, 0.32, 1.0], [0.7, -0.45, 1.3], [0.0, 0.9, 1.1], [-1.0, -0.8, 2.0]];

#[test]
fn pixels_and_derivatives_match_opencv() {
    // cv2.projectPoints and cv2.fisheye.projectPoints of OpenCV 5.0.0 (Python, float64) with rvec = (0.2, -0.1, 0.3): pixels of all points, derivatives of the second one's by the translation.
    let references = [
        (
            (false, &[-0.05, 0.03, 0.002, -0.001][..]),
            [
                [510.3886056223535, 600.9027051156366],
                [82.45068924245322, 555.0532921328191],
                [903.7122326839426, 343.43371200403556],
                [337.04826368801093, 926.5317211634032],
                [163.05418872347377, 1.5771364317220105],
            ],
            [
                [645.014807468208, -2.588014699173862, 301.65136198692363],
                [-2.530503261414443, 639.308095892439, 39.38316699790945],
            ],
        ),
        (
            (false, &[-0.33, 0.0967, -0.00135, 0.003155, -0.00375][..]),
            [
                [510.39052148783776, 600.9011058260382],
                [109.65637370501884, 557.8927871271223],
                [874.9955813849243, 362.2762375771724],
                [345.51785619678515, 910.7861959519278],
                [218.0150812216748, 94.88136180059746],
            ],
            [
                [526.0099481954646, -10.700734660511882, 245.45176913274958],
                [-10.462940556944952, 598.1230106519488, 33.0580216997908],
            ],
        ),
        (
            (false, &[0.3, -0.08, 0.0011, -0.0007, 0.004, 0.62, -0.05, 0.012][..]),
            [
                [510.388262166383, 600.9028724645862],
                [105.55359311072687, 557.9320863516058],
                [874.6610714168644, 362.4557130692478],
                [343.92776931570893, 913.1246570791701],
                [211.21932171641964, 88.03311405529712],
            ],
            [
                [543.7364629285661, -10.841669334992089, 253.73742393138895],
                [-10.60074334977004, 602.9646026381703, 33.30076377186622],
            ],
        ),
        (
            (true, &[-0.012, 0.021, -0.015, 0.0035][..]),
            [
                [510.3887545310671, 600.9023413120251],
                [107.20109700667217, 557.9160729737046],
                [874.0857709396303, 362.66935622183894],
                [344.6417948155673, 911.7795442904055],
                [211.11889098168382, 86.48508876566166],
            ],
            [
                [539.2870455242398, -10.386242040049599, 251.68434987730282],
                [-10.15543666138181, 600.812511390858, 33.372571086057],
            ],
        ),
    ];
    for (lens, pixels, by_translation) in references {
        let camera = camera(Lens::from_coefficients(lens.0, lens.1).expect("a lens"));
        for (point, expected) in POINTS.iter().zip(pixels) {
            let found = camera.project(*point).pixel().expect("in front");
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9), "{lens:?}: {found:?} {expected:?}");
        }
        let (_, jacobian) = camera.project_with_jacobian(POINTS[1]).expect("in front");
        for (found, expected) in jacobian.iter().zip(by_translation) {
            for k in [0, 1, 2] {
                let expected: f64 = (0..3).map(|i| expected[i] * camera.rotation[i][k]).sum();
                assert!((found[k] - expected).abs() < 1e-8, "{lens:?}: {} {expected}", found[k]);
            }
        }
    }
}

#[test]
fn a_camera_refuses_what_its_lens_cannot_show() {
    let camera = Camera {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation: [0.0; 3],
        ..camera(Brown { k1: -0.3, ..Brown::default() }.into())
    };
    let limit = (1.0_f64 / 0.9).sqrt();
    assert!(camera.project([0.999 * limit, 0.0, 1.0]).pixel().is_some());
    assert_eq!(camera.project([1.001 * limit, 0.0, 1.0]), Projection::BeyondLens);
    assert_eq!(camera.project_with_jacobian([1.001 * limit, 0.0, 1.0]), None);
    assert_eq!(camera.project([0.0, 0.0, -1.0]), Projection::Behind);
    let wide = Camera { lens: Fisheye::default().into(), ..camera };
    assert!(wide.project([10.0, 0.0, 0.1]).pixel().is_some());
    assert_eq!(wide.project([10.0, 0.0, 0.0]), Projection::Behind);
}
