"""`validation.csv` of `sinew validate`, from what `sinew predict` says of each camera that was left out and the keypoints that it had, by NumPy."""

import json

import laws
import numpy as np
import pandas as pd
import pytest

FPS, FRAMES = 30.0, 15
LEAST_CONFIDENCE = 0.5


@pytest.fixture(scope="module")
def validated(call, walk, tmp_path_factory):
    """The folder of a validation, with the predictions of each camera."""
    folder = tmp_path_factory.mktemp("validate")
    where = ["--calibration", walk / "Calib.toml"]
    recording = [*where, "--keypoints", walk / "keypoints", "--layout", "BODY_25B", "--fps", FPS, "--frames", f"0..{FRAMES}", "--seed", 1, "--patience", 1]
    call(folder, "validate", *recording, "-o", "worth")
    for camera in laws.read(walk, FPS).cameras:
        call(folder, "predict", f"worth/without_{camera}", *where, "--camera", camera, "-o", f"{camera}.csv")
    return folder


def observed(walk, camera, table):
    """Keypoints less what was predicted of them, with their confidence, in the rows of a prediction."""
    frames = [json.loads((walk / f"keypoints/{camera}_json/{camera}.{frame:04}.json").read_text())["people"] for frame in range(FRAMES)]
    points = [np.array(people[0]["pose_keypoints_2d"]).reshape(-1, 3) if people else np.zeros((len(laws.NAMES), 3)) for people in frames]
    seen = np.array([points[frame][laws.NAMES.index(name)] for frame, name in zip(table.frame, table.keypoint)])
    return seen[:, :2] - table[["u", "v"]].to_numpy(), seen[:, 2]


def expected(walk, camera, predicted):
    """Errors, px, squared distances in standard deviations and log densities of the keypoints that count, with their names."""
    residuals, confidence = observed(walk, camera, predicted)
    counts = confidence > LEAST_CONFIDENCE
    residuals, predicted = residuals[counts], predicted[counts]
    # The camera's own offset is taken off, and what all keypoints share of the covariance.
    residuals = residuals - np.median(residuals, axis=0)
    own = [(predicted[name] - predicted[f"common_{name}"]).to_numpy() for name in ("uu", "uv", "uv", "vv")]
    covariances = np.stack(own, -1).reshape(-1, 2, 2)
    squares = np.einsum("ni,nij,nj->n", residuals, np.linalg.inv(covariances), residuals)
    scores = -0.5 * squares - 0.5 * np.log(np.linalg.det(covariances)) - np.log(2 * np.pi)
    return pd.DataFrame({"keypoint": predicted.keypoint.to_numpy(), "error": np.hypot(*residuals.T), "square": squares, "score": scores})


def test_what_cameras_left_out_say(validated, walk):
    table = pd.read_csv(validated / "worth/validation.csv")
    looked_at = 0
    for camera in laws.read(walk, FPS).cameras:
        all_points = expected(walk, camera, pd.read_csv(validated / f"{camera}.csv"))
        for row in table[table.camera == camera].itertuples():
            own = all_points if row.keypoint == "all" else all_points[all_points.keypoint == row.keypoint]
            assert row.count == len(own), (camera, row.keypoint)
            if own.empty:
                continue
            # Predictions are written to 0.001 px and 0.0001 px²: a point at the edge of a region may change sides.
            for share in (50, 80, 90, 95):
                edge = -2 * np.log(1 - share / 100)
                low, high = ((own.square <= edge * by).mean() for by in (0.995, 1.005))
                assert low - 1e-4 <= getattr(row, f"inside_{share}") <= high + 1e-4, (camera, row.keypoint, share)
            ordered = np.sort(own.error)
            at = [ordered[int(np.floor(share * (len(own) - 1) + 0.5))] for share in (0.5, 0.9)]
            assert np.allclose([row.error_median_px, row.error_90_px], at, atol=0.003), (camera, row.keypoint)
            assert abs(row.log_score - own.score.mean()) < 0.01 * (1 + abs(own.score).mean()), (camera, row.keypoint)
            looked_at += 1
    assert looked_at > 80
