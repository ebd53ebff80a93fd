"""The program's words in Python's: `--lag cam_02=3` is `lag={"cam_02": 3}` here."""

from __future__ import annotations

import re
from functools import cache

from . import _sinew

_PHRASES = {
    "`sinew track --help` lists the settings; `--print-config` shows the values in force": "`sinew.settings()` lists them",
    "the same command": "the same call",
    "repeat the command": "repeat the call",
}
_OTHERS = {
    "config": "path",
    "o": "path",
    "page": "flag",
    "resume": "flag",
    "skeleton": "path",
    "write_calibration": "path",
}
"""Keyword arguments that are no settings."""


@cache
def _kinds() -> dict[str, str]:
    return _OTHERS | {key: kind for key, _, kind, _ in _sinew.settings_table()}


def in_python(text: str) -> str:
    """A text that names flags, with keyword arguments in their place. Commands of the program stay."""
    for words, ours in _PHRASES.items():
        text = text.replace(words, ours)
    text = re.sub(r"`(?:sinew (?:track|convert) )?(--?[a-z][^`]*)`", lambda of: f"`{_arguments(of[1])}`", text)
    return re.sub(r"(?m)^( *)sinew track (-.*)$", lambda of: f"{of[1]}sinew.track({_arguments(of[2])})", text)


def _arguments(flags: str) -> str:
    words = flags.split()
    keys = [word.lstrip("-").replace("-", "_") if word.startswith("-") else None for word in words]
    if any(key is not None and key not in _kinds() for key in keys):
        return flags
    arguments: list[str] = []
    for word, key in zip(words, keys, strict=True):
        if key is None:
            name = arguments.pop() if arguments else ""
            arguments.append(f"{name}={_value(_kinds().get(name, ''), word)}")
        else:
            arguments.append("out" if key == "o" else key)
    return ", ".join(f"{name}=True" if _kinds().get(name) == "flag" else name for name in arguments)


def _value(kind: str, word: str) -> str:
    if kind == "frames":
        return f"({word.replace('..', ', ')})"
    if kind == "lags":
        pairs = [item.split("=") for item in word.split(",")]
        return "{" + ", ".join(f'"{camera}": {lag}' for camera, lag in pairs) + "}" if "=" in word else word
    if kind == "names":
        return "[" + ", ".join(f'"{name}"' for name in word.split(",")) + "]"
    if kind == "direction" and "," in word:
        return f"({word.replace(',', ', ')})"
    # What stands for a value is written in capitals.
    return word if kind in ("count", "number") or word.isupper() else f'"{word}"'
