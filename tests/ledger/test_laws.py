"""Laws of change: a recording is changed in a way whose effect on every number is known, and tracked again.

Results agree up to Monte Carlo error, since streams of random numbers depend on the recording: an sd of a mean is sd/√ESS in each run.
"""

import laws
import numpy as np
import pytest
import results
from points import columns
from scipy.spatial.transform import Rotation

FPS = 30.0
NUMBERS = range(42, 54)
ALIKE = "--layout BODY_25B --patience 1 --draws 400 --seed 1".split()


@pytest.fixture(scope="module")
def track(call, walk, tmp_path_factory):
    """Tracks a recording's frames; `setup` from another run, with the options of `track`."""
    folder = tmp_path_factory.mktemp("laws")

    def run(name, recording, numbers=NUMBERS, options=()):
        laws.write(folder / name, recording)
        frames = ["--frames", f"{numbers[0]}..{numbers[-1] + 1}", "--fps", f"{recording.fps:g}"]
        call(folder, "track", "--calibration", f"{name}/Calib.toml", "--keypoints", f"{name}/keypoints", *ALIKE, *frames, *options, "-o", f"{name}-out")
        read = results.read(folder / f"{name}-out", folder / name / "Calib.toml", "", recording.fps, list(numbers))
        read.folder = folder / f"{name}-out"
        return read

    return run


@pytest.fixture(scope="module")
def recording(walk):
    return laws.read(walk, FPS)


@pytest.fixture(scope="module")
def as_it_is(track, recording):
    return track("as-it-is", recording)


def joints(run):
    """Means and standard deviations of the joints, frames × points × 3."""
    return [columns(run, "joints.csv", "joint", what) for what in ("mean", "sd", "sd_within")]


def angles(run, numbers=slice(None)):
    """Means of all angles, degrees, and their standard deviations if they were Gaussian."""
    mean, names = run.of("angles.csv", "mean_deg", "name")
    low, high = (run.of("angles.csv", f"{what}_deg", "name")[0] for what in ("q05", "q95"))
    return names, mean[numbers], ((high - low) / 3.29)[numbers]


# Draws of what lasts: of each a mean is known to sd/√128 and an sd to 6 %, and all points share the same.
LASTING_DRAWS = 128


# Root mean square of three normal numbers (points share a shift along three axes), and of one (an angle), exceeded with probability 0.001 and, of 26 angles, 0.0001.
OF_THREE, OF_ONE = 2.4, 3.9


def agree(ours, theirs, sds, what="points", limit=OF_THREE):
    """Means agree as far as Monte Carlo errors let one say."""
    away = abs(ours - theirs) / (sds * np.sqrt(2 / LASTING_DRAWS))
    assert np.sqrt((away**2).mean()) < limit and away.max() < 6, (what, np.sqrt((away**2).mean()), away.max())


def joints_agree(ours, theirs, moved=lambda points: points, rows=slice(None), order=slice(None), points=slice(None), frames=slice(None)):
    """Points agree after those of the first run were moved; `rows` and `order` are the frames and points of the second, `points` those of the first, `frames` those of both that are looked at."""
    mean, *spreads = (value[:, points][frames] for value in joints(ours))
    other, *other_spreads = (value[rows][:, order][frames] for value in joints(theirs))
    agree(moved(mean), other, other_spreads[0])
    # Standard deviations agree to 15 %, three of their standard errors, in the mean over all.
    for first, second in zip(spreads, other_spreads):
        first, second = (np.sqrt((value**2).sum(-1)) for value in (first, second))
        assert abs(np.log(second / first).mean()) < 0.15, np.log(second / first).mean()


def angles_agree(ours, theirs, law=lambda name: (name, 1, 0.0), rows=slice(None), frames=slice(None)):
    """Angles that keypoints show agree; others wander from frame to frame by the Monte Carlo errors of all frames before.

    `law` gives the name of an angle in the second run, its sign there, and what is added; none where nothing is known.
    """
    names, first, _ = angles(ours)
    seen = ours.of("angles.csv", "seen", "name")[0].all(0)
    names_there, second, spread = angles(theirs, rows)
    looked_at = 0
    for k, name in enumerate(names):
        if not seen[k] or (known := law(name)) is None:
            continue
        there, sign, by = known
        at = names_there.index(there)
        difference = (sign * first[:, k] + by - second[:, at] + 180) % 360 - 180
        agree(difference[frames], 0.0, spread[:, at][frames], name, OF_ONE)
        looked_at += 1
    assert looked_at > 20


def test_frames_numbered_from_1000(track, recording, as_it_is):
    late = track("late", laws.later(recording, 1000), [1000 + number for number in NUMBERS])
    joints_agree(as_it_is, late)
    angles_agree(as_it_is, late)
    for name in ("joints.csv", "angles.csv", "state.csv", "frames.csv"):
        assert (late.tables[name].frame - 1000 == as_it_is.tables[name].frame).all()
        assert np.allclose(late.tables[name].time_s - 1000 / FPS, as_it_is.tables[name].time_s)


def test_cameras_under_other_names_in_another_order(track, recording, as_it_is):
    names = {"C1": "west", "C2": "south", "C3": "north", "C4": "east"}
    renamed = track("renamed", laws.renamed(recording, names))
    joints_agree(as_it_is, renamed)
    angles_agree(as_it_is, renamed)
    for name, other in names.items():
        ours, theirs = as_it_is.tables["frames.csv"][f"residual_{name}_px"], renamed.tables["frames.csv"][f"residual_{other}_px"]
        assert np.allclose(ours, theirs, rtol=0.15), name


def test_a_camera_that_sees_nothing_changes_nothing(track, recording, as_it_is):
    blind = track("blind", laws.with_a_blind_camera(recording))
    joints_agree(as_it_is, blind)
    angles_agree(as_it_is, blind)


def test_a_world_that_is_turned_and_shifted(track, recording, as_it_is):
    turn, shift = Rotation.from_euler("z", 70, degrees=True), np.array([2.0, -1.0, 0.3])
    moved = track("moved", laws.moved(recording, turn, shift))
    joints_agree(as_it_is, moved, lambda mean: turn.apply(mean.reshape(-1, 3)).reshape(mean.shape) + shift)

    def law(name):
        # They depend on where somebody faces.
        if name in ("pelvis_tilt", "pelvis_list"):
            return None
        return name, 1, 70.0 if name == "pelvis_rotation" else 0.0

    angles_agree(as_it_is, moved, law)


def test_left_and_right_exchanged(track, recording, as_it_is):
    mirrored = track("mirrored", laws.mirrored(recording))
    points = list(as_it_is.draws["marker"])
    other = [points.index(laws.SIDE[name[0]] + name[1:] if name[0] in "LR" and name[1].isupper() else name) for name in points]
    joints_agree(as_it_is, mirrored, lambda mean: mean * [-1, 1, 1], order=other)

    def law(name):
        # Angles of limbs have one sign on both sides; the body's own degrees of freedom do not.
        if name[-2:] in ("_r", "_l"):
            return name[:-1] + {"r": "l", "l": "r"}[name[-1]], 1, 0.0
        if name in ("r_foot_ry", "l_foot_ry"):
            return {"r": "l", "l": "r"}[name[0]] + name[1:], -1, 0.0
        return name, 1 if name in ("pelvis_tilt", "head_rx") else -1, 0.0

    angles_agree(as_it_is, mirrored, law)


def test_twice_the_rate_with_every_second_frame_empty(track, recording, as_it_is):
    setup = ["--setup", as_it_is.folder / "setup.toml"]
    same = track("same", recording, options=setup)
    numbers = range(2 * NUMBERS[0], 2 * NUMBERS[-1] + 1)
    twice = track("twice", laws.at_twice_the_rate(recording), numbers, setup)
    every_second = slice(None, None, 2)
    joints_agree(same, twice, rows=every_second)
    angles_agree(same, twice, rows=every_second)
    assert (twice.tables["frames.csv"].observed == [1 - k % 2 for k in range(len(numbers))]).all()


def test_time_reversed(track, recording):
    """A smoothed walk is the same, its last frame first: what a random walk says of a step does not know its direction. At the ends something is known of the first frame alone."""
    forward = track("forward", recording, options=["--smooth"])
    last = max(recording.keypoints["C1"])
    numbers = range(last - NUMBERS[-1], last - NUMBERS[0] + 1)
    backward = track("backward", laws.reversed_in_time(recording), numbers, ["--smooth"])
    joints_agree(forward, backward, rows=slice(None, None, -1), frames=slice(2, -2))
    angles_agree(forward, backward, rows=slice(None, None, -1), frames=slice(2, -2))


def test_a_point_that_no_camera_sees(track, recording, as_it_is):
    """Other points stay where they are, but for the elbow, which it tells of; of this one only the motion before is known, and the limb that it ends."""
    missing = track("missing", laws.without(recording, "LWrist"))
    names = list(as_it_is.draws["marker"])
    others = [k for k, name in enumerate(names) if name not in ("LWrist", "LElbow")]
    joints_agree(as_it_is, missing, points=others, order=others)
    before, after = (np.sqrt((joints(run)[2][:, names.index("LWrist")] ** 2).sum(-1)) for run in (as_it_is, missing))
    assert after.mean() > 2 * before.mean() and (after > before).all(), after / before
