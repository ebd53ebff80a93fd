"""The page `report.html`: its words, tables and curves against the files of the run."""

import numpy as np
from ledger import known
from overall import ALL, SOURCES, number
from points import columns

# Half a step of the page's curves, and the same in the sum of two.
POSITION_M, ANGLE_DEG, RESIDUAL_PX, R_HAT = 0.00025, 0.025, 0.025, 0.0005
BARS = {"each_frame’s_own_noise": "frames", "cameras": "cameras", "lags_of_clocks": "lags", "places_of_keypoints": "places", "lengths_of_the_body": "lengths", "biases_of_detectors": "biases"}
WORDS = {"noise_of_each_frame": "frames", "cameras": "cameras", "lags_of_the_cameras": "lags", "places_of_keypoints": "places", "lengths_of_the_body": "lengths", "biases_of_detectors": "biases"}


def on_page(results, name):
    return results.tables["report.html"][name].iloc[0]


def is_rounded_to(said, exact, step):
    """Whether a number is the nearest multiple of a step; halves may go either way."""
    assert abs(said / step - round(said / step)) < 1e-6, said
    assert abs(said - exact) <= 0.5 * step * (1 + 1e-6) + 1e-9, (said, exact)


def drawn(results, name):
    return results.tables["report.html curves"][name].to_numpy()


def is_drawn(results, name, exact, half_step):
    ours = drawn(results, name)
    assert np.allclose(ours, exact, rtol=0, atol=half_step * (1 + 1e-6), equal_nan=True), (name, np.nanmax(abs(ours - exact)))


@known("report.html", "run.*", source="the request; cameras of `posterior.zarr`", runs=ALL)
def the_page_says_what_was_run(results):
    is_rounded_to(on_page(results, "run.frames"), results.frames, 1)
    is_rounded_to(on_page(results, "run.seconds"), results.frames / results.fps, 0.1)
    is_rounded_to(on_page(results, "run.fps"), results.fps, 0.01)
    is_rounded_to(on_page(results, "run.cameras"), len(results.seen["camera"]), 1)


def half_widths(results, file, prefix, unit):
    table = results.tables[file]
    return 0.5 * (table[f"{prefix}q95_{unit}"] - table[f"{prefix}q05_{unit}"]).to_numpy()


@known("report.html", "known.*", source="medians of half the 90 % intervals of `joints.csv` and `angles.csv`", runs=ALL)
def the_page_says_how_well_all_is_known(results):
    joints = results.tables["joints.csv"]
    all_m = np.concatenate([half_widths(results, "joints.csv", f"{axis}_", "m") for axis in "xyz"])
    shares = np.concatenate([(joints[f"{axis}_sd_within_m"] / joints[f"{axis}_sd_m"]).to_numpy() for axis in "xyz"])
    is_rounded_to(on_page(results, "known.coordinate_mm"), 1e3 * np.median(all_m), 1)
    is_rounded_to(on_page(results, "known.within_mm"), 1e3 * np.median(all_m * shares), 1)
    is_rounded_to(on_page(results, "known.angle_deg"), np.nanmedian(half_widths(results, "angles.csv", "", "deg")), 0.1)


@known("report.html", "camera.*", source="keypoints that were read; `frames.csv`; `setup.toml`, the lag from its draws by NumPy", runs=ALL)
def the_page_says_what_cameras_show(results):
    pixels = np.isfinite(results.seen["pixel"][..., 0]).any(-1)
    constants = {row["name"]: row["value"] + np.array(row["draws"]) for row in results.setup.get("lasting", {}).get("number", [])}
    for index, name in enumerate(results.seen["camera"]):
        camera = next(camera for camera in results.setup["camera"] if camera["name"] == name)
        expected = {
            "frames.0": (pixels[:, index].sum(), 1),
            "residual_px.0": (results.tables["frames.csv"][f"residual_{name}_px"].median(), 0.1),
            "offset_px.0": (camera["offset_px"][0], 0.1),
            "offset_px.1": (camera["offset_px"][1], 0.1),
            "noise_px.0": (camera["sigma_px"], 0.1),
            "exchanged_percent.0": (100 * camera["exchanged"], 0.1),
            "elsewhere_percent.0": (100 * camera["elsewhere"], 0.1),
        }
        if constants:
            lags = {other: constants[f"{other}.lag_s"] for other in results.seen["camera"]}
            later = 1e3 * (lags[name] - np.mean(list(lags.values()), axis=0))
            expected |= {"later_ms.0": (later.mean(), 0.1), "later_ms.1": (later.std(), 0.1)}
        for what, (exact, step) in expected.items():
            is_rounded_to(on_page(results, f"camera.{name}.{what}"), exact, step)


@known("report.html", "source.*", "joint.*", source="`summary.json`: shares of the variance, none below zero", runs=("filtered", "smoothed"))
def the_page_says_where_uncertainty_comes_from(results):
    names = results.draws["marker"]
    shares = {source: np.array([number(results, f"uncertainty.joints.{name}.{source}") for name in names]) for source in SOURCES}
    sds = np.array([number(results, f"uncertainty.joints.{name}.sd_m") for name in names])
    for word, source in WORDS.items():
        is_rounded_to(on_page(results, f"source.{word}"), 100 * (shares[source] * sds**2).sum() / (sds**2).sum(), 1)
    total = sum(np.maximum(share, 0) for share in shares.values())
    for k, name in enumerate(names):
        is_rounded_to(on_page(results, f"joint.{name}.sd_mm"), 1e3 * sds[k], 1)
        for word, source in BARS.items():
            is_rounded_to(on_page(results, f"joint.{name}.{word}"), 100 * max(shares[source][k], 0) / total[k], 1)


@known("report.html", "diagnostic.*", source="`frames.csv`, by pandas", runs=("filtered", "plain"))
def the_page_says_the_diagnostics(results):
    frames = results.tables["frames.csv"]
    expected = {
        "frames_seen_by_two_cameras_or_more": ((frames.quality == 2).sum(), 1),
        "frames_seen_by_one_camera": ((frames.quality == 1).sum(), 1),
        "frames_from_the_motion_prior_alone": ((frames.quality == 0).sum(), 1),
        "frames_where_tracking_began_again": (0, 1),
        "frames_with_R-hat_above_1.05": ((frames.r_hat > 1.05).sum(), 1),
        "R-hat,_median": (frames.r_hat.median(), 0.001),
        "R-hat,_95_%_below": (frames.r_hat.quantile(0.95), 0.001),
        "acceptance": (frames.acceptance.mean(), 0.01),
        "effective_sample_size,_median": (frames.ess.median(), 1),
        "effective_sample_size,_least": (frames.ess.min(), 1),
        "energy_fraction_(E-BFMI),_median": (frames.e_bfmi.median(), 0.01),
        "trajectories_that_diverged": (frames.divergences.sum(), 1),
    }
    said = {name.removeprefix("diagnostic.") for name in results.tables["report.html"] if name.startswith("diagnostic.")}
    assert said == set(expected), said ^ set(expected)
    for name, (exact, step) in expected.items():
        is_rounded_to(on_page(results, f"diagnostic.{name}"), exact, step)


@known("report.html curves", "frame.*", "residual.*", source="`frames.csv`", runs=ALL)
def curves_of_frames(results):
    frames = results.tables["frames.csv"]
    assert (drawn(results, "frame.number") == results.numbers).all()
    for name in ("quality", "restarted"):
        assert (drawn(results, f"frame.{name}") == frames[name]).all(), name
    if "frame.r_hat" in results.tables["report.html curves"]:
        is_drawn(results, "frame.r_hat", frames.r_hat, R_HAT)
    for camera in results.seen["camera"]:
        is_drawn(results, f"residual.{camera}", frames[f"residual_{camera}_px"], RESIDUAL_PX)


@known("report.html curves", "point.*", source="`joints.csv`", runs=ALL)
def curves_of_points(results):
    mean, low, high = (columns(results, "joints.csv", "joint", what) for what in ("mean", "q05", "q95"))
    for k, name in enumerate(results.of("joints.csv", "x_mean_m", "joint")[1]):
        for axis, letter in enumerate("xyz"):
            for what, exact in (("mean", mean), ("below", mean - low), ("above", high - mean)):
                is_drawn(results, f"point.{name}.{letter}.{what}", exact[:, k, axis], POSITION_M)


@known("report.html curves", "ellipsoid.*", source="Cholesky factors of the covariances of the draws in `posterior.zarr`, less the shift that all share, by NumPy", runs=ALL)
def ellipsoids_are_those_of_the_draws(results):
    draws = results.draws["marker_position"][0]
    away = draws - draws.mean(0)
    away -= away.mean((1, 2), keepdims=True)
    covariances = np.einsum("dfpi,dfpj->fpij", away, away) / (len(draws) - 1)
    factors = np.linalg.cholesky(covariances)
    for k, name in enumerate(results.draws["marker"]):
        for row, column in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)):
            is_drawn(results, f"ellipsoid.{name}.{'xyz'[row]}{'xyz'[column]}", factors[:, k, row, column], POSITION_M)


@known("report.html curves", "angle.*", source="`angles.csv`", runs=ALL)
def curves_of_angles(results):
    mean, low, high, seen = (results.of("angles.csv", what, "name")[0] for what in ("mean_deg", "q05_deg", "q95_deg", "seen"))
    for k, name in enumerate(results.of("angles.csv", "mean_deg", "name")[1]):
        for what, exact in (("mean", mean), ("below", mean - low), ("above", high - mean)):
            is_drawn(results, f"angle.{name}.{what}", exact[:, k], ANGLE_DEG)
        assert (drawn(results, f"angle.{name}.seen") == seen[:, k]).all(), name
