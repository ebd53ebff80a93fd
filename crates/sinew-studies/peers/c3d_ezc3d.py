"""What ezc3d reads in C3D files, and whether sinew reads and writes the same: numbers that tests of sinew-formats hold.

    python3 -m pip install ezc3d==1.7.2 c3d==0.6.0 numpy==2.4.6     # into an environment of its own
    python3 crates/sinew-studies/peers/c3d_ezc3d.py SAMPLES            # prints the numbers of crates/sinew-formats/tests/c3d/samples.rs
    python3 crates/sinew-studies/peers/c3d_ezc3d.py SAMPLES SINEW      # compares with the program SINEW as well

SAMPLES is the folder c3d_samples of the shared data. The comparison takes each sample as it is and as each of the three
processors would have written it, lets ezc3d and `sinew convert` read them, and compares every coordinate. Then
`sinew convert` writes C3D files: of each sample and processor again with all that it holds, one with 70,000 frames and one with 300 points, which ezc3d reads. The transcoder is
written here from the format's manual and shares no code with either reader.

ezc3d 1.7.2 differs from the manual in the fourth number of a point: of words it takes the high byte for the residual and
the low byte for the cameras (the high bytes of the first sample have at least two bits in all but 14 points, as rays
that meet must), and the real 65535, which is the word -1, is a point at the origin to it. Both are taken from the bytes
here. It refuses files of MIPS: their coordinates are compared with those that it reads in the original, and the package
c3d reads the file, its residuals as well.
"""

import csv
import math
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import c3d as c3d_package
import ezc3d
import numpy as np

SAMPLES = ["cmu_dribble_shoot_basketball", "JA1Gait35", "trial2"]
INTEL, DEC, MIPS = 84, 85, 86
UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


def opened(path):
    return ezc3d.c3d(str(path))


def value(c3d, group, name):
    return c3d["parameters"][group][name]["value"]


def fourth_words(path, points, frames):
    """The fourth number of each point as a word with sign (frames x points), from the bytes."""
    data = path.read_bytes()
    coder = Transcoder(data, INTEL)
    width = 4 if coder.is_real() else 2
    size = 4 * points + coder.stored_word(4)
    start = (coder.stored_word(16) - 1) * 512
    table = np.frombuffer(data, "<i2" if width == 2 else "<f4", size * frames, start)
    return table.reshape(frames, size)[:, 3 : 4 * points : 4].astype(np.int32).astype(np.int16)


def describe(path):
    c3d = opened(path)
    points = c3d["data"]["points"]
    analogs, header = c3d["data"]["analogs"], c3d["header"]
    fourth = fourth_words(path, *points.shape[1:])
    scale = abs(value(c3d, "POINT", "SCALE")[0])
    print(path.name)
    print("  points", points.shape[1], "frames", points.shape[2], "rate", header["points"]["frame_rate"])
    print("  first frame", header["points"]["first_frame"] + 1, "units", value(c3d, "POINT", "UNITS"))
    print("  screen", value(c3d, "POINT", "X_SCREEN"), value(c3d, "POINT", "Y_SCREEN"))
    labels = value(c3d, "POINT", "LABELS")
    print("  labels", labels[0], labels[-1])
    print("  missing", int((fourth < 0).sum()), "with a residual", int(((fourth >= 0) & (fourth & 0xFF > 0)).sum()))
    for frame, point in [(0, 0), (0, -1), (100 % points.shape[2], 5), (-1, 0), (-1, -1)]:
        word = int(fourth[frame, point])
        print("  point", frame, point, points[:3, point, frame].tolist(), (word & 0xFF) * scale, word >> 8)
    print("  channels", analogs.shape[1], "samples", analogs.shape[2], "rate", header["analogs"]["frame_rate"])
    if analogs.shape[1]:
        names, units = value(c3d, "ANALOG", "LABELS"), value(c3d, "ANALOG", "UNITS")
        print("  channel names", names[0], names[-1], "units", units[0], units[-1])
        for channel, sample in [(0, 0), (3, 7), (-1, -1), (2, 100), (8, analogs.shape[2] // 2)]:
            print("  sample", channel, sample, analogs[0, channel, sample])
    if "EVENT" in c3d["parameters"] and value(c3d, "EVENT", "USED")[0]:
        times = np.array(value(c3d, "EVENT", "TIMES"))
        seconds = 60 * times[0] + times[1]
        rows = zip(seconds.tolist(), value(c3d, "EVENT", "CONTEXTS"), value(c3d, "EVENT", "LABELS"))
        print("  events", [list(row) for row in rows])


class Transcoder:
    """A file of Intel or DEC for another processor."""

    def __init__(self, data, processor):
        self.data, self.out, self.processor = data, bytearray(data), processor
        self.processor_at = (data[0] - 1) * 512 + 3
        self.of = data[self.processor_at]

    def stored_word(self, at):
        return struct.unpack_from("<H", self.data, at)[0]

    def stored_bits(self, at):
        """Bits of the IEEE number."""
        if self.of == INTEL:
            return struct.unpack_from("<I", self.data, at)[0]
        high, low = struct.unpack_from("<HH", self.data, at)
        bits = high << 16 | low
        # The exponent of a VAX number is larger by 2.
        return bits - (2 << 23) if bits & 0x7F800000 else 0

    def is_real(self):
        return bool(self.stored_bits(12) >> 31)

    def word(self, at):
        if self.processor == MIPS:
            self.out[at : at + 2] = self.data[at : at + 2][::-1]

    def real(self, at):
        bits = self.stored_bits(at)
        if self.processor == DEC:
            bits = bits + (2 << 23) if bits & 0x7F800000 else 0
            four = struct.pack("<HH", bits >> 16, bits & 0xFFFF)
        else:
            four = struct.pack(">I" if self.processor == MIPS else "<I", bits)
        self.out[at : at + 4] = four

    def header(self):
        for number in [2, 3, 4, 5, 6, 9, 10, 147, 148, 149, 150, 151, 152, 198]:
            self.word(2 * number - 2)
        for number in [7, 11, *range(153, 189, 2)]:
            self.real(2 * number - 2)

    def parameters(self):
        self.out[self.processor_at] = self.processor
        at = self.processor_at + 1
        while self.data[at]:
            length, group = struct.unpack_from("bb", self.data, at)
            link = at + 2 + abs(length)
            step = self.stored_word(link)
            self.word(link)
            if group > 0:
                kind, rank = struct.unpack_from("bB", self.data, link + 2)
                count = math.prod(self.data[link + 4 : link + 4 + rank])
                for index in range(count):
                    place = link + 4 + rank + index * abs(kind)
                    if kind == 2:
                        self.word(place)
                    if kind == 4:
                        self.real(place)
            if step == 0:
                break
            at = link + step

    def frames(self):
        start, number, width = (self.stored_word(16) - 1) * 512, self.word, 2
        if self.is_real():
            number, width = self.real, 4
        for at in range(start, len(self.data) - width + 1, width):
            number(at)

    def file(self):
        self.header()
        self.parameters()
        self.frames()
        return bytes(self.out)


def converted(sinew, source, target):
    subprocess.run([sinew, "convert", str(source), str(target), "--force"], check=True, capture_output=True)


def table(path):
    """Names and positions (frames x points x 3, world, metres) of a table of points."""
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    names = [name.removesuffix("_x_m") for name in header[1::3]]
    numbers = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    return names, numbers[:, 1:].reshape(len(rows), -1, 3)


def world(path):
    """The same from ezc3d."""
    c3d = opened(path)
    points = c3d["data"]["points"][:3].transpose(2, 1, 0) * UNITS[value(c3d, "POINT", "UNITS")[0]]
    if value(c3d, "POINT", "Y_SCREEN")[0] == "+Y":
        points = points[:, :, [2, 0, 1]]
    labels = [label for key in ("LABELS", "LABELS2") if key in c3d["parameters"]["POINT"] for label in value(c3d, "POINT", key)]
    return labels, points


def compare(what, sinew, c3d, folder, missing, original=None):
    """`missing` (frames x points) is what the file itself says; `original` is what ezc3d reads in place of the file."""
    converted(sinew, c3d, folder / "out.csv")
    names, ours = table(folder / "out.csv")
    labels, theirs = world(original or c3d)
    assert names == labels, (what, names, labels)
    assert ours.shape == theirs.shape, (what, ours.shape, theirs.shape)
    assert (np.isnan(ours).any(2) == missing).all(), what
    assert (theirs[missing][~np.isnan(theirs[missing])] == 0).all(), what
    largest = np.abs(ours - theirs)[~missing].max()
    print(f"  {what}: {ours.shape[1]} points, {ours.shape[0]} frames, {int(np.isnan(ours[:, :, 0]).sum())} missing,",
          f"largest difference {largest:.1e} m")
    assert largest < 1e-6, what


def by_c3d(path, points, fourth):
    """The package c3d reads the MIPS file that ezc3d refuses: is it one?"""
    reader = c3d_package.Reader(open(path, "rb"))
    frames = np.array([frame for _, frame, _ in reader.read_frames()])
    seen = fourth >= 0
    largest = np.abs(frames[:, :, :3] - points)[seen].max()
    scale = abs(reader.get("POINT:SCALE").float_value)
    residuals = np.abs(frames[:, :, 3] - (fourth & 0xFF) * scale)[seen].max()
    print(f"  MIPS by the package c3d: largest difference {largest:.1e} of the file's unit, of residuals {residuals:.1e}")
    assert largest < 1e-3


def kept(what, sinew, c3d, folder, fourth, original):
    """From C3D to C3D all stays: ezc3d reads the same in what `sinew convert` makes of a file as in the `original`.

    `fourth` (frames x points) are the fourth numbers of the original, which the file must have as well.
    """
    target = folder / "whole.c3d"
    converted(sinew, c3d, target)
    ours, theirs = opened(target), opened(original)
    for data in ("points", "analogs"):
        a, b = ours["data"][data], theirs["data"][data]
        a, b = (a[:3], b[:3]) if data == "points" else (a, b)
        assert a.shape == b.shape, (what, data, a.shape, b.shape)
        seen = np.broadcast_to((fourth.T >= 0)[None], a.shape) if data == "points" else np.isfinite(b)
        off = np.abs(a - b)[seen].max() / max(np.abs(b)[seen].max(), 1e-12) if seen.any() else 0.0
        assert off < 1e-6, (what, data, off)
    points = theirs["data"]["points"].shape
    assert (fourth_words(target, *points[1:]) == np.where(fourth < 0, -1, fourth)).all(), (what, "residuals and cameras")
    about = {("POINT", "SCALE"), ("POINT", "DATA_START"), ("POINT", "FRAMES")}
    differing = []
    for group in theirs["parameters"]:
        for name in theirs["parameters"][group]:
            if name.startswith("__") or (group, name) in about:
                continue
            a, b = (file["parameters"][group][name]["value"] for file in (ours, theirs))
            if not np.array_equal(np.asarray(a), np.asarray(b)):
                differing.append(f"{group}:{name}")
    assert not differing, (what, differing)
    for key in ("eventsTime", "eventsLabel"):
        if key in theirs["header"].get("events", {}):
            assert np.array_equal(ours["header"]["events"][key], theirs["header"]["events"][key]), (what, key)
    count = sum(len(group) for group in theirs["parameters"].values())
    print(f"  {what}, whole: {points[1]} points, {theirs['data']['analogs'].shape[1]} channels, {count} parameters, events, residuals, cameras")


def written(sinew, folder, frames, points):
    """A table of points that `sinew convert` writes as C3D, with a point that is missing now and then."""
    rng = np.random.default_rng(1)
    positions = rng.normal(size=(frames, points, 3)).round(4)
    positions[::7, 0] = np.nan
    names = [f"point {number}" for number in range(points)]
    with open(folder / "in.csv", "w") as file:
        file.write(",".join(["time_s", *(f"{name}_{axis}_m" for name in names for axis in "xyz")]) + "\n")
        for frame, row in enumerate(positions.reshape(frames, -1)):
            file.write(",".join(repr(float(cell)) for cell in [frame / 100, *row]).replace("nan", "") + "\n")
    target = folder / "out.c3d"
    converted(sinew, folder / "in.csv", target)
    labels, found = world(target)
    assert labels == names
    assert (np.isnan(found) == np.isnan(positions)).all()
    print(f"  written: {points} points, {frames} frames, largest difference {np.nanmax(np.abs(found - positions)):.1e} m")
    assert np.nanmax(np.abs(found - positions)) < 1e-6
    compare("read again", sinew, target, folder, np.isnan(positions).any(2))


def main():
    samples = Path(sys.argv[1])
    paths = [samples / f"{name}.c3d" for name in SAMPLES]
    for path in paths:
        describe(path)
    if len(sys.argv) < 3:
        return
    sinew = sys.argv[2]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path in paths:
            print(path.name)
            points = opened(path)["data"]["points"]
            fourth = fourth_words(path, *points.shape[1:])
            compare("as it is", sinew, path, folder, fourth < 0)
            for name, processor in [("Intel", INTEL), ("DEC", DEC), ("MIPS", MIPS)]:
                target = folder / "transcoded.c3d"
                target.write_bytes(Transcoder(path.read_bytes(), processor).file())
                compare(name, sinew, target, folder, fourth < 0, path if processor == MIPS else None)
                kept(name, sinew, target, folder, fourth, path)
                if processor == MIPS:
                    by_c3d(target, points.transpose(2, 1, 0)[:, :, :3], fourth)
        written(sinew, folder, 70_000, 2)
        written(sinew, folder, 20, 300)


main()
