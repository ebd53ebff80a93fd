"""Projection and triangulation against NumPy."""

import numpy as np
import pytest

import sinew


def ring(count=5, **options):
    angles = 0.3 + 2 * np.pi * np.arange(count) / count
    size = {"image_size_px": (640, 480), "focal_px": 500.0, **options}
    return [
        sinew.Camera.look_at(f"C{i}", (4 * np.cos(a), 4 * np.sin(a), 2.0), (0, 0, 1), **size)
        for i, a in enumerate(angles)
    ]


def cloud(count, seed):
    return np.random.default_rng(seed).normal(0, 0.3, (count, 3)) + [0, 0, 1]


def brown(camera, points):
    """OpenCV's formula."""
    k1, k2, p1, p2 = camera.distortion[:4]
    x, y, z = (points @ camera.rotation.T + camera.translation).T
    x, y = x / z, y / z
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2 * r2
    xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.stack([xd, yd], -1) * camera.focal_px + camera.centre_px


def distorted(camera):
    return sinew.Camera(
        camera.name,
        camera.image_size_px,
        (510, 505),
        camera.rotation,
        camera.translation,
        centre_px=(322, 238),
        distortion=[-0.1, 0.02, 1e-3, -5e-4],
    )


def test_pixels_are_those_of_the_formula():
    points = cloud(40, 1)
    for camera in map(distorted, ring()):
        np.testing.assert_allclose(camera.project(points), brown(camera, points), atol=1e-9)
        np.testing.assert_allclose(camera.rotation @ camera.position, -camera.translation, atol=1e-12)


def test_derivatives_are_differences_of_pixels():
    camera, points = distorted(ring()[0]), cloud(10, 2)
    pixels, by_point = camera.project_with_jacobian(points)
    np.testing.assert_array_equal(pixels, camera.project(points))
    for k in range(3):
        step = 1e-6 * np.eye(3)[k]
        numeric = (camera.project(points + step) - camera.project(points - step)) / 2e-6
        np.testing.assert_allclose(by_point[..., k], numeric, atol=1e-5)


def test_a_lens_is_taken_back():
    camera, points = distorted(ring()[0]), cloud(10, 3)
    ideal = points @ camera.rotation.T + camera.translation
    ideal = ideal[:, :2] / ideal[:, 2:] * camera.focal_px + camera.centre_px
    np.testing.assert_allclose(camera.undistort(camera.project(points)), ideal, atol=1e-7)


def test_what_is_behind_has_no_pixel():
    camera = ring()[0]
    assert np.isnan(camera.project(2 * camera.position - [0, 0, 1])).all()
    assert np.isnan(camera.project_with_jacobian([np.nan, 0, 0])[1]).all()


def linear(cameras, pixels):
    """The direct linear transform by NumPy's singular values."""
    rows = [uv[k] * c.matrix[2] - c.matrix[k] for c, uv in zip(cameras, pixels, strict=True) for k in (0, 1)]
    point = np.linalg.svd(np.array(rows))[2][-1]
    return point[:3] / point[3]


def test_points_come_back_and_agree_with_the_linear_transform():
    cameras, points = ring(), cloud(30, 4)
    pixels = np.stack([camera.project(points) for camera in cameras], 1)
    found = sinew.triangulate(cameras, pixels)
    np.testing.assert_allclose(found.points, points, atol=1e-9)
    expected = np.array([linear(cameras, seen) for seen in pixels])
    np.testing.assert_allclose(found.points, expected, atol=1e-9)
    assert found.used.all()


def test_covariances_hold_what_they_promise():
    """Over 4000 points: mean squared Mahalanobis distance 3 (sd 0.04), and the covariance of least squares."""
    cameras, sigma = [distorted(camera) for camera in ring()], np.array([0.5, 1.0, 2.0, 1.0, 0.7])
    points = cloud(4000, 5)
    exact = np.stack([camera.project(points) for camera in cameras], 1)
    noise = np.random.default_rng(6).normal(size=exact.shape) * sigma[:, None]
    found = sinew.triangulate(cameras, exact + noise, sigma_px=sigma)
    error = found.points - points
    distances = np.einsum("ni,nij,nj->n", error, np.linalg.inv(found.covariances), error)
    # Huber's weights lose 5 % where errors are Gaussian.
    assert 2.9 < distances.mean() < 3.5
    rows = np.stack([c.project_with_jacobian(points)[1] for c in cameras], 1) / sigma[:, None, None]
    plain = np.linalg.inv(np.einsum("ncai,ncaj->nij", rows, rows))
    ratio = np.trace(found.covariances, axis1=1, axis2=2) / np.trace(plain, axis1=1, axis2=2)
    assert 1.0 <= np.median(ratio) < 1.2


def test_a_camera_that_is_wrong_is_left_out():
    cameras, point = ring(), np.array([0.2, -0.1, 1.3])
    pixels = np.array([[*camera.project(point), 0.9] for camera in cameras])
    pixels[2, 0] += 200
    pixels[4, 2] = 0.1
    found = sinew.triangulate(cameras, pixels)
    assert found.used.tolist() == [True, True, False, True, False]
    np.testing.assert_allclose(found.points, point, atol=1e-9)
    assert np.isnan(found.residuals_px[2]).all()
    pixels[:, :2] = np.nan
    assert np.isnan(sinew.triangulate(cameras, pixels).points).all()


def test_wrong_arguments_are_named():
    cameras = ring()
    with pytest.raises(sinew.InputError, match=r"`pixels` has the shape \(4, 2\); expected \(..., cameras = 5, 2 or 3"):
        sinew.triangulate(cameras, np.zeros((4, 2)))
    with pytest.raises(sinew.InputError, match="`cameras`: 1 given; at least two"):
        sinew.triangulate(cameras[:1], np.zeros((1, 2)))
    with pytest.raises(sinew.InputError, match="`sigma_px` is -1; it must be positive"):
        sinew.triangulate(cameras, np.zeros((5, 2)), sigma_px=-1)
    with pytest.raises(sinew.InputError, match="`distortion` has 3 coefficients; expected 4 or 5 numbers: k1, k2, p1"):
        sinew.Camera("C", (2, 2), (1, 1), np.eye(3), np.zeros(3), distortion=[1, 2, 3])
    with pytest.raises(sinew.InputError, match="C: R'R differs from identity"):
        sinew.Camera("C", (2, 2), (1, 1), 2 * np.eye(3), np.zeros(3))
    with pytest.raises(sinew.InputError, match="no upright view"):
        sinew.Camera.look_at("C", (0, 0, 3), (0, 0, 0), image_size_px=(2, 2), focal_px=1)
