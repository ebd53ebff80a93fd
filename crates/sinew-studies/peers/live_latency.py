"""Latency of `sinew track --live`: from the last byte of a frame in to the first byte of its answer out.

The tracker runs on one core, this script and a process that does nothing but count on another. Times of both ends are of
one clock in this process. Frames are those of a simulated recording, forth and back, at a fixed rate.

    python3 crates/sinew-studies/peers/live_latency.py --seconds 600 --fps 60 --setup whole/setup.toml target/release/sinew walk
    python3 crates/sinew-studies/peers/live_latency.py … target/release/sinew walk -- --updates=8 --burn-in=2   # more arguments

where `walk` was made by `sinew simulate -o walk --fps 60`, and `whole` by `sinew track` of it.
"""

import argparse
import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path


def frames(folder):
    """The cameras of each frame, as they stand in a line."""
    by_frame = {}
    for camera in sorted(Path(folder, "keypoints").glob("*_json")):
        for file in sorted(camera.glob("*.json")):
            number = int(file.stem.rsplit(".", 1)[-1])
            by_frame.setdefault(number, {})[camera.name.removesuffix("_json")] = json.loads(file.read_text())
    return [json.dumps(by_frame[number], separators=(",", ":")) for number in sorted(by_frame)]


def forth_and_back(count, number):
    """Index of a frame in a recording that is played forwards, then backwards."""
    place = number % (2 * count - 2)
    return min(place, 2 * count - 2 - place)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("recording")
    parser.add_argument("--setup", required=True)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--fps", type=float, default=60)
    parser.add_argument("--layout", default="BODY_25B")
    parser.add_argument("--out", default="/tmp/live-latency")
    parser.add_argument("--first", action="store_true", help="real-time priority for the tracker, on a shared machine")
    parser.add_argument("--idle", action="store_true", help="leave the second core idle")
    parser.add_argument("more", nargs="*", help="more arguments of the tracker, after --")
    asked = parser.parse_args()
    lines = frames(asked.recording)
    os.sched_setaffinity(0, {1})
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        print("no real-time priority: the measuring process waits for the busy one", file=sys.stderr)

    def apart(cores, first=False):
        def place():
            os.sched_setscheduler(0, os.SCHED_FIFO if first else os.SCHED_OTHER, os.sched_param(int(first)))
            os.sched_setaffinity(0, cores)
        return place

    busy = [sys.executable, "-c", "while True: pass"]
    hog = None if asked.idle else subprocess.Popen(busy, preexec_fn=apart({1}))
    command = [asked.program, "track", "--live", "--calibration", f"{asked.recording}/Calib.toml", "--layout"]
    command += [asked.layout, "--fps", str(asked.fps), "--setup", asked.setup, "-o", asked.out, "--force", "-q"]
    tracker = subprocess.Popen(
        command + asked.more, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0, preexec_fn=apart({0}, asked.first)
    )
    sent, answered, ends = {}, {}, []

    def read():
        rest = b""
        while True:
            part = os.read(tracker.stdout.fileno(), 1 << 16)
            now = time.monotonic_ns()
            if not part:
                return
            for piece in (rest + part).split(b"\n")[:-1]:
                if piece.startswith(b'{"frame":'):
                    answered.setdefault(int(piece[9:piece.index(b",")]), now)
                elif piece.startswith(b'{"end"'):
                    ends.append(piece.decode())
            rest = (rest + part).split(b"\n")[-1]

    reader = threading.Thread(target=read)
    reader.start()
    count = int(asked.seconds * asked.fps)
    start = time.monotonic_ns() + 200_000_000
    load = os.getloadavg()
    for number in range(count):
        line = f'{{"frame":{number},"cameras":{lines[forth_and_back(len(lines), number)]}}}\n'.encode()
        due = start + int(1e9 * number / asked.fps)
        while (left := due - time.monotonic_ns()) > 0:
            time.sleep(left / 1e9)
        tracker.stdin.write(line)
        sent[number] = time.monotonic_ns()
    tracker.stdin.close()
    reader.join()
    tracker.wait()
    if hog:
        hog.kill()
    took = sorted((answered[n] - sent[n]) / 1e6 for n in sent if n in answered)
    share = lambda p: took[min(len(took) - 1, int(p * len(took)))]
    print(f"frames sent {count}, answered {len(took)}; load before {load[0]:.1f}, after {os.getloadavg()[0]:.1f}")
    quantiles = [("least", 0.0), ("10 %", 0.1), ("median", 0.5), ("90 %", 0.9), ("99 %", 0.99), ("99.9 %", 0.999)]
    print(", ".join(f"{name} {share(p):.2f} ms" for name, p in quantiles) + f", most {took[-1]:.2f} ms")
    print(*ends, f"exit code {tracker.returncode}")


if __name__ == "__main__":
    main()
