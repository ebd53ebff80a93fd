"""What `sinew inspect` says of the recording and of a run's files, from the files themselves."""

import numpy as np
import scipy.stats
from frames import cameras_that_saw
from ledger import known
from motion import bones, markers
from overall import SOURCES, is_rounded, number

RUNS = ("filtered", "smoothed", "plain", "searched")
# Files of a run that are looked at, beside their folder.
TABLES = {"joints.csv": "joint", "keypoints.csv": "keypoint", "angles.csv": "name", "state.csv": "name", "frames.csv": None, "markers_sd.csv": None}
FILES = (*TABLES, "markers.trc", "angles.mot", "motion.bvh", "setup.toml", "posterior.zarr")
# Names that a list shows before it is cut short: of columns and points, of joints, of frames.
LISTED, LISTED_JOINTS, LISTED_FRAMES = 12, 8, 8
# Offsets, in standard deviations, from which on a camera is said to see everything aside.
ASIDE = 0.3
# The last digit of the time of a frame in a BVH file.
BVH_TIME_S = 1e-7
# The priors of cameras, biases and lags are Student's, with four degrees of freedom.
TAILS = scipy.stats.t(4).var()
KINDS = {"head": ("Eye", "Ear", "Nose", "Head"), "arms": ("Elbow", "Wrist"), "legs": ("Knee", "Ankle"), "feet": ("Heel", "Toe"), "hips": ("Hip",), "trunk": ("",)}
PARTS = {"turn": ("rotation_x_rad", "rotation_y_rad", "rotation_z_rad"), "place": ("translation_x_m", "translation_y_m", "translation_z_m"), "focal length": ("log_focal_length",), "principal point": ("principal_point_u", "principal_point_v"), "k1": ("k1",)}


def says(results, file, expected):
    """All that is said of a file: numbers of each row, each with its decimals."""
    said = results.tables[f"inspect {file}"].iloc[0]
    wanted = {f"{row}.{k}": value for row, values in expected.items() for k, value in enumerate(values)}
    assert set(said.index) == set(wanted), set(said.index) ^ set(wanted)
    for name, (exact, places) in wanted.items():
        assert said[name] == float(f"{exact:.{places}f}"), (file, name, said[name], exact)


def whole(*numbers):
    return [(value, 0) for value in numbers]


def more(names, listed=LISTED):
    """The number of names that are not listed, where there are any."""
    return whole(len(names) - listed) if len(names) > listed else []


@known("inspect Calib.toml", "*", source="the calibration file; centres by SciPy's rotations", runs=("filtered",))
def inspect_says_what_cameras_are(results):
    expected = {"title": whole(len(results.sights.names))}
    for name, centre in zip(results.sights.names, results.sights.cameras.centres()):
        camera = results.cameras[name]
        expected[name] = [*whole(*camera["size"], camera["matrix"][0][0]), *((value, 2) for value in centre)]
    says(results, "Calib.toml", expected)


@known("inspect keypoints", "*", source="the keypoints' files", runs=("filtered",))
def inspect_says_what_keypoints_are(results):
    sights = results.sights
    expected = {"title": whole(len(sights.names)), "layout": whole(sights.pixels.shape[1])}
    for index, name in enumerate(sights.names):
        pixels = sights.pixels[:, :, index][sights.confidence[:, :, index] > 0]
        empty = [frame for frame, seen in zip(results.numbers, sights.confidence[:, :, index].any(1)) if not seen]
        people = whole(0, 1) if empty else whole(1)
        ends = [pixels[:, axis].min() for axis in (0, 1)] + [pixels[:, axis].max() for axis in (0, 1)]
        expected[f"{name}_json"] = whole(results.frames, results.numbers[0], results.numbers[-1] + 1, *(value for value, _ in people), ends[0], ends[2], ends[1], ends[3])
        if empty:
            expected[f"odd camera {name}_json"] = whole(len(empty), results.frames, empty[0])
    says(results, "keypoints", expected)


@known("inspect fit", "*", source="the keypoints' files: points by the direct linear transform, offsets and scatter by robust points and medians in turn, by NumPy", runs=("filtered",))
def inspect_says_how_keypoints_fit(results):
    sights = results.sights
    offset, sigma = sights.offsets
    expected = {"title": whole(results.numbers[0], results.numbers[-1] + 1)}
    expected["person"] = whole(sights.confidence.any((1, 2)).sum(), results.frames)
    for name, distance, (u, v), scatter in zip(sights.names, sights.distances, offset, sigma):
        expected[name] = [(distance, 1), (u, 1), (v, 1), (scatter, 1)]
    says(results, "fit", expected)


def once(function):
    """A function of files that no disturbance changes: computed once for a run."""

    def found(results):
        if function not in results.once:
            results.once[function] = function(results)
        return results.once[function]

    return found


@once
def hidden_shift(results):
    return results.sights.hidden_shift(results.setup)


def shares(results):
    """Shares of the variance of each joint by source, joints × sources, and its variances."""
    names = results.draws["marker"]
    found = np.array([[number(results, f"uncertainty.joints.{name}.{source}") for source in SOURCES] for name in names])
    return found, np.array([number(results, f"uncertainty.joints.{name}.sd_m") for name in names]) ** 2


def sources_of_uncertainty(results):
    """Shares over all joints in their order of size, and for each source that is the largest of some joints how many more there are than are listed, and the range of its shares."""
    own, variances = shares(results)
    words = dict(zip(SOURCES, ("noise of each frame", "cameras", "lengths of the body", "places of keypoints", "biases of detectors", "lags of the cameras")))
    overall = 100 * (own * variances[:, None]).sum(0) / variances.sum()
    expected = {"uncertainty": [(share, 0) for share in sorted(overall, reverse=True)]}
    for k, source in enumerate(SOURCES):
        its = np.round(100 * own[own.argmax(1) == k, k])
        if len(its) > 0:
            rest = more(its, LISTED_JOINTS) if len(its) < len(own) else []
            expected[words[source]] = rest + whole(*sorted({its.min(), its.max()}))
    return expected


def oddities(results):
    """Numbers of what failed and of what the run warned of."""
    frames, odd = results.tables["frames.csv"], {}
    above = frames.frame[frames.r_hat > 1.05]
    if len(above) > 0.05 * results.frames:
        odd["odd diagnostic failed"] = [(1.05, 2), *whole(len(above), results.frames, *above[:LISTED_FRAMES]), *more(above, LISTED_FRAMES), (5, 0)]
    sees = np.isfinite(results.seen["pixel"][..., 0]).any(-1)
    for index, name in enumerate(results.seen["camera"]):
        empty = np.flatnonzero(~sees[:, index])
        if 0 < len(empty) < results.frames:
            odd[f"odd camera {name}"] = whole(len(empty), results.frames, results.numbers[empty[0]])
    aside = [camera["offset_px"] for camera in results.setup["camera"] if np.hypot(*camera["offset_px"]) > ASIDE * camera["sigma_px"]]
    if aside:
        odd["odd the set-up"] = [(value, 1) for offset in aside for value in offset] + whole(1e3 * hidden_shift(results))
    return odd


@known("inspect results", "*", source="`frames.csv`, `summary.json`, keypoints that were read; offsets of `setup.toml` and the shift that they hide by SciPy's rotations", runs=RUNS)
def inspect_says_what_was_found(results):
    frames = results.tables["frames.csv"]
    expected = {"frames": [*whole(results.frames, results.numbers[0], results.numbers[-1] + 1, (frames.observed > 0).sum()), (results.fps, 2)], "seed": whole(1)}
    if frames.r_hat.notna().any():
        expected["R-hat"] = [(frames.r_hat.median(), 3), (95, 0), (frames.r_hat.quantile(0.95), 3)]
    expected["effective size"] = whole(frames.ess.median())
    sees = np.isfinite(results.seen["pixel"][..., 0]).any(-1)
    for index, name in enumerate(results.seen["camera"]):
        residual = frames[f"residual_{name}_px"].median()
        expected[name] = ([(residual, 1)] if np.isfinite(residual) else []) + whole(sees[:, index].sum())
    if "lasting" in results.setup:
        expected |= sources_of_uncertainty(results)
    says(results, "results", expected | oddities(results))


def inspect_of_table(file, row):
    def check(results):
        table = results.tables[file]
        expected = {"rows": whole(len(table)), "columns": whole(len(table.columns)) + more(table.columns)}
        expected["frames"] = whole(results.frames, results.numbers[0], results.numbers[-1] + 1) if len(table) > 0 else whole(0)
        if row:
            names = table[row].unique()
            expected[row] = whole(len(names)) + more(names)
        says(results, file, expected)

    check.__name__ = f"inspect_says_what_{file.replace('.', '_')}_has"
    return check


for file, row in TABLES.items():
    known(f"inspect {file}", "*", source="the table by pandas", runs=RUNS)(inspect_of_table(file, row))


def moves(results, file, names, places, rate):
    """What is said of a motion of points at these places."""
    expected = {"title": whole(len(names)), "frames": [*whole(results.frames), (rate, 14), (results.frames / results.fps, 2)], "names": more(names)}
    if places is not None:
        ends = zip(np.min(places, (0, 1)), np.max(places, (0, 1)))
        expected["world, m"] = [(value, 2) for pair in ends for value in pair]
    says(results, file, expected)


@known("inspect markers.trc", "*", source="the file's points, in the world", runs=RUNS)
def inspect_says_where_markers_are(results):
    placed = markers(results)
    moves(results, "markers.trc", placed, list(placed.values()), results.fps)


@known("inspect angles.mot", "*", source="the file's columns", runs=RUNS)
def inspect_says_what_angles_mot_has(results):
    moves(results, "angles.mot", results.tables["angles.mot"].columns[1:], None, results.fps)


@known("inspect motion.bvh", "*", source="the file's joints and ends, posed by SciPy's rotations; a rate that has the file's time of a frame", runs=RUNS)
def inspect_says_where_bones_are(results):
    turned, placed = bones(results)
    rate = results.tables["inspect motion.bvh"]["frames.1"].iloc[0]
    assert abs(1 / rate - results.tables["motion.bvh"].time[1]) < 0.51 * BVH_TIME_S, rate
    moves(results, "motion.bvh", turned, list(placed.values()), rate)


@known("inspect posterior.zarr", "*", source="its arrays, by zarr", runs=RUNS)
def inspect_says_what_posterior_zarr_has(results):
    is_coordinate = {path: len(shape) == 1 and path.rsplit("/", 1)[1] not in ("time",) for path, shape in results.shapes.items()}
    expected = {"title": whole(len(is_coordinate)), "frames": whole(results.frames), "draws": whole(len(results.draws["root"][0]))}
    expected |= {path.split("/")[0]: whole(1) for path in is_coordinate}
    expected |= {path: whole(*results.shapes[path]) for path, is_one in is_coordinate.items() if not is_one}
    says(results, "posterior.zarr", expected)


def scales(setup):
    """Median and root mean square of the drawn scales of the prior, by name."""
    return {scale["name"]: (np.median(scale["draws"]), np.sqrt(np.mean(np.square(scale["draws"])))) for scale in setup["lasting"]["scale"]}


def scale_of(name):
    """The scale of a constant, and the tails of its prior: variance over that of a Gaussian."""
    kind = next(kind for kind, parts in KINDS.items() if any(part in name for part in parts))
    if ".bias_" in name:
        return f"bias_{kind}_m", TAILS
    if ".place_" in name:
        return {"head": "places_head_feet_m", "feet": "places_head_feet_m", "hips": "places_hips_m"}.get(kind, "places_m"), 1
    return (None, 1) if name.startswith("body.") else ("cameras", TAILS)


def constants(setup):
    """Of each constant, by name: its mean less the prior's, its standard deviation and the prior's."""
    drawn, found = scales(setup), {}
    for row in setup["lasting"]["number"]:
        scale, tails = scale_of(row["name"])
        median, square = drawn[scale] if scale else (1, 1)
        found[row["name"]] = np.array([row["value"] - row.get("prior_mean", 0), np.std(row["draws"]), row["prior_sd"] * np.sqrt(tails) * square / median])
    return found


def between_cameras(setup):
    """By how much each camera is later than the mean of all: mean, standard deviation, and the prior's at the median of its scale; with what all share."""
    rows = {row["name"].split(".")[0]: row for row in setup["lasting"]["number"] if row["name"].endswith(".lag_s")}
    lags = np.array([row["value"] + np.array(row["draws"]) for row in rows.values()])
    later = lags - lags.mean(0)
    prior = [row["prior_sd"] * np.sqrt(TAILS * (1 - 1 / len(rows))) for row in rows.values()]
    return {name: np.array([own.mean(), own.std(), sd]) for name, own, sd in zip(rows, later, prior)}, lags.mean(0).std()


def shown(numbers, factor, places):
    """Means, standard deviations, and the prior's."""
    numbers = factor * np.array(numbers)
    return [(value, places) for value in (*numbers[:, 0], *numbers[:, 1], numbers[0, 2])]


@once
def lasting(results):
    """What is said of constants; of principal points in pixels where the cameras are known."""
    setup = results.setup
    known_of, (later, shared) = constants(setup), between_cameras(setup)
    expected = {}
    for name in setup["lasting"]["cameras"]:
        units = {"turn": (np.degrees(1), 2), "place": (1e3, 1), "focal length": (100, 2), "principal point": (1e3, 1), "k1": (1, 3)}
        if "inspect Calib.toml" in results.tables:
            units["principal point"] = (results.cameras[name]["matrix"][0][0], 1)
        expected |= {f"{name} {what}": shown([known_of[f"{name}.{part}"] for part in PARTS[what]], *unit) for what, unit in units.items()}
        expected[f"{name} later than all"] = shown([later[name]], 1e3, 1)
    expected["lag of all cameras"] = [(1e3 * shared, 1)]
    lengths = [name for name in known_of if name.startswith("body.") and name.count(".") == 1]
    expected |= {name[5:-2].replace("_", " "): whole(*(1e3 * known_of[name][1:])) for name in lengths}
    biases = {f"bias of {point} in {camera}": [f"{camera}.{point}.bias_{axis}_m" for axis in "uv"] for camera in setup["lasting"]["cameras"] for point in setup["lasting"]["points"]}
    places = {f"keypoint {point} on its link": [f"body.{point}.place_{axis}_m" for axis in "xyz"] for point in setup["lasting"]["points"]}
    for rows in (biases, places):
        rows = {row: [known_of[name] for name in names] for row, names in rows.items()}
        largest = sorted(rows, key=lambda row: -sum(mean**2 for mean, *_ in rows[row]))[:5]
        expected |= {row: shown(rows[row], 1e3, 1) for row in largest}
    kinds = [[known_of[name] for name in known_of if name.split(".", 1)[1] in parts] for parts in PARTS.values()]
    kinds += [[known_of[name] for name in lengths], *([known_of[name] for name in known_of if part in name] for part in (".place_", ".bias_")), later.values()]
    # The data say more than the prior where less than half of its variance is left.
    expected["learned from the data"] = [value for kind in kinds for value in whole(sum(sd**2 < prior**2 / 2 for _, sd, prior in kind), len(kind))]
    return expected


@known("inspect setup.toml", "*", source="the file; of constants moments of their draws, and of their priors' with the draws of the scales, by NumPy and SciPy", runs=RUNS)
def inspect_says_what_the_setup_found(results):
    setup, sizes = results.setup, results.setup["proportions"]
    expected = {"title": whole(len(setup["camera"])), "body": whole(len(results.draws["dof"]) + 3)}
    expected["model error"] = [(1e3 * setup["model_error_m"], 1)]
    expected["start frame"] = whole(setup["start_frame"])
    ends = [end for sds in (setup["motion_sd"][:3], setup["motion_sd"][3:]) for end in (min(sds), max(sds))]
    expected["motion sd"] = [(end, 2) for end in ends]
    expected["trajectory"] = [(setup["leapfrog_steps"], 0), (setup["step_size"], 3)]
    lengths = [sizes["spine"], 2 * sizes["shoulder_half_width"], 2 * sizes["hip_half_width"], *(sizes[name] for name in ("upper_arm", "forearm", "thigh", "shin"))]
    expected["lengths, m"] = [(length, 3) for length in lengths]
    for camera in setup["camera"]:
        expected[camera["name"]] = [(value, 1) for value in (*camera["offset_px"], camera["sigma_px"], 100 * camera["exchanged"], 100 * camera["elsewhere"])]
    if "lasting" in setup:
        expected |= lasting(results)
    says(results, "setup.toml", expected)
