"""Cameras without distortion by SciPy's rotations: where they show points, where points lie that they show, and how they differ from their calibration."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

# Keypoints of lower confidence do not count.
LEAST_CONFIDENCE = 0.3
# Standard deviations beyond which a keypoint is left out, and from which on it counts less (Huber); steps to a point.
GROSS, HUBER, STEPS = 5, 1.345, 12
# Mean distance from which on cameras do not agree, px.
AGREE = 15
# Of the scatter, the least and what is assumed at first, px; the change at which rounds end, px, and rounds at most.
LEAST_SIGMA, FIRST_SIGMA, MOVED, ROUNDS = 0.5, 10, 0.05, 30
OF_CAMERA = [*(f"rotation_{axis}_rad" for axis in "xyz"), *(f"translation_{axis}_m" for axis in "xyz"), "log_focal_length", "principal_point_u", "principal_point_v"]


class Cameras:
    """Cameras of a calibration file, in its order."""

    def __init__(self, tables):
        tables = list(tables)
        assert not any(np.any(table["distortions"]) for table in tables)
        self.matrices = np.array([table["matrix"] for table in tables])
        self.rotations = np.array([Rotation.from_rotvec(table["rotation"]).as_matrix() for table in tables])
        self.translations = np.array([table["translation"] for table in tables])

    def centres(self):
        return -np.einsum("cji,cj->ci", self.rotations, self.translations)

    def pixels(self, points):
        """… × 3 → … × cameras × 2."""
        there = np.einsum("cij,...j->...ci", self.rotations, points) + self.translations
        return self.focal() * there[..., :2] / there[..., 2:] + self.matrices[:, :2, 2]

    def focal(self):
        return np.stack([self.matrices[:, 0, 0], self.matrices[:, 1, 1]], -1)

    def derivatives(self, points):
        """… × 3 → … × cameras × 2 × 3, of pixels by points."""
        there = np.einsum("cij,...j->...ci", self.rotations, points) + self.translations
        by_own = np.zeros((*there.shape[:-1], 2, 3))
        by_own[..., 0, 0] = by_own[..., 1, 1] = 1 / there[..., 2]
        by_own[..., 2] = -there[..., :2] / there[..., 2:] ** 2
        return self.focal()[..., None] * (by_own @ self.rotations)

    def linear(self, pixels, confidence):
        """Points by the direct linear transform, rows times the confidence; NaN where fewer than two cameras count."""
        whole = self.matrices @ np.concatenate([self.rotations, self.translations[..., None]], -1)
        rows = whole[:, :2] - np.nan_to_num(pixels)[..., None] * whole[:, 2:]
        rows = (confidence[..., None, None] * rows).reshape(len(pixels), -1, 4)
        found = np.linalg.svd(rows)[2][:, -1]
        points = found[:, :3] / found[:, 3:]
        points[(confidence > 0).sum(-1) < 2] = np.nan
        return points


def agreeing(cameras, pixels, confidence):
    """Points by the cameras that agree: while their mean distance is too large, the one without which it is least is left out."""
    points = cameras.linear(pixels, confidence)
    for k, (pixel, counts) in enumerate(zip(pixels, confidence)):
        counts, point = counts.copy(), points[k]

        def error(point, counts):
            return np.linalg.norm(pixel - cameras.pixels(point), axis=-1)[counts > 0].mean()

        while np.isfinite(point).all() and error(point, counts) >= AGREE:
            if (counts > 0).sum() <= 2:
                point = np.full(3, np.nan)
                break
            fewer = [np.where(np.arange(len(counts)) == gone, 0, counts) for gone in np.flatnonzero(counts)]
            tried = [(error(cameras.linear(pixel[None], less[None])[0], less), k) for k, less in enumerate(fewer)]
            counts = fewer[min(tried)[1]]
            point = cameras.linear(pixel[None], counts[None])[0]
        points[k] = point
    return points


def robust(cameras, pixels, confidence, sigma):
    """Huber's estimate of points without what is gross: points, views that count, residuals, and leverages by axis."""
    points = cameras.linear(pixels, confidence)
    is_point = np.isfinite(points).all(-1)
    counts = (confidence > 0) & is_point[:, None]
    points[~is_point] = 0
    for _ in range(STEPS):
        residual = np.where(counts[..., None], pixels - cameras.pixels(points), 0)
        scaled = np.linalg.norm(residual, axis=-1) / sigma
        weight = np.where(counts, np.minimum(1, HUBER / np.maximum(scaled, 1e-9)), 0) / sigma**2
        slope = cameras.derivatives(points)
        normal = np.einsum("nc,ncai,ncaj->nij", weight, slope, slope) + np.eye(3) * ~is_point[:, None, None]
        points = points + np.linalg.solve(normal, np.einsum("nc,ncai,nca->ni", weight, slope, residual)[..., None])[..., 0]
    leverage = weight[..., None] * np.einsum("ncai,nij,ncaj->nca", slope, np.linalg.inv(normal), slope)
    points[~is_point] = np.nan
    found = points, counts, residual, leverage
    gross = np.flatnonzero(scaled.max(-1) > GROSS)
    if len(gross) > 0:
        # Of two views that disagree neither counts.
        fewer = np.where(counts[gross] & (counts[gross].sum(-1) > 2)[:, None], confidence[gross], 0)
        fewer[np.arange(len(gross)), scaled[gross].argmax(-1)] = 0
        for whole, part in zip(found, robust(cameras, pixels[gross], fewer, sigma)):
            whole[gross] = part
    return found


def offsets(cameras, pixels, confidence):
    """Offset (observed − projected) and scatter per axis of each camera, px; points × cameras × 2 and confidence that is 0 where nothing counts.

    Points are placed by all cameras less their offsets, and offsets are the medians of what remains, in turn. What moves all points and nothing else is settled so that, in the median, they lie where the cameras that agree put them without offsets.
    """
    count = len(cameras.matrices)
    plain = agreeing(cameras, pixels, confidence)
    offset, sigma = np.zeros((count, 2)), np.full(count, float(FIRST_SIGMA))
    for _ in range(ROUNDS):
        points, counts, residual, leverage = robust(cameras, pixels - offset, confidence, sigma)
        before, moved = sigma.copy(), np.zeros((count, 2))
        for c in range(count):
            own, lever = residual[counts[:, c], c], leverage[counts[:, c], c]
            moved[c] = np.median(own, axis=0)
            scatter = ((own - moved[c]) / np.sqrt(1 - lever))[lever < 0.9]
            sigma[c] = max(LEAST_SIGMA, 1.4826 * np.median(abs(scatter)))
        shift = np.nanmedian(plain - points, axis=0)
        offset = offset + moved - cameras.derivatives(np.nanmedian(points, axis=0)) @ shift
        if max(abs(moved).max(), abs(sigma - before).max()) < MOVED:
            break
    return offset, sigma


@dataclass
class Sights:
    """Keypoints of one person in some frames: frames × keypoints × cameras (× 2), confidence 0 where there is none."""

    names: list[str]
    cameras: Cameras
    pixels: np.ndarray
    confidence: np.ndarray

    @classmethod
    def of(cls, recording, numbers):
        """Of a recording as `laws.read` reads it."""
        count = max(len(points) for frames in recording.keypoints.values() for points in frames.values() if points is not None)
        nobody = np.zeros((count, 3))
        seen = np.array([[nobody if frames[number] is None else frames[number] for number in numbers] for frames in recording.keypoints.values()])
        seen = np.moveaxis(seen, 0, 2)
        return cls(list(recording.cameras), Cameras(recording.cameras.values()), seen[..., :2], seen[..., 2])

    def counting(self):
        """Pixels and confidence of all keypoints, of those that count."""
        pixels, confidence = self.pixels.reshape(-1, *self.pixels.shape[2:]), self.confidence.reshape(-1, len(self.names))
        return pixels, np.where(confidence >= LEAST_CONFIDENCE, confidence, 0)

    @cached_property
    def offsets(self):
        return offsets(self.cameras, *self.counting())

    @cached_property
    def distances(self):
        """Root mean square distance of each camera's keypoints from points by all cameras, px."""
        pixels, confidence = self.counting()
        squares = ((pixels - self.cameras.pixels(self.cameras.linear(pixels, confidence))) ** 2).sum(-1)
        return np.sqrt(np.nanmean(np.where(confidence > 0, squares, np.nan), axis=0))

    def hidden_shift(self, setup):
        """Standard deviation per axis of the shift of the world that the cameras' errors look like, m."""
        if "lasting" not in setup:
            return shift_of_offsets(self.cameras, np.array([camera["offset_px"] for camera in setup["camera"]]), np.array(setup["start_pose"][:3]))
        return shift_of_draws(self.cameras, self.names, setup["lasting"])


def shift_of_offsets(cameras, offset, middle):
    """Were offsets independent errors of the calibrations: by as many of them as no shift explains."""
    slope = cameras.derivatives(middle).reshape(-1, 3)
    variance = (offset**2).sum() / (len(slope) - 3)
    return np.sqrt(variance * np.trace(np.linalg.inv(slope.T @ slope)) / 3)


def shift_of_draws(cameras, names, lasting):
    """Of each draw of the cameras' errors the shift that looks most like it, at the middle of the person."""
    numbers = {row["name"]: row for row in lasting["number"]}
    middle = np.array(lasting["middle_m"])

    def moved(draw):
        errors = np.array([[numbers[f"{name}.{what}"]["value"] + (0 if draw is None else numbers[f"{name}.{what}"]["draws"][draw]) for what in OF_CAMERA] for name in names])
        there = np.einsum("cij,j->ci", cameras.rotations, middle) + cameras.translations
        there = Rotation.from_rotvec(errors[:, :3]).apply(there) + errors[:, 3:6]
        return cameras.focal() * (there[:, :2] / there[:, 2:] * np.exp(errors[:, 6:7]) + errors[:, 7:9])

    aside = np.array([moved(draw) - moved(None) for draw in range(len(lasting["number"][0]["draws"]))]).reshape(-1, 2 * len(names))
    shifts = np.linalg.lstsq(cameras.derivatives(middle).reshape(-1, 3), aside.T, rcond=None)[0]
    return np.sqrt(shifts.var(1).mean())
