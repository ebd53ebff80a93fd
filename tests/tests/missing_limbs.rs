//! The benchmark of missing limbs has the published rows of nearest neighbours, to their digits.

use sinew_tests::data;
use sinew_tests::missing_limbs::{BODY, Benchmark, LEG};

#[test]
fn nearest_neighbours_have_the_published_errors() {
    let Some(folder) = data::shared("mocap35_missing") else { return };
    let benchmark = Benchmark::read(&folder).unwrap();
    assert_eq!(benchmark.training.len(), 31);
    for (missing, is_scaled, cumulative, rms_deg) in
        [(LEG, false, 14.01, 4.11), (LEG, true, 13.50, 4.44), (BODY, false, 30.89, 3.20), (BODY, true, 20.86, 2.62)]
    {
        let found = benchmark.judged(&benchmark.nearest_neighbours(&missing, is_scaled), missing);
        let rounded = |x: f64| (100.0 * x).round() / 100.0;
        assert_eq!((rounded(found.cumulative), rounded(found.rms_deg)), (cumulative, rms_deg), "{found:?}");
    }
}
