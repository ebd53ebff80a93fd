"""Diagnostics of frames: `frames.csv`, and the columns that say who was seen."""

import numpy as np
from ledger import known
from motion import markers
from scipy.spatial.transform import Rotation

# Chains of the default settings; a kept sample is the draws of all chains, one after the other.
CHAINS = 16
ROWS = {"joints.csv": "joint", "keypoints.csv": "keypoint", "angles.csv": "name", "state.csv": "name", "frames.csv": None, "markers_sd.csv": None}


def by_frame(results, file, column):
    """Values of a column, frames × rows of a frame."""
    return results.tables[file][column].to_numpy().reshape(results.frames, -1)


def numbers_and_times(file):
    def check(results):
        numbers = np.array(results.numbers)[:, None]
        assert (by_frame(results, file, "frame") == numbers).all()
        assert np.allclose(by_frame(results, file, "time_s"), numbers / results.fps, atol=1e-9)
        if "person" in results.tables[file]:
            assert (results.tables[file].person == 0).all()

    check.__name__ = f"numbers_and_times_of_{file.replace('.', '_')}"
    return check


for file in ROWS:
    known(file, "frame", "time_s", "person", source="the frames that were requested, over the frame rate; one person is 0")(numbers_and_times(file))


def cameras_that_saw(results):
    return np.isfinite(results.seen["pixel"][..., 0]).any(-1).sum(-1)


def seen_by(file):
    def check(results):
        cameras = cameras_that_saw(results)[:, None]
        assert (by_frame(results, file, "observed") == (cameras > 0)).all()
        assert (by_frame(results, file, "quality") == np.minimum(cameras, 2)).all()

    check.__name__ = f"observed_and_quality_of_{file.replace('.', '_')}"
    return check


for file in ("joints.csv", "keypoints.csv", "frames.csv"):
    known(file, "observed", "quality", source="cameras with a keypoint in the frame", runs=("filtered", "smoothed", "plain"))(seen_by(file))


@known("frames.csv", "restarted", source="tracking begins once", runs=("filtered", "smoothed", "plain"))
def tracking_begins_once(results):
    assert list(results.tables["frames.csv"].restarted) == [1] + [0] * (results.frames - 1)


def sampled(results):
    """The chains' states, draws × chains × frames × dofs, where nothing moves them."""
    both = np.concatenate([results.draws["root"][0], results.draws["angle"][0]], -1).astype(float)
    return both.reshape(-1, CHAINS, *both.shape[1:])


def split_r_hat(states):
    """Of draws × chains × …; Gelman and co-workers, Bayesian Data Analysis, 3rd edition, §11.4."""
    half = len(states) // 2
    halves = np.concatenate([states[:half], states[-half:]], 1)
    within = halves.var(0, ddof=1).mean(0)
    between = half * halves.mean(0).var(0, ddof=1)
    return np.sqrt((half - 1) / half + between / half / within)


@known("frames.csv", "r_hat", source="its definition, of all draws of a set-up in which nothing lasts", runs=("plain",))
def r_hat_is_the_largest_split_r_hat(results):
    assert np.allclose(results.tables["frames.csv"].r_hat, split_r_hat(sampled(results)).max(-1), rtol=1e-4)


@known("frames.csv", "ess", source="ArviZ on all draws of a set-up in which nothing lasts", runs=("plain",))
def ess_is_the_least_of_arviz(results):
    import arviz

    states = sampled(results)
    for frame, ess in enumerate(results.tables["frames.csv"].ess):
        own = [float(arviz.ess(states[:, :, frame, dof].T.copy(), method="mean")) for dof in range(states.shape[-1])]
        assert np.isclose(ess, min(own), rtol=1e-3), frame


@known("frames.csv", "e_bfmi", source="its definition, of the energies in `posterior.zarr`", runs=("filtered", "plain"))
def e_bfmi_is_that_of_the_energies(results):
    energy = results.statistics["energy"][0].astype(float)
    energy = energy.reshape(-1, CHAINS, energy.shape[-1])
    own = (np.diff(energy, axis=0) ** 2).sum(0) / ((energy - energy.mean(0)) ** 2).sum(0)
    assert np.allclose(results.tables["frames.csv"].e_bfmi, own.mean(0), rtol=1e-4)


@known("frames.csv", "acceptance", source="mean of the kept draws' in `posterior.zarr` (the column counts burn-in, too)", runs=("filtered", "plain"))
def acceptance_is_near_that_of_kept_draws(results):
    kept = results.statistics["acceptance_rate"][0].astype(float).mean(0)
    assert (abs(results.tables["frames.csv"].acceptance - kept) < 0.02).all()


@known("frames.csv", "divergences", source="draws in `posterior.zarr` that diverged; none here", runs=("filtered", "plain"))
def nothing_diverges(results):
    assert not results.statistics["diverging"].any()
    assert (results.tables["frames.csv"].divergences == 0).all()


def residuals(results):
    """Scatter per axis in each camera, frames × cameras: keypoints against the mean pose, projected by SciPy."""
    placed = markers(results)
    at = np.stack([placed[name] for name in results.seen["keypoint"]], 1)
    scatter = []
    for index, name in enumerate(results.seen["camera"]):
        camera = next(camera for camera in results.cameras.values() if isinstance(camera, dict) and camera.get("name") == name)
        offset = next(camera["offset_px"] for camera in results.setup["camera"] if camera["name"] == name)
        there = at @ Rotation.from_rotvec(camera["rotation"]).as_matrix().T + camera["translation"]
        matrix = np.array(camera["matrix"])
        pixel = there[..., :2] / there[..., 2:] * matrix[[0, 1], [0, 1]] + matrix[:2, 2] + offset
        distance = np.linalg.norm(results.seen["pixel"][:, index] - pixel, axis=-1)
        scatter.append([np.nanmedian(row) if np.isfinite(row).any() else np.nan for row in distance])
    return np.array(scatter).T / np.sqrt(2 * np.log(2))


@known("frames.csv", "residual_*_px", "residual_px", source="keypoints against `markers.trc`, projected by SciPy, of a set-up in which nothing lasts", runs=("plain",))
def residuals_are_those_of_the_mean_pose(results):
    expected = residuals(results)
    table = results.tables["frames.csv"]
    columns = [f"residual_{name}_px" for name in results.seen["camera"]]
    assert np.allclose(table[columns], expected, rtol=1e-4, equal_nan=True)
    assert np.allclose(table.residual_px, np.sqrt(np.nanmean(expected**2, -1)), rtol=1e-4, equal_nan=True)
