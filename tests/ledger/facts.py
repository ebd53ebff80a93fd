"""What `sinew inspect` prints, as plain tables: for each file that it looked at a row with every number that it says."""

import re
from pathlib import Path

import pandas as pd

# A number by itself: no part of a name (`C1`, `k1`, `x_q05_m`) or of a version.
NUMBER = r"(?<![\w])(?<!\d\.)[+-]?\d+(?:\.\d+)?(?!\.?\w)"


def tables(said):
    """By file `inspect NAME`, with columns `ROW.0`, `ROW.1` … for the numbers of a row in their order; a row of what is odd has its first two words for a name."""
    found = {}
    for part in re.split(r"\n\n(?=\S)", said.strip()) if said else []:
        title, *lines = part.splitlines()
        rows = [("title", title if is_fit(title) else title.split(": ", 1)[1])]
        for line in lines:
            if odd := re.match(r"  odd: ((\S+) (\S+).*)", line):
                rows.append((f"odd {odd[2]} {odd[3].rstrip(':')}", odd[1]))
            else:
                rows.append(re.match(r" +(\S.*?)   *(.*)", line).groups())
        numbers = {f"{row}.{k}": float(number) for row, words in rows for k, number in enumerate(re.findall(NUMBER, re.sub("`[^`]*`", "", words)))}
        found[f"inspect {name(title)}"] = pd.DataFrame([numbers])
    return found


def is_fit(title):
    return title.startswith("fit of calibration and keypoints")


def name(title):
    """The name of the file, or `fit` and `results`."""
    if is_fit(title):
        return "fit"
    path, what = title.split(": ", 1)
    return "results" if what.startswith("results of") else Path(path).name
