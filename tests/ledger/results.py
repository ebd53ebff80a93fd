"""A result folder as plain tables and arrays, read by pandas and zarr: nothing of `sinew` takes part."""

import io
import json
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import facts
import numpy as np
import pandas as pd
import zarr
from cameras import Sights
from report_html import curves, numbers_of_page

TABLES = ("joints.csv", "keypoints.csv", "angles.csv", "state.csv", "frames.csv", "markers_sd.csv")


@dataclass
class Results:
    """A result folder; `tables` are what a ledger's row can disturb, `draws` and the rest are what they are held against."""

    tables: dict[str, pd.DataFrame]
    draws: dict[str, np.ndarray]
    statistics: dict[str, np.ndarray]
    seen: dict[str, np.ndarray]
    skeleton: list[tuple[str, str | None, np.ndarray]]
    setup: dict
    cameras: dict
    fps: float
    numbers: list[int]
    shapes: dict[str, tuple[int, ...]]
    sights: Sights | None = None
    once: dict = field(default_factory=dict)

    @property
    def frames(self):
        """How many frames were tracked."""
        return len(self.numbers)

    def of(self, file, column, row):
        """A column as frames × names, the names in the order of the table's `row` column."""
        table = self.tables[file]
        return table[column].to_numpy().reshape(self.frames, -1), list(table[row].iloc[: len(table) // self.frames])


def read(folder: Path, calibration: Path, said: str, fps: float, numbers: list[int], inspected: str = "", sights: Sights | None = None) -> Results:
    """Reads the files of a run of these frames that said `said` on its way; `inspected` is what `sinew inspect` says of them, `sights` are the keypoints."""
    tables = {name: pd.read_csv(folder / name) for name in TABLES if (folder / name).exists()}
    tables["angles.mot"] = pd.read_csv(folder / "angles.mot", sep="\t", skiprows=7)
    tables["markers.trc"] = read_trc(folder / "markers.trc")
    tables["motion.bvh"], skeleton = read_bvh(folder / "motion.bvh")
    summary = json.loads((folder / "summary.json").read_text())
    tables["summary.json"] = pd.DataFrame([flat(summary)])
    tables["terminal"] = pd.DataFrame([numbers_said(said)])
    if (folder / "report.html").exists():
        html = (folder / "report.html").read_text()
        tables["report.html"] = pd.DataFrame([numbers_of_page(html)])
        tables["report.html curves"] = curves(html)
    tables |= facts.tables(inspected)
    groups = {name: zarr.open_group(folder / "posterior.zarr" / name, mode="r") for name in ("posterior", "sample_stats", "observed_data", "constant_data")}
    arrays = {name: {key: array[:] for key, array in group.arrays()} for name, group in groups.items()}
    return Results(
        tables,
        arrays["posterior"],
        arrays["sample_stats"],
        arrays["observed_data"],
        skeleton,
        tomllib.loads((folder / "setup.toml").read_text()),
        tomllib.loads(calibration.read_text()),
        fps,
        numbers,
        {f"{name}/{key}": array.shape for name, group in arrays.items() for key, array in group.items()},
        sights,
    )


def flat(value, prefix=""):
    """Numbers of nested tables and lists by their dotted place."""
    if isinstance(value, dict):
        parts = value.items()
    elif isinstance(value, list):
        parts = ((str(item.get("name") or item.get("joint") or k) if isinstance(item, dict) else str(k), item) for k, item in enumerate(value))
    else:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return {prefix: value} if number else {}
    found = {}
    for key, part in parts:
        found |= flat(part, f"{prefix}.{key}" if prefix else key)
    return found


def numbers_said(said):
    """The numbers on the terminal, by what they are of."""
    cameras = r"^(?P<camera>\S+)\s+residual (?P<residual>[\d.]+) px, offset (?P<offset_u>[+-][\d.]+) (?P<offset_v>[+-][\d.]+) px, (?P<frames>\d+) frames"
    lines = {
        "R-hat": r"^R-hat\s+median (?P<median>[\d.]+), 95 % (?P<p95>[\d.]+), (?P<above>\d+) frames? above 1\.05",
        "effective size": r"^effective size\s+median (?P<median>[\d.]+)",
        "frames": r"^frames\s+(?P<count>\d+) \(\d+\.\.\d+\), (?P<observed>\d+) observed",
    }
    found = {}
    for match in re.finditer(cameras, said, re.MULTILINE):
        values = match.groupdict()
        found |= {f"{values['camera']}.{name}": float(value) for name, value in values.items() if name != "camera"}
    for name, pattern in lines.items():
        if match := re.search(pattern, said, re.MULTILINE):
            found |= {f"{name}.{key}": float(value) for key, value in match.groupdict().items()}
    if match := re.search(r"^uncertainty\s+(.*)$", said, re.MULTILINE):
        found |= {f"uncertainty.{name}": float(share) for name, share in re.findall(r"([^,]+?) (\d+) %(?:, |$)", match[1])}
    return found


def read_trc(path):
    """A TRC file; columns `RHip.X` and so on, as the file has its axes."""
    lines = path.read_text().splitlines()
    markers = [name for name in lines[3].split("\t")[2:] if name]
    columns = ["Frame#", "Time", *(f"{marker}.{axis}" for marker in markers for axis in "XYZ")]
    rows = [[float(cell) for cell in line.split("\t")] for line in lines[5:] if line.strip()]
    return pd.DataFrame(rows, columns=columns)


def read_bvh(path):
    """A BVH file's channels, and its joints as (name, parent, offset)."""
    head, motion = path.read_text().split("MOTION")
    skeleton, channels, stack, ends = [], [], [], 0
    for line in head.splitlines():
        match line.split():
            case ["ROOT" | "JOINT", name]:
                skeleton.append([name, stack[-1] if stack else None, None])
                stack.append(name)
            case ["End", "Site"]:
                skeleton.append([f"end {stack[-1]}", stack[-1], None])
                stack.append(skeleton[-1][0])
            case ["OFFSET", *numbers]:
                skeleton[-1][2] = np.array(numbers, float)
            case ["CHANNELS", _, *names]:
                channels += [f"{stack[-1]}.{name}" for name in names]
            case ["}"]:
                stack.pop()
    _, frame_time, *rows = motion.strip().splitlines()
    table = pd.read_csv(io.StringIO("\n".join(rows)), sep=r"\s+", header=None, names=channels)
    table.insert(0, "time", np.arange(len(table)) * float(frame_time.split(":")[1]))
    return table, [tuple(joint) for joint in skeleton]
