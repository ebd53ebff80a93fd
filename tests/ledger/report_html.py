"""`report.html` as plain tables: the numbers of its words and tables, and the curves of its player."""

import base64
import json
import re
import zlib

import numpy as np
import pandas as pd

# A number of the page: with the minus of print, or an empty place.
NUMBER = r"[+−]?\d+(?:\.\d+)?"
# What a frame shows of itself, an axis of a point, the ellipsoid of a point, an angle.
OF_FRAME = ("number", "quality", "restarted", "r_hat")
OF_AXIS = OF_ANGLE = ("mean", "below", "above")
FACTOR = ("xx", "yx", "yy", "zx", "zy", "zz")


def number(text):
    return float(text.replace("−", "-"))


def rows(html, caption):
    """Cells of the rows of a table, its tags taken off."""
    table = re.search(rf"<table[^>]*><caption>{caption}</caption>.*?</table>", html, re.DOTALL)
    found = re.findall(r"<tr>(.*?)</tr>", table[0], re.DOTALL) if table else []
    return [[re.sub("<[^>]+>", "", cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL)] for row in found]


def numbers_of_page(html):
    """The numbers of words and tables, by what they are of."""
    subtitle = re.search(r'class="subtitle">(\d+) frames, ([\d.]+) s at ([\d.]+) per second · (\d+) cameras', html).groups()
    found = dict(zip(("run.frames", "run.seconds", "run.fps", "run.cameras"), map(float, subtitle)))
    known = re.search(r"known to <b>±(\d+) mm</b> \(±(\d+) mm against other places of the run\), an angle to <b>±([\d.]+)°", html).groups()
    found |= dict(zip(("known.coordinate_mm", "known.within_mm", "known.angle_deg"), map(float, known)))
    heads = ("frames", "residual_px", "offset_px", "noise_px", "later_ms", "exchanged_percent", "elsewhere_percent")
    for camera, *cells in rows(html, "What each camera shows")[1:]:
        for head, cell in zip(heads, cells):
            values = [number(value) for value in re.findall(NUMBER, cell)]
            found |= {f"camera.{camera}.{head}.{k}": value for k, value in enumerate(values)}
    if words := re.search(r"Of the variance of all points: (.*?)\.</p>", html):
        found |= {f"source.{name}": float(share) for name, share in re.findall(r"([^,]+?) (\d+) %(?:, |$)", words[1])}
    for joint, label in re.findall(r'<tr><th scope="row">(\w+)</th><td>\d+ mm</td><td class="bar" role="img" aria-label="([^"]*)"', html):
        found |= {f"joint.{joint}.{name}": float(share) for name, share in re.findall(r"([^,]+?) (\d+) %(?:, |$)", label)}
    found |= {f"joint.{name}.sd_mm": float(sd) for name, sd in re.findall(r'<tr><th scope="row">(\w+)</th><td>(\d+) mm</td>', html)}
    found |= {f"diagnostic.{name}": number(value) for name, value in rows(html, "Diagnostics") if re.fullmatch(NUMBER, value)}
    return {name.replace(" ", "_"): value for name, value in found.items()}


def columns_of(data, frames, steps):
    """Columns of whole steps, coded as differences; one for each of `steps`."""
    at, columns = 0, []
    for step in steps:
        before, column = 0, []
        for _ in range(frames):
            value, place, byte = 0, 0, 128
            while byte > 127:
                byte = data[at]
                value |= (byte & 127) << place
                at, place = at + 1, place + 7
            folded = value - 1
            before += 0 if value == 0 else folded // 2 if folded % 2 == 0 else -(folded + 1) // 2
            column.append(np.nan if value == 0 else before * step)
        columns.append(column)
    assert at == len(data), "all is read"
    return columns


def curves(html):
    """What the player draws: a table with a row a frame, and the cameras' centres."""
    packed = zlib.decompress(base64.b64decode(re.search(r'id="payload">([^<]*)', html)[1]))
    size = 4 + int.from_bytes(packed[:4], "little")
    head = json.loads(packed[4:size])
    steps = head["steps"]
    names = [(f"frame.{what}", steps["rhat"] if what == "r_hat" else 1.0) for what in OF_FRAME]
    names += [(f"residual.{camera['name']}", steps["residual"]) for camera in head["cameras"]]
    for point in head["points"]:
        names += [(f"point.{point}.{axis}.{what}", steps["position"]) for axis in "xyz" for what in OF_AXIS]
        names += [(f"ellipsoid.{point}.{what}", steps["position"]) for what in FACTOR]
    for angle in head["angles"]:
        names += [(f"angle.{angle['name']}.{what}", steps["angle"]) for what in OF_ANGLE] + [(f"angle.{angle['name']}.seen", 1.0)]
    columns = columns_of(packed[size:], head["frames"], [step for _, step in names])
    table = pd.DataFrame({name: column for (name, _), column in zip(names, columns)})
    return table.drop(columns=table.columns[table.isna().all()])
