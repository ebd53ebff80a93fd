"""What a user writes, for a type checker in strict mode."""

from pathlib import Path
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import sinew


def standard_normal(states: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return -0.5 * (states**2).sum(axis=1), -states


def main(folder: Path) -> None:
    body = sinew.Body("h32", sizes={"thigh": 0.44})
    poses = np.zeros((7, body.dof))
    positions, jacobian = body.jacobian(poses)
    assert_type(positions, NDArray[np.float64])
    print(positions.shape, jacobian.shape, body.joints[0][1])

    camera = sinew.Camera.look_at("C1", (0, -4, 1), (0, 0, 1), image_size_px=(640, 480), focal_px=500)
    pixels = camera.project(positions)
    found = sinew.triangulate([camera, camera], np.stack([pixels, pixels], axis=-2))
    assert_type(found.used, NDArray[np.bool_])

    walk = sinew.simulate(duration_s=1.0)
    result = sinew.track(walk.cameras, walk.keypoints, layout=walk.layout, fps=walk.rate_hz, frames=(0, 10), seed=7)
    assert_type(result, sinew.Result | sinew.People)
    if isinstance(result, sinew.Result):
        print(result.joints["x_mean_m"].mean(), result.summary["seed"], result.complete)
    else:
        print([person.path for person in result.people if person is not None])

    chains = sinew.samplers.nuts(standard_normal, np.zeros((4, 2)), draws=100, seed=1)
    assert_type(chains.draws, NDArray[np.float64])
    weights, log_sum = sinew.particles.normalise(chains.lp.ravel())
    print(log_sum, sinew.particles.resample(weights, 10, scheme="stratified"))

    try:
        sinew.write(folder / "Calib.toml", sinew.read_calibration(folder / "cameras.yml"))
    except sinew.SinewError as error:
        print(error.exit_code, error.help)


if __name__ == "__main__":
    main(Path.cwd())
