"""`people.csv` of a run of several people, from the files of each of them."""

import json

import facts
import numpy as np
import pandas as pd
import pytest
import results

FPS = 30.0


@pytest.fixture(scope="module")
def crowd(call, tmp_path_factory):
    """The results of two people whose ways cross; one camera is empty at first."""
    folder = tmp_path_factory.mktemp("people")
    call(folder, "simulate", "--people", 2, "--duration", 0.6, "--seed", 2, "-o", "made")
    for frame in range(4):
        (folder / f"made/keypoints/C4_json/C4.{frame:04}.json").write_text(json.dumps({"version": 1.3, "people": []}))
    call(folder, "track", "--calibration", "made/Calib.toml", "--keypoints", "made/keypoints", "--layout", "BODY_25B", "--fps", FPS, "--patience", 1, "--seed", 1, "-o", "out")
    return folder


def test_a_row_is_what_the_files_of_the_person_say(crowd):
    table = pd.read_csv(crowd / "out/people.csv", keep_default_na=False)
    assert list(table.person) == [1, 2]
    places = []
    for row in table.itertuples():
        folder = crowd / "out" / row.folder
        numbers = sorted(pd.read_csv(folder / "frames.csv").frame)
        own = results.read(folder, crowd / "made/Calib.toml", "", FPS, numbers)
        summary = json.loads((folder / "summary.json").read_text())
        sees = np.isfinite(own.seen["pixel"][..., 0]).any(-1)
        assert [row.first_frame, row.last_frame] == [numbers[0], numbers[-1]]
        assert row.seen_frames == (sees.sum(1) >= 2).sum()
        for index, camera in enumerate(own.seen["camera"]):
            assert getattr(row, f"seen_frames_{camera}") == sees[:, index].sum(), camera
        failed = summary["failed_diagnostics"]
        assert str(row.complete).lower() == str(summary["complete"]).lower() == "true"
        assert str(row.trusted).lower() == str(not failed).lower() and (row.problem == "") == (not failed)
        places.append(own.draws["marker_position"][0].mean((0, 1, 2)))
    # They are two people: a step apart at least in the mean of all points and frames.
    assert np.linalg.norm(places[0] - places[1]) > 0.3


def test_inspect_says_who_was_seen(call, crowd):
    table = pd.read_csv(crowd / "out/people.csv")
    said = facts.tables(call(crowd, "inspect", "out"))["inspect results"].iloc[0]
    assert said["title.0"] == len(table)
    for row in table.itertuples():
        frames = [row.first_frame, row.last_frame + 1]
        cameras = [count for name, count in row._asdict().items() if name.startswith("seen_frames_") and count > 0]
        expected = [*frames, (frames[1] - frames[0]) / FPS, row.seen_frames, row.seen_frames / FPS, *cameras]
        found = [said[f"person {row.person}.{k}"] for k in range(len(expected))]
        assert np.allclose(found, np.round(expected, 1)), (found, expected)
        assert f"person {row.person}.{len(expected)}" not in said
