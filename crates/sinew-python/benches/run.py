"""A call of `sinew.track` on 1,000 frames beside the program, in turns.

    python crates/sinew-python/benches/run.py target/release/sinew [frames] [rounds]

Both read the same files of a simulated recording, on one thread each, and write the same bytes; the call runs in a
process that has imported the package. Times are seconds: the least and the median; the ratio is that of the turns, with
the standard error of its mean. Processor time is taken, too, which other load on the machine disturbs less.
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import sinew

FPS = 30


def used(of):
    usage = resource.getrusage(of)
    return usage.ru_utime + usage.ru_stime


def main():
    program, frames, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1000, 7
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else rounds
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        walk = sinew.simulate(duration_s=frames / FPS, fps=FPS, seed=1)
        sinew.write(folder / "Calib.toml", walk.cameras)
        sinew.write(folder / "pose", sinew.Keypoints([camera.name for camera in walk.cameras], walk.keypoints))
        options = {"fps": FPS, "layout": "BODY_25B", "frames": (0, frames), "threads": 1, "seed": 1}
        typed = f"--fps {FPS} --layout BODY_25B --frames 0..{frames} --threads 1 --seed 1 --force -q --no-progress"
        paths = ["--calibration", folder / "Calib.toml", "--keypoints", folder / "pose", "-o", folder / "program"]
        times = {"program": [], "call": []}
        for _ in range(rounds):
            begun, before = time.perf_counter(), used(resource.RUSAGE_CHILDREN)
            ended = subprocess.run([program, "track", *typed.split(), *paths], capture_output=True)
            # 4: a diagnostic failed; the results are written all the same.
            assert ended.returncode in (0, 4), ended.stderr.decode()
            times["program"].append((time.perf_counter() - begun, used(resource.RUSAGE_CHILDREN) - before))
            begun, before = time.perf_counter(), used(resource.RUSAGE_SELF)
            sinew.track(folder / "Calib.toml", folder / "pose", out=folder / "call", force=True, progress=False, **options)
            times["call"].append((time.perf_counter() - begun, used(resource.RUSAGE_SELF) - before))
        for path in sorted((folder / "program").rglob("*")):
            same = folder / "call" / path.relative_to(folder / "program")
            if path.is_file() and path.name != "timings.json":
                assert path.read_bytes() == same.read_bytes(), path.name
    for kind, place in [("elapsed", 0), ("processor", 1)]:
        of = {name: [turn[place] for turn in turns] for name, turns in times.items()}
        ratios = [call / program for call, program in zip(of["call"], of["program"], strict=True)]
        error = statistics.stdev(ratios) / len(ratios) ** 0.5 if len(ratios) > 1 else float("nan")
        for name, turns in of.items():
            print(f"{kind:10} {name:8} {min(turns):8.3f} s {statistics.median(turns):8.3f} s")
        print(f"{kind:10} ratio    {statistics.mean(ratios):8.3f} +- {error:.3f}, of the least {min(of['call']) / min(of['program']):.3f}")


if __name__ == "__main__":
    main()
