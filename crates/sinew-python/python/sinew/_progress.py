"""Progress of a run: a line that is rewritten in a notebook or on a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

Progress = Callable[[str, str, int, int], object]
"""Called with what is counted, its unit, how many are done, and how many there are."""

_EVERY_S = 0.2
"""Seconds between two shown lines."""


def chosen(progress: bool | Progress | None) -> Progress:
    """The function that hears of progress; by default a line where somebody looks, else nothing."""
    if callable(progress):
        return progress
    if progress is None:
        progress = _in_notebook() or sys.stderr.isatty()
    if not progress:
        return lambda what, unit, done, total: None
    return _Line(_notebook_line() if _in_notebook() else _terminal_line)


class _Line:
    def __init__(self, show: Callable[[str], object]) -> None:
        self._show = show
        self._last = ("", 0.0)

    def __call__(self, what: str, unit: str, done: int, total: int) -> None:
        now = time.monotonic()
        is_new = what != self._last[0]
        if is_new or done >= total or now - self._last[1] >= _EVERY_S:
            self._last = (what, now)
            share = 100 * done // max(total, 1)
            self._show(f"{what}: {share} % ({done} of {total} {unit})")


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and type(shell).__name__ == "ZMQInteractiveShell"


def _notebook_line() -> Callable[[str], object]:
    display: Any = sys.modules["IPython"].display
    handle = display.display({"text/plain": ""}, raw=True, display_id=True)
    return lambda text: handle.update({"text/plain": text}, raw=True)


def _terminal_line(text: str) -> None:
    print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
