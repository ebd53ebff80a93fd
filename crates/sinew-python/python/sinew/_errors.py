"""Exceptions: the program's errors, with the same words and exit codes."""


class SinewError(Exception):
    """What ends a call early: what went wrong, what caused it, and what to do about it."""

    exit_code: int = 1
    """Code with which the program `sinew` ends in the same case."""
    help: str | None = None
    """What to do about it."""


class UsageError(SinewError, ValueError):
    """A wrong call or setting (exit code 2)."""

    exit_code = 2


class InputError(SinewError, ValueError):
    """Bad input data: an array of another shape, a file that cannot be understood (exit code 3)."""

    exit_code = 3


class FileError(SinewError, OSError):
    """A file or folder that cannot be read or written, or that exists already (exit code 5)."""

    exit_code = 5


class DiagnosticWarning(UserWarning):
    """A run is finished and written, but a diagnostic failed (exit code 4)."""


class SinewWarning(UserWarning):
    """What was odd about an input; the run goes its way."""
