"""Runs from Python: the program's bytes, results over the arrays that were read, stops and resumption."""

import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import sinew
from sinew import _result
from sinew._words import in_python

pytestmark = pytest.mark.filterwarnings("ignore::sinew.SinewWarning", "ignore::sinew.DiagnosticWarning")

FRAMES = (0, 8)


def differing(first, second):
    """Files that are not the same in two folders."""
    files = [{path.relative_to(top): path.read_bytes() for path in top.rglob("*") if path.is_file()} for top in (first, second)]
    names = files[0].keys() | files[1].keys()
    return {str(name) for name in names if files[0].get(name) != files[1].get(name)}


def test_files_are_those_of_the_program(program, recording, walk, result, tmp_path):
    options = f"--layout BODY_25B --fps {walk.rate_hz:g} --frames 0..8 --seed 4 --calibration {recording / 'Calib.toml'}"
    out = ["--keypoints", str(recording / "pose"), "-o", str(tmp_path / "out")]
    subprocess.run([program, "track", *options.split(), *out], check=True, capture_output=True)
    assert differing(result.path, tmp_path / "out") <= {"timings.json"}
    assert len(list(result.path.iterdir())) > 10


def test_arrays_give_what_files_give(recording, walk, result, tmp_path):
    cameras = sinew.read_calibration(recording / "Calib.toml")
    options = {"fps": 20, "seed": 4}
    sinew.track(cameras, walk.keypoints, layout=walk.layout, frames=range(*FRAMES), out=tmp_path / "out", **options)
    # Paths and hashes of files that are not there.
    assert differing(result.path, tmp_path / "out") <= {"timings.json", "config.toml", "summary.json"}
    one = walk.keypoints[:, :, 0]
    again = sinew.track(recording / "Calib.toml", one, layout="BODY_25B", frames=FRAMES, page=True, setup=result.path / "setup.toml", **options)
    assert (again.path / "report.html").is_file()
    assert again.posterior.equals(result.posterior)


def test_the_posterior_is_about_the_truth(walk, result):
    """Mean error of the joints below 25 mm; 90 % bands hold between 75 and 100 %."""
    joints = result.joints
    columns = [walk.points.index(name) for name in joints.joint.values]
    truth = walk.truth[slice(*FRAMES)][:, columns]
    mean = np.stack([joints[f"{axis}_mean_m"] for axis in "xyz"], -1)
    assert np.linalg.norm(mean - truth, axis=-1).mean() < 0.025
    held = [(joints[f"{axis}_q05_m"] < truth[..., k]) & (truth[..., k] < joints[f"{axis}_q95_m"]) for k, axis in enumerate("xyz")]
    assert 0.75 < np.mean(held) <= 1.0
    # The draws of the store are those of which the table is made, but for their number.
    draws = result.posterior.marker_position.mean(["chain", "draw"]).sel(marker=joints.joint.values)
    assert abs(draws.values - mean).max() < 0.03


def test_the_store_is_what_zarr_reads(result):
    pytest.importorskip("zarr", minversion="3")
    for name, dataset in result.to_datasets().items():
        theirs = xr.open_zarr(result.path / "posterior.zarr", group=name, consolidated=False).load()
        assert dataset.sizes == theirs.sizes
        for variable in theirs.variables:
            np.testing.assert_array_equal(dataset[variable].values, theirs[variable].values)
            assert dataset[variable].dims == theirs[variable].dims


def test_arviz_works_on_the_same_arrays(result):
    arviz = pytest.importorskip("arviz", reason="no arviz")
    tree = result.to_arviz()
    assert np.shares_memory(tree["posterior"]["angle"].values, result.posterior.angle.values)
    assert {"posterior", "sample_stats", "observed_data"} <= set(tree if isinstance(tree, xr.DataTree) else tree.groups())
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        table = arviz.summary(tree, var_names=["root"])
    assert len(table) == 3 * (FRAMES[1] - FRAMES[0])


def test_results_describe_themselves(result):
    assert result.complete and result.summary["frame_count"] == 8
    assert result.joints.sizes == {"frame": 8, "joint": 26}
    assert result.frames.residual_px.shape == (8,)
    assert set(result.angles.name.values) >= {"hip_flexion_r", "knee_angle_r"}
    assert result.state.sizes["name"] == 32
    assert "8 frames, complete" in repr(result)
    assert sinew.read(result.path, sinew.Result).joints.equals(result.joints)
    assert result.people == {1: result} and result[1] is result
    with pytest.raises(KeyError, match=r"no results of person 2; there are \[1\]"):
        result[2]


def test_results_are_plotted_with_their_bands(result):
    plt = pytest.importorskip("matplotlib.pyplot", reason="no matplotlib")
    plt.switch_backend("Agg")
    axes = result.plot("RWrist")
    wrist = result.joints.sel(joint="RWrist")
    assert [axis.get_ylabel() for axis in axes] == ["x (m)", "y (m)", "z (m)"]
    for axis, name in zip(axes, "xyz", strict=True):
        np.testing.assert_array_equal(axis.lines[0].get_ydata(), wrist[f"{name}_mean_m"])
        corners = axis.collections[0].get_paths()[0].vertices[:, 1]
        assert (corners.min(), corners.max()) == (wrist[f"{name}_q05_m"].min(), wrist[f"{name}_q95_m"].max())
    (axis,) = result.plot("knee_angle_r")
    np.testing.assert_array_equal(axis.lines[0].get_ydata(), result.angles.mean_deg.sel(name="knee_angle_r"))
    with pytest.raises(KeyError, match="no joint, keypoint or angle `RWrits`; known: .*RWrist"):
        result.plot("RWrits")
    plt.close("all")


def test_a_plot_says_what_it_needs(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="plots need Matplotlib\nhelp: install it"):
        result.plot("RWrist")


def test_a_temporary_folder_lives_as_long_as_its_result(walk, setup):
    found = sinew.track(walk.cameras, walk.keypoints, layout=walk.layout, fps=20, frames=(0, 2), setup=setup)
    path = found.path
    assert path.is_dir()
    del found
    assert not path.exists()


def test_several_people_are_results_each(walk, setup):
    """The second one walks two metres beside, in the same cameras; one of them is tracked alone then."""
    other = walk.truth + [0.0, 2.0, 0.0]
    columns = [None if name is None else walk.points.index(name) for name in walk.layout]
    second = np.full_like(walk.keypoints, np.nan)
    for view, camera in enumerate(walk.cameras):
        pixels = camera.project(other)
        for k, column in enumerate(columns):
            if column is not None:
                second[:, view, 0, k] = np.column_stack([pixels[:, column], np.full(len(other), 0.8)])
    both = np.concatenate([walk.keypoints, second], axis=2)
    found = sinew.track(walk.cameras, both, layout=walk.layout, fps=20, frames=(0, 8), setup_frames=(0, 8))
    assert isinstance(found, sinew.Result) and list(found.people) == [1, 2]
    apart = [float(person.joints.y_mean_m.mean()) for person in found.people.values()]
    assert abs(abs(apart[0] - apart[1]) - 2.0) < 0.1
    assert found[2].joints.sizes == {"frame": 8, "joint": 26}
    # The same attributes, over a dimension more.
    assert found.joints.sizes == {"person": 2, "frame": 8, "joint": 26}
    assert found.joints.sel(person=2).drop_vars("person").equals(found[2].joints)
    assert found.posterior.sel(person=1).drop_vars("person").equals(found[1].posterior)
    assert found.to_datasets()["sample_stats"].diverging.dtype == bool
    assert found.complete and "2 people" in repr(found)
    pytest.importorskip("matplotlib", reason="no matplotlib")
    assert [len(axis.lines) for axis in found.plot("RWrist")] == [2, 2, 2]
    alone = sinew.track(walk.cameras, both, layout=walk.layout, fps=20, frames=(0, 8), person=1, setup=setup)
    assert alone.joints.sizes == {"frame": 8, "joint": 26}


def test_frames_that_a_person_lacks_are_missing():
    frames = [xr.Dataset({"x": ("frame", np.ones(2)), "bad": ("frame", [True, False])}, {"frame": of, "time": ("frame", np.array(of) / 20)}) for of in ([0, 1], [1, 2])]
    both = _result._stacked({1: frames[0], 3: frames[1]})
    assert both.sizes == {"person": 2, "frame": 3} and both.person.values.tolist() == [1, 3]
    np.testing.assert_array_equal(both.x, [[1, 1, np.nan], [np.nan, 1, 1]])
    np.testing.assert_array_equal(both.bad, [[True, False, False], [False, True, False]])
    np.testing.assert_array_equal(both.time, [0, 0.05, 0.1])


def test_progress_and_warnings_are_heard(walk, setup):
    heard = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        sinew.track(
            walk.cameras,
            walk.keypoints[:4],
            layout=walk.layout,
            setup=setup,
            particles=100,
            progress=lambda *counted: heard.append(counted),
        )
    assert any(what == "tracking" and unit == "frames" and total == 4 for what, unit, _, total in heard)
    texts = [str(of.message) for of in caught if of.category is sinew.SinewWarning]
    assert any(text.endswith("30 frames per second assumed (`fps`)") for text in texts)
    assert '`particles` changes nothing with `method="hmc"`' in texts
    assert not any("--" in text for text in texts)
    assert all(of.filename == __file__ for of in caught if of.category is sinew.SinewWarning)


def test_errors_are_those_of_the_program(program, recording, tmp_path):
    for arguments, settings in [
        (["--calibration", "Calib.toml", "--keypoints", "nope"], {"calibration": "Calib.toml", "keypoints": "nope"}),
        (["--calibration", "pose", "--keypoints", "pose"], {"calibration": "pose", "keypoints": "pose"}),
        (["--calibration", "Calib.toml"], {"calibration": "Calib.toml"}),
        (
            ["--calibration", "Calib.toml", "--keypoints", "pose", "--layout", "COCO"],
            {"calibration": "Calib.toml", "keypoints": "pose", "layout": "COCO"},
        ),
    ]:
        out = str(tmp_path / "out")
        ended = subprocess.run([program, "track", *arguments, "-o", out], cwd=recording, capture_output=True, text=True)
        here = Path.cwd()
        try:
            os.chdir(recording)
            with pytest.raises(sinew.SinewError) as raised:
                sinew.track(**settings, out=out)
        finally:
            os.chdir(here)
        assert raised.value.exit_code == ended.returncode
        assert f"error: {raised.value}" in in_python(ended.stderr)
        assert "`--" not in str(raised.value)


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"fpss": 20}, sinew.UsageError, "unknown setting `fpss`; did you mean `fps`?"),
        ({"fps": -1}, sinew.UsageError, "`fps` is -1"),
        ({"frames": (0, 1, 2)}, sinew.UsageError, "`frames` has 3 numbers; expected"),
        ({"first_frame": -1}, sinew.InputError, "`first_frame` is -1; expected a whole number from 0 to 4294967295"),
        ({"setup": "a\udce9.toml"}, sinew.UsageError, r"`setup` is 'a\udce9.toml', which is not UTF-8"),
        ({"setup": Path("a\udce9.toml")}, sinew.UsageError, r"`setup` is 'a\udce9.toml', which is not UTF-8"),
        ({"out": Path("a\udce9")}, sinew.UsageError, r"`out` is 'a\udce9', which is not UTF-8"),
        ({"resume": True}, sinew.UsageError, "`resume` needs the folder `out`"),
        ({"layout": ["Nose"]}, sinew.InputError, "expected (frames, cameras = 4, people, points = 1, u v confidence = 3)"),
    ],
)
def test_wrong_settings_are_named(walk, settings, error, words):
    with pytest.raises(error) as raised:
        sinew.track(walk.cameras, walk.keypoints, **{"fps": 20, "layout": "BODY_25B"} | settings)
    assert words in str(raised.value)


def test_wrong_arrays_are_named(walk, tmp_path):
    wrong = walk.keypoints.copy()
    wrong[3, 1, 0, 7] = [5, 5, 70]
    with pytest.raises(sinew.InputError, match="frame 3, camera `C2`, person 0, point 7: the confidence is 70"):
        sinew.track(walk.cameras, wrong, fps=20)
    with pytest.raises(sinew.InputError, match=r"`keypoints` has the shape \(30, 3, 1, 25, 3\); expected .*cameras = 4"):
        sinew.track(walk.cameras, walk.keypoints[:, :3], fps=20)
    with pytest.raises(sinew.InputError, match="`keypoints` is empty"):
        sinew.track(walk.cameras, walk.keypoints[:0], fps=20)
    with pytest.raises(sinew.UsageError, match="arrays of keypoints and cameras .* belong together"):
        sinew.track(None, walk.keypoints, fps=20)
    with pytest.raises(sinew.UsageError, match="`calibration` holds a str"):
        sinew.track(["Calib.toml"], walk.keypoints, fps=20)
    (tmp_path / "summary.json").write_text("{}")
    (tmp_path / "joints.csv").write_text("")
    with pytest.raises(sinew.FileError, match="force"):
        sinew.track(walk.cameras, walk.keypoints, fps=20, out=tmp_path)


STOPPED = """
import signal, sinew, sys, warnings
# Whoever was started in the background ignores it.
signal.signal(signal.SIGINT, signal.default_int_handler)
warnings.simplefilter("ignore")
walk = sinew.simulate(duration_s=3, fps=20, seed=3)
def progress(what, unit, done, total):
    if what == "tracking":
        print(done, flush=True)
options = {"layout": walk.layout, "fps": 20, "setup": sys.argv[1], "progress": progress}
sinew.track(walk.cameras, walk.keypoints, out=sys.argv[2], resume=len(sys.argv) > 3, **options)
print("complete", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to send")
def test_ctrl_c_keeps_what_is_done_and_resumes_to_the_same_bytes(setup, tmp_path):
    def started(*arguments):
        command = [sys.executable, "-c", STOPPED, str(setup), *map(str, arguments)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    run = started(tmp_path / "stopped")
    assert run.stdout.readline().strip().isdigit()
    run.send_signal(signal.SIGINT)
    sent = time.monotonic()
    _, errors = run.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors and run.returncode != 0
    assert time.monotonic() - sent < 20
    assert (tmp_path / "stopped" / "checkpoint.bin").is_file()
    resumed, whole = started(tmp_path / "stopped", "resume"), started(tmp_path / "whole")
    for of in (resumed, whole):
        output, errors = of.communicate(timeout=240)
        assert "complete" in output, errors
    assert differing(tmp_path / "stopped", tmp_path / "whole") <= {"timings.json"}


def test_other_threads_run_meanwhile(walk, setup):
    """A thread of Python counts on while a frame is tracked."""
    import threading

    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.002)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        begun = time.monotonic()
        sinew.track(walk.cameras, walk.keypoints, layout=walk.layout, fps=20, setup=setup, progress=False)
        passed = time.monotonic() - begun
    finally:
        over.set()
        thread.join()
    assert counted[0] > 0.1 * passed / 0.002
