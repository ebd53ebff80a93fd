"""The ledger of numbers: which check knows which column, and disturbances that each check must see.

A check takes `Results` and asserts. `known` enters it for columns of a file; names may have `*`. Checks share no code with `sinew`.
"""

from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

import numpy as np
import pandas as pd

CHECKS = []


@dataclass(frozen=True)
class Check:
    """A check with the columns that it knows, in which runs, and from what."""

    file: str
    columns: tuple[str, ...]
    runs: tuple[str, ...]
    source: str
    run: object

    def knows(self, run, file, column):
        return run in self.runs and file == self.file and any(fnmatchcase(column, known) for known in self.columns)


def known(file, *columns, source, runs=("filtered", "smoothed")):
    """Enters a function as a check of these columns of a file."""

    def enter(function):
        CHECKS.append(Check(file, columns, runs, source, function))
        return function

    return enter


def rows_of(table):
    """Rows of each frame of a table, 1 where a row is a frame."""
    if "frame" not in table or table.frame.nunique() == 0:
        return 1
    return len(table) // table.frame.nunique()


def disturbances(table, column):
    """What a mistake makes of a column, by its name; where it leaves the column as it is, it is left out."""
    before = table[column]
    if before.empty:
        return {}
    rows = rows_of(table)
    if not pd.api.types.is_numeric_dtype(before):
        made = {"two rows exchanged": exchanged(before, rows), "one name for all": pd.Series([before.iloc[0]] * len(before))}
    else:
        spread = table.get(column.replace("mean", "sd")) if "mean" in column else None
        step = spread if spread is not None and spread is not before else np.nanstd(before) or 1.0
        made = {
            "times 1.1": before * 1.1,
            "plus one spread": before + step,
            "sign": -before,
            "one frame late": before.shift(rows).fillna(before),
            "two rows exchanged": exchanged(before, rows),
        }
    return {name: after for name, after in made.items() if not same(before, after)}


# Columns of a file above which each is disturbed in one way, all ways in turn.
MANY = 20


def ways(table, column):
    """The disturbances to try on a column: all, or one of a table with many columns."""
    all_ways = disturbances(table, column)
    if len(table.columns) <= MANY or not all_ways:
        return all_ways
    names = sorted(all_ways)
    chosen = names[list(table.columns).index(column) % len(names)]
    return {chosen: all_ways[chosen]}


def exchanged(column, rows):
    """In each frame its first row and another one, the most unlike it, exchanged; of tables with one row a frame, two frames."""
    values = column.to_numpy().copy()
    table = values.reshape(-1, rows) if rows > 1 else values.reshape(1, -1)
    first = table[:, :1]
    unlike = np.nan_to_num(abs(table - first)).sum(0) if pd.api.types.is_numeric_dtype(column) else (table != first).sum(0)
    other = int(np.argmax(unlike))
    table[:, [0, other]] = table[:, [other, 0]]
    return pd.Series(table.reshape(-1), index=column.index)


def same(before, after):
    if not pd.api.types.is_numeric_dtype(before):
        return bool((before.to_numpy() == after.to_numpy()).all())
    # A channel that is zero but for rounding stays so.
    return np.allclose(before.to_numpy(float), after.to_numpy(float), rtol=0, atol=1e-9, equal_nan=True)


def disturbed(results, file, column, after):
    """The results with another column."""
    table = results.tables[file].copy()
    table[column] = after
    return replace(results, tables={**results.tables, file: table})


def fails(check, results):
    """Whether a check refuses results; an error that is no refusal goes on."""
    try:
        check.run(results)
    except AssertionError:
        return True
    return False
