"""The ledger of numbers, on finished results: every column has a check, every check holds, and sees each disturbance of its columns."""

import json
import shutil

import cameras
import frames
import inspected
import isb  # noqa: F401
import laws
import ledger
import motion  # noqa: F401
import overall  # noqa: F401
import page
import particles  # noqa: F401
import pytest
import report  # noqa: F401
import results
import visibility  # noqa: F401
import weighted  # noqa: F401

FPS = 30.0
# Of the smoothed run: a rate that is no whole number.
BROADCAST_FPS = 59.94
FIRST, LAST = 42, 54


@pytest.fixture(scope="session")
def runs(call, walk, tmp_path_factory):
    """Seven runs of one walk: filtered, smoothed, and with a set-up in which nothing lasts filtered by chains, by particles that are weighed, by chains with the angles of the ISB, and on masks by a search and a bootstrap filter. In one frame one camera sees the person."""
    folder = tmp_path_factory.mktemp("ledger")
    shutil.copytree(walk / "keypoints", folder / "keypoints")
    shutil.copy(walk / "Calib.toml", folder)
    for camera in ("C2", "C3", "C4"):
        (folder / f"keypoints/{camera}_json/{camera}.{FIRST + 7:04d}.json").write_text(json.dumps({"version": 1.3, "people": []}))
    common = ["track", "--calibration", "Calib.toml", "--frames", f"{FIRST}..{LAST}", "--seed", 1]
    every = [*common, "--keypoints", "keypoints", "--layout", "BODY_25B", "--patience", 1]
    # All draws are kept, so that what is said of them can be computed from them again.
    all_draws = ["--draws", 16 * 25]
    said = {"filtered": call(folder, *every, "--fps", FPS, *all_draws, "-o", "filtered")}
    setup = (folder / "filtered/setup.toml").read_text()
    (folder / "plain.toml").write_text(setup[: setup.index("[lasting]")])
    said["smoothed"] = call(folder, *every, "--fps", BROADCAST_FPS, "--smooth", "--draws", 128, "--setup", "filtered/setup.toml", "-o", "smoothed")
    said["weighted"] = call(folder, *every, "--fps", FPS, "--method", "guided", "--draws", 1000, "--setup", "plain.toml", "-o", "weighted")
    said["plain"] = call(folder, *every, "--fps", FPS, *all_draws, "--setup", "plain.toml", "-o", "plain")
    said["isb"] = call(folder, *every, "--fps", FPS, *all_draws, "--angles", "isb", "--setup", "plain.toml", "-o", "isb")
    # Of few particles on masks, so many draws that each is among them; by a flat score the bootstrap filter keeps many.
    on_masks = [*common, "--silhouettes", walk / "masks", "--init", walk / "truth.trc", "--fps", FPS, "--particles", 200, "--draws", 2000, "--setup", "plain.toml"]
    said["searched"] = call(folder, *on_masks, "--method", "hppf", "-o", "searched")
    said["bootstrap"] = call(folder, *on_masks, "--method", "bootstrap", "--kappa", 1, "-o", "bootstrap")
    numbers = list(range(FIRST, LAST))
    for name in said:
        call(folder, "report", name)
    rates = {name: BROADCAST_FPS if name == "smoothed" else FPS for name in said}
    recording = ["Calib.toml", "keypoints", "--layout", "BODY_25B", "--frames", f"{FIRST}..{LAST}", "--fps", FPS]
    looked_at = {name: call(folder, "inspect", name, *(f"{name}/{file}" for file in inspected.FILES), *(recording if name == "filtered" else [])) for name in inspected.RUNS}
    sights = cameras.Sights.of(laws.read(folder, FPS), numbers)
    return {name: results.read(folder / name, folder / "Calib.toml", text, rates[name], numbers, looked_at.get(name, ""), sights) for name, text in said.items()}


@pytest.mark.parametrize("check", ledger.CHECKS, ids=lambda check: check.run.__name__)
def test_a_check_holds(runs, check):
    for run in check.runs:
        check.run(runs[run])


def columns(runs):
    """Every column of every file, with the run that has it."""
    return [(run, file, column) for run, read in runs.items() for file in read.tables for column in read.tables[file]]


def test_every_column_is_known_or_named_as_unknown(runs):
    found = {(file, column) for _, file, column in columns(runs)}
    known = {(file, column) for file, column in found if any(check.knows(run, file, column) for check in ledger.CHECKS for run in check.runs)}
    elsewhere, unknown = ({(file, column) for file, column in found if page.is_listed(kind, file, column)} for kind in ("test", "unknown"))
    assert not found - known - elsewhere - unknown, sorted(found - known - elsewhere - unknown)
    assert not (known | elsewhere) & unknown, sorted((known | elsewhere) & unknown)


def test_every_disturbance_is_seen(runs):
    """A column that is wrong in each of several ways makes one of its checks fail."""
    unseen = []
    tried = 0
    for run, file, column in columns(runs):
        checks = [check for check in ledger.CHECKS if check.knows(run, file, column)]
        if not checks:
            continue
        for name, after in ledger.ways(runs[run].tables[file], column).items():
            tried += 1
            if page.is_unseen(file, column, name):
                continue
            if not any(ledger.fails(check, ledger.disturbed(runs[run], file, column, after)) for check in checks):
                unseen.append(f"{run} {file} {column}: {name}")
    assert tried > 500
    assert not unseen, "\n".join(unseen)


def test_the_page_is_current():
    assert page.PATH.read_text() == page.written(), "run `python tests/ledger/page.py`"
