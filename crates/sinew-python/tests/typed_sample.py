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
    assert_type(result, sinew.Result)
    print(result.joints["x_mean_m"].mean(), result.summary["seed"], result.complete, result[1].path)
    print([person.path for person in result.people.values()])
    sinew.track("Calib.toml", "pose", lag={"cam_02": 3}, outlier=0.05, setup_frames=range(60), up=(0, -1, 0))
    # A checker that lets these pass finds that the comments are not needed.
    sinew.track("Calib.toml", "pose", metod="hmc")  # type: ignore[call-arg]
    sinew.track("Calib.toml", "pose", method="hcm")  # type: ignore[arg-type]

    assert_type(sinew.read(folder / "walk.trc", sinew.Motion).values, NDArray[np.float64])
    sinew.read(folder / "walk.trc").values  # type: ignore[union-attr]

    chains = sinew.samplers.nuts(standard_normal, np.zeros((4, 2)), draws=100, seed=1)
    assert_type(chains.draws, NDArray[np.float64])
    weights, log_sum = sinew.particles.normalise(chains.lp.ravel())
    walker = sinew.particles.ParticleFilter(
        lambda rng, n: rng.normal(size=(n, 1)),
        lambda rng, states, frame: states + rng.normal(size=states.shape),
        lambda observation, states, frame: -0.5 * (states[:, 0] - observation) ** 2,
    )
    assert_type(walker.run([0.1, 0.3]).means, NDArray[np.float64])
    print(log_sum, sinew.particles.resample(weights, 10, scheme="stratified"))

    try:
        sinew.write(folder / "Calib.toml", sinew.read_calibration(folder / "cameras.yml"))
    except sinew.SinewError as error:
        print(error.exit_code, error.help)


if __name__ == "__main__":
    main(Path.cwd())
