"""A bootstrap filter of one dimension: `particles` (NumPy, numba) and sinew-tracking on one core, side by side.

    python3 -m pip install particles==0.4     # into an environment of its own; this script installs nothing
    taskset -c 0 python3 crates/sinew-studies/peers/particles_filter.py

Model: x_t = x_{t-1} + N(0, 1), y_t = x_t + N(0, 1), 100 frames, systematic resampling in every frame. Rows: nanoseconds a
particle and frame, the least of five runs each; sinew's model by methods on one state, and on blocks of eight. The exact
log evidence is that of the Kalman filter.
"""

import os
import subprocess
import time

for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
import particles
from particles import distributions, state_space_models

FRAMES = 100
REPEATS = 5


class Walk(state_space_models.StateSpaceModel):
    def PX0(self):
        return distributions.Normal()

    def PX(self, t, xp):
        return distributions.Normal(loc=xp)

    def PY(self, t, xp, x):
        return distributions.Normal(loc=x)


def exact(series):
    variance, mean, total = 1.0, 0.0, 0.0
    for frame, y in enumerate(series):
        variance += frame > 0
        spread = variance + 1
        total -= 0.5 * ((y - mean) ** 2 / spread + np.log(2 * np.pi * spread))
        mean += variance / spread * (y - mean)
        variance -= variance**2 / spread
    return total


def theirs(series, count):
    least = np.inf
    for _ in range(REPEATS):
        model = state_space_models.Bootstrap(ssm=Walk(), data=series)
        run = particles.SMC(fk=model, N=count, resampling="systematic", ESSrmin=1.0)
        start = time.perf_counter()
        run.run()
        least = min(least, time.perf_counter() - start)
    return 1e9 * least / (count * FRAMES), run.logLt


def main():
    draws = np.random.default_rng(1)
    series = np.cumsum(draws.normal(size=FRAMES)) + draws.normal(size=FRAMES)
    build = ["cargo", "build", "--release", "--package", "sinew-tracking", "--example", "filter_speed"]
    subprocess.run(build, check=True)
    program = os.path.join(os.environ.get("CARGO_TARGET_DIR", "target"), "release", "examples", "filter_speed")
    text = " ".join(repr(float(y)) for y in series)
    print(f"exact log evidence {exact(series):.3f}\n")
    print("| N | particles | log evidence | sinew, one state | log evidence | eight | log evidence | ratios |")
    print("|--:|--:|--:|--:|--:|--:|--:|--:|")
    theirs(series, 100)
    for count in (1_000, 10_000, 100_000):
        ns, found = theirs(series, count)
        ours = subprocess.run([program, str(count)], input=text, capture_output=True, text=True, check=True)
        one, first, eight, second = ours.stdout.split()
        ratios = f"{float(one) / ns:.2f}, {float(eight) / ns:.2f}"
        print(f"| {count} | {ns:.1f} | {found:.3f} | {one} | {first} | {eight} | {second} | {ratios} |")


if __name__ == "__main__":
    main()
