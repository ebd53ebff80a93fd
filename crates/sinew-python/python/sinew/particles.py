"""Particle filters of models in NumPy, and their verbs: weights, effective numbers, resampling, tempering."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError
from ._sinew import effective_number, normalise, resample, tempering_exponent

__all__ = ["Filtered", "ParticleFilter", "effective_number", "normalise", "resample", "tempering_exponent"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Filtered:
    """What a particle filter found: p(state | observations so far) of each frame."""

    log_evidence: float
    """Estimate of log p(all observations), unbiased on the natural scale."""
    log_evidences: Array
    """(frames,), log p(observation | those before) of each frame."""
    means: Array
    """(frames, dim), in the units of the state."""
    variances: Array
    """(frames, dim), of each coordinate."""
    ess: Array
    """(frames,), effective number of particles."""
    states: Array
    """(frames, particles, dim)."""
    weights: Array
    """(frames, particles), which sum to 1 in each frame."""
    ancestors: NDArray[np.int64]
    """(frames, particles), where each particle was in the frame before."""

    def trajectories(self, draws: int, *, seed: int = 0) -> Array:
        """Draws of all states given all observations, (draws, frames, dim), along the ancestors of last particles.

        They share their early frames, which are known only where the frames are few or the particles many.
        """
        at = resample(self.weights[-1], draws, seed=seed)
        drawn = np.empty((draws, len(self.states), self.states.shape[2]))
        for frame in reversed(range(len(self.states))):
            drawn[:, frame] = self.states[frame, at]
            at = self.ancestors[frame, at]
        return drawn


class ParticleFilter:
    """The bootstrap particle filter (Gordon, Salmond & Smith 1993) of a state-space model written in NumPy.

    Parameters
    ----------
    initial
        Function of a NumPy generator and a number n: draws (n, dim) of the first state.
    transition
        Function of a generator, states (n, dim) and the number of the frame that they go to, from 1 on: the next
        states (n, dim).
    log_likelihood
        Function of an observation, states (n, dim) and the number of the frame: log p(observation | state), (n,).
        -inf is a state that cannot be; where nothing was observed, zeros.
    """

    def __init__(
        self,
        initial: Callable[[np.random.Generator, int], ArrayLike],
        transition: Callable[[np.random.Generator, Array, int], ArrayLike],
        log_likelihood: Callable[[Any, Array, int], ArrayLike],
    ) -> None:
        self._initial = initial
        self._transition = transition
        self._log_likelihood = log_likelihood

    def run(
        self,
        observations: Iterable[Any],
        *,
        particles: int = 1000,
        resample_below: float = 0.5,
        scheme: Literal["systematic", "stratified", "residual", "multinomial"] = "systematic",
        seed: int = 0,
    ) -> Filtered:
        """Filter all observations, one a frame.

        Parameters
        ----------
        observations
            Handed to `log_likelihood` one by one.
        particles
            Number of particles.
        resample_below
            They are resampled where their effective number is at most this share of them: 1 means always, 0 never.
        scheme
            As in `resample`.
        seed
            The same seed gives the same particles.
        """
        rng = np.random.default_rng(seed)
        states = _shaped("initial", self._initial(rng, particles), (particles, -1))
        weights, kept = np.full(particles, 1 / particles), []
        for frame, observation in enumerate(observations):
            ancestors = np.arange(particles)
            if frame > 0:
                if effective_number(weights) <= resample_below * particles:
                    ancestors = resample(weights, scheme=scheme, seed=int(rng.integers(2**63)))
                    weights = np.full(particles, 1 / particles)
                states = _shaped("transition", self._transition(rng, states[ancestors], frame), states.shape)
            likelihood = _shaped("log_likelihood", self._log_likelihood(observation, states, frame), (particles,))
            try:
                with np.errstate(divide="ignore"):
                    weights, log_evidence = normalise(np.log(weights) + likelihood)
            except InputError as error:
                raise InputError(f"frame {frame}: {error}") from error
            mean = weights @ states
            variance = weights @ (states - mean) ** 2
            kept.append((log_evidence, mean, variance, effective_number(weights), states, weights, ancestors))
        if not kept:
            raise InputError("`observations` is empty")
        log_evidences, *arrays = (np.array(of) for of in zip(*kept, strict=True))
        return Filtered(float(log_evidences.sum()), log_evidences, *arrays)


def _shaped(name: str, value: ArrayLike, shape: tuple[int, int] | tuple[int]) -> Array:
    """What a function returned, if it has that shape; -1 is any length."""
    found = np.asarray(value, dtype=np.float64)
    if len(found.shape) != len(shape) or any(due not in (-1, n) for n, due in zip(found.shape, shape, strict=True)):
        due = ", ".join("dim" if n == -1 else str(n) for n in shape)
        raise InputError(f"`{name}` returned an array of the shape {found.shape}; expected ({due}{',' * (len(shape) == 1)})")
    return found
