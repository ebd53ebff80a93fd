"""Verbs of particle filters: weights from log weights, effective numbers, resampling, tempering."""

from ._sinew import effective_number, normalise, resample, tempering_exponent

__all__ = ["effective_number", "normalise", "resample", "tempering_exponent"]
