"""Exceptions: the program's errors and exit codes, in Python's words."""

from __future__ import annotations

from collections.abc import Sequence

from ._words import in_python


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


def error(exit_code: int, what: str, causes: Sequence[str], advice: str | None) -> SinewError:
    """An error of the library: its lines are what, `caused by` and `help`."""
    lines = [what, *(f"caused by: {cause}" for cause in causes), *([] if advice is None else [f"help: {advice}"])]
    kinds: dict[int, type[SinewError]] = {2: UsageError, 3: InputError, 5: FileError}
    made = kinds.get(exit_code, SinewError)(in_python("\n".join(lines)))
    made.exit_code = exit_code
    made.help = None if advice is None else in_python(advice)
    return made
