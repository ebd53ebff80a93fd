"""`docs/evidence/ledger.md`: which test knows which number. `python tests/ledger/page.py` writes it."""

import tomllib
from fnmatch import fnmatchcase
from pathlib import Path

import frames  # noqa: F401
import inspected  # noqa: F401
import isb  # noqa: F401
import ledger
import motion  # noqa: F401
import overall  # noqa: F401
import particles  # noqa: F401
import report  # noqa: F401
import visibility  # noqa: F401
import weighted  # noqa: F401

ROOT = Path(__file__).resolve().parents[2]
PATH = ROOT / "docs/evidence/ledger.md"
ELSEWHERE = tomllib.loads((Path(__file__).parent / "elsewhere.toml").read_text())


def is_listed(kind, file, column):
    """Whether a column stands in a list of `elsewhere.toml`: `test`, of those that tests elsewhere know, or `unknown`."""
    return any(file == row["file"] and any(fnmatchcase(column, name) for name in row["columns"]) for row in ELSEWHERE[kind])


def is_unseen(file, column, disturbance):
    """Whether a disturbance is named as one that no check can see."""
    return any((row["file"], row["column"]) == (file, column) and disturbance in row["disturbances"] for row in ELSEWHERE["unseen"])


def shown(columns):
    return ", ".join(f"`{column}`" for column in columns)


def table(head, rows):
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in lines)


def written():
    """The page."""
    knows = [[f"`{check.file}`", shown(check.columns), check.source, ", ".join(check.runs), f"`{check.run.__name__}`"] for check in sorted(ledger.CHECKS, key=lambda check: (check.file, check.run.__name__))]
    other = [[f"`{row['file']}`", shown(row["columns"]), row["source"], row["test"]] for row in ELSEWHERE["test"]]
    unknown = [[f"`{row['file']}`", shown(row["columns"]), row["why"]] for row in ELSEWHERE["unknown"]]
    unseen = [[f"`{row['file']}`", shown([row["column"]]), ", ".join(row["disturbances"]), row["why"]] for row in ELSEWHERE["unseen"]]
    parts = {
        "CHECKS": table(["file", "columns", "known from", "runs", "check"], knows),
        "TESTS": table(["file", "columns", "known from", "test"], other),
        "UNKNOWN": table(["file", "columns", "why"], unknown),
        "UNSEEN": table(["file", "column", "disturbances", "why"], unseen),
    }
    text = (Path(__file__).parent / "page.txt").read_text()
    for name, part in parts.items():
        text = text.replace(f"[{name}]", part)
    return text


if __name__ == "__main__":
    PATH.write_text(written())
