"""Arrays that belong together, by name; they can be copied and pickled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from . import _arviz

if TYPE_CHECKING:
    from ._sinew import Camera


@dataclass(frozen=True, eq=False)
class Triangulated:
    """Points with what the pixels know about them."""

    points: NDArray[np.float64]
    """(..., 3), metres; NaN where fewer than two cameras agree."""
    covariances: NDArray[np.float64]
    """(..., 3, 3), square metres, for independent pixel errors of `sigma_px`."""
    errors_px: NDArray[np.float64]
    """(...), mean pixel distance over the cameras used, before the refinement."""
    residuals_px: NDArray[np.float64]
    """(..., cameras, 2), observed minus projected, pixels; NaN where a camera was not used."""
    used: NDArray[np.bool_]
    """(..., cameras), whether the camera was used."""


@dataclass(frozen=True, eq=False)
class Simulated:
    """What cameras saw of a person who walks, and where they were."""

    cameras: list[Camera]
    """The cameras, as their calibration has them."""
    keypoints: NDArray[np.float64]
    """(frames, cameras, 1, keypoints, 3): u, v in pixels and confidence; NaN where nothing was detected."""
    layout: list[str | None]
    """Names of the keypoints, BODY_25B."""
    truth: NDArray[np.float64]
    """(frames, points, 3), true places of all points of the body, metres."""
    points: list[str]
    """Names of these points."""
    poses: NDArray[np.float64]
    """(frames, dof), true state of the body h32, metres and radians."""
    rate_hz: float
    """Frames per second."""

    def __repr__(self) -> str:
        return f"Simulated({len(self.truth)} frames at {self.rate_hz:g} per second, {len(self.cameras)} cameras)"


@dataclass(frozen=True, eq=False)
class ChainDraws:
    """Draws of several chains; `print` shows their summary."""

    draws: NDArray[np.float64]
    """(chains, draws, dim), in the units of the state."""
    lp: NDArray[np.float64]
    """(chains, draws), log density of each draw."""
    acceptance_rate: NDArray[np.float64]
    """(chains, draws), probability with which the trajectory was accepted."""
    energy: NDArray[np.float64]
    """(chains, draws), Hamiltonian."""
    diverging: NDArray[np.bool_]
    """(chains, draws), whether the trajectory diverged."""
    leapfrog_steps: NDArray[np.uint32]
    """(chains, draws), gradients that the trajectory took."""
    depth: NDArray[np.uint32]
    """(chains, draws), doublings of its tree; 0 for trajectories of fixed length."""
    step_size: float
    """Step size of the trajectories, in units of the learned metric."""
    summary: str
    """Mean, deviation, effective sample sizes and R-hat of each coordinate, and what speaks against the draws."""
    warnings: list[str]
    """What speaks against the draws; each was given to `warnings.warn`, too."""

    def to_arviz(self, names: Sequence[str] | None = None) -> Any:
        """The chains as `arviz.InferenceData` (ArviZ 0.x) or `xarray.DataTree` (ArviZ 1.x).

        Parameters
        ----------
        names
            A name for each coordinate; by default all are one variable `x` over (chain, draw, coordinate).
        """
        dims = ("chain", "draw")
        coords = {dim: np.arange(n) for dim, n in zip(dims, self.lp.shape, strict=True)}
        if names is None:
            posterior: dict[str, Any] = {"x": ((*dims, "coordinate"), self.draws)}
        else:
            columns = np.moveaxis(self.draws, 2, 0)
            posterior = {name: (dims, of) for name, of in zip(names, columns, strict=True)}
        stats = {
            "lp": (dims, self.lp),
            "acceptance_rate": (dims, self.acceptance_rate),
            "energy": (dims, self.energy),
            "diverging": (dims, self.diverging),
            "n_steps": (dims, self.leapfrog_steps),
            "tree_depth": (dims, self.depth),
            "step_size": (dims, np.full(self.lp.shape, self.step_size)),
        }
        return _arviz.tree({"posterior": xr.Dataset(posterior, coords), "sample_stats": xr.Dataset(stats, coords)})

    def __repr__(self) -> str:
        return f"ChainDraws(draws {self.draws.shape}, step size {self.step_size:.3f})"

    def __str__(self) -> str:
        return self.summary
