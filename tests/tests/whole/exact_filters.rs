//! Filters and samplers against exact answers, in reduced size: particle filters (E2, E3), the HMC filter (E4), the growth model (E6), eight modes (E7), volume laws (E8, E9), the camera point. The functions take a seed and a size, so that longer runs call the same.

use sinew_tests::camera_point::CameraPoint;
use sinew_tests::depth_flip::Arm;
use sinew_tests::evidence::{error_slope, stored_table, unbiased};
use sinew_tests::finding::demand;
use sinew_tests::growth::{Growth, two_modes};
use sinew_tests::linear_series::Series;
use sinew_tests::mixture_filter::against_ideal;
use sinew_tests::static_posteriors::{camera_point_chains, gaussian_volume_law, tempered_depth_flip, volume_law};

/// `evidence-unbiased`, 80 runs of 400: every scheme with every threshold.
#[test]
fn evidence_is_unbiased_under_every_scheme_and_threshold() {
    let Some(series) = Series::stored("lgssm_d2.json") else { return };
    demand(&unbiased(&series, 250, 80, 1));
}

/// Evidence and means of the bootstrap filter (E2).
#[test]
fn the_bootstrap_filter_has_the_stored_errors() {
    let Some(series) = Series::stored("lgssm_d2.json") else { return };
    demand(&stored_table(&series, 20, 2));
}

/// Order of the error (E3), to N = 16 000.
#[test]
fn the_error_of_particles_falls_with_the_root_of_their_number() {
    let Some(series) = Series::stored("lgssm_d2.json") else { return };
    demand(&[error_slope(&series, 3, 12, 3)]);
}

/// The HMC filter with the mixture prior (E4), d = 2 with 250 and d = 10 with 250 chains; 1000 chains are left to the longer run.
#[test]
fn the_mixture_filter_is_as_good_as_ideal_draws() {
    for (file, stored, runs) in [("lgssm_d2.json", 0.125, 5), ("lgssm_d10.json", 0.27, 2)] {
        let Some(series) = Series::stored(file) else { return };
        demand(&against_ideal(&series, file, 250, stored, runs, 4));
    }
}

/// Growth model with two modes (E6).
#[test]
fn both_modes_of_the_growth_model_are_kept() {
    let Some(growth) = Growth::stored() else { return };
    demand(&two_modes(&growth, 5000, 250, 3, 6));
}

/// Tempered sequential Monte Carlo on eight modes (E7).
#[test]
fn tempered_smc_finds_eight_modes_with_their_masses() {
    let Some(arm) = Arm::stored() else { return };
    demand(&tempered_depth_flip(&arm, 2000, 3, 7));
}

/// Volume laws of boxes (E8) and Gaussians (E9).
#[test]
fn particles_obey_the_volume_laws() {
    demand(&volume_law(1000, 4000, 8));
    demand(&gaussian_volume_law(1_000_000, 9));
}

/// `camera-point`: 9 statistics at |z| < 4.
#[test]
fn chains_have_the_moments_of_the_camera_point() {
    let Some(point) = CameraPoint::stored() else { return };
    demand(&camera_point_chains(&point, 2000, 10));
}
