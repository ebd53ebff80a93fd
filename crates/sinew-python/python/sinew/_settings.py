"""Keyword arguments of `track`, for type checkers: one line a setting, in the order of `sinew.settings()`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypedDict

Frames = range | tuple[int, int]
"""Numbers of frames: the first, and the end, which is not included."""


class Settings(TypedDict, total=False):
    """Settings of a run that are no arguments of their own; `sinew.settings()` says what they mean."""

    silhouettes: str | Path
    images: str | Path
    frames: Frames
    fps: float
    cameras: Sequence[str]
    person: int
    people: Literal["all", "1"]
    subject: str
    trim: bool
    lag: Mapping[str, float | str]
    confidence_scale: float
    image_scale: float
    mask_scale: float
    up_axis: Literal["+x", "-x", "+y", "-y", "+z", "-z"]
    up: Literal["auto"] | tuple[float, float, float]
    method: Literal["hmc", "bootstrap", "guided", "annealed", "partitioned", "hppf", "coarse-to-fine", "gpapf", "h-apf"]
    body: str | Path
    setup: str | Path
    init: str | Path
    setup_frames: Frames
    any_size: bool
    smooth: bool
    lag_frames: int
    prior: Literal["gaussian", "mixture"]
    motion_scale: float
    motion_model: str | Path
    latent: str | Path
    noise: Literal["floor", "student-t"]
    outlier: float
    degrees: float
    least_confidence: float
    score: Literal["deutscher-reid", "bidirectional", "coarse-to-fine", "parts"]
    kappa: float
    raster: int
    chains: int
    updates: int
    patience: int
    burn_in: int
    jitter: float
    joint_limits: Literal["auto", "off", "on"]
    particles: int
    layers: int
    survival: float
    adaptive: bool
    crossover: float
    level_primitives: Literal["nested", "own-parts"]
    fine: int
    latent_layers: int
    inject: float
    refine: bool
    visits: int
    draws: int
    simd: Literal["avx512", "avx2", "baseline"]
    max_r_hat: float
    max_r_hat_share: float
    max_divergent_share: float
    min_ess: float
    seed: int
    threads: int
    angles: Literal["opensim", "isb"]
    static: str | Path
    checkpoint_every: float
    force: bool
