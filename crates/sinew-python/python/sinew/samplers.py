"""Samplers on a log density written in NumPy (the slow path), and diagnostics of chains."""

from ._records import ChainDraws
from ._sinew import bulk_ess, hmc, nuts, r_hat, tail_ess

__all__ = ["ChainDraws", "bulk_ess", "hmc", "nuts", "r_hat", "tail_ess"]
