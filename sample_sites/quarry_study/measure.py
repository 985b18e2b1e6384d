#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the "measurements" of a synthetic quarry: throws the blocks of its truth.toml and measures them as a crew would.

Usage: measure.py SCREE SITE_FOLDER     (writes SITE_FOLDER/observed/stopping_points.csv and screen_crossings.csv)

If the truth has a law of its own, SITE_FOLDER/hidden_law.cpp, it is compiled first (c++).

What the crew does, with one random stream for all of it:
- it surveys where each block lies, with a standard deviation of 0.1 m in easting and in northing;
- it does not find two of the fifty;
- it films the blocks at the screens; the speed has a standard deviation of 5 % of its value and 0.1 m/s together, stated
  with each row; passages slower than 0.5 m/s go unseen; one film in twenty-five shows the passage, but no speed.
The release positions are not kept: like the model, the crew knows the release area only.
The tables are part of the repository. Another build of Scree may give other single blocks (impacts are chaotic), so that this
script then writes other tables of the same kind.
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from osgeo import ogr

ogr.UseExceptions()

HERE = Path(__file__).resolve().parent
POSITION_ERROR = 0.1            # [m]
NOT_FOUND = 2                   # [-] blocks
SPEED_ERROR = 0.05, 0.1         # [-] of the value, [m/s]
LEAST_SPEED = 0.5               # [m/s]
SPEED_LOST = 0.04               # [-] share of the films


def throw(scree, truth, folder):
    subprocess.run([scree, "run", truth, "--output", folder, "--quiet"], check=True)
    results = ogr.Open(f"{folder}/results.gpkg")
    stops = [(f["block_id"], f.GetGeometryRef().GetX(), f.GetGeometryRef().GetY(), f["stop_reason"])
             for f in results.GetLayer("stopping_points")]
    crossings = [(f["screen"], f["block_id"], f["speed_ms"]) for f in results.GetLayer("screen_crossings")]
    return stops, crossings


def survey(random, stops):
    lost = set(random.choice([block for block, *_ in stops], NOT_FOUND, replace=False))
    for block, east, north, reason in sorted(stops):
        if reason in ("failed", "time_limit"):
            sys.exit(f"block {block} ended with {reason}: a field test has none of these")
        east, north = (value + POSITION_ERROR * random.standard_normal() for value in (east, north))
        if block in lost:
            yield [block, "", "", "EPSG:2154", "", ""]
        else:
            yield [block, f"{east:.2f}", f"{north:.2f}", "EPSG:2154", POSITION_ERROR, int(reason == "left_terrain")]


def film(random, crossings):
    for screen, block, speed in sorted(crossings):
        error = SPEED_ERROR[0] * speed + SPEED_ERROR[1]
        measured, lost = speed + error * random.standard_normal(), random.uniform() < SPEED_LOST
        if speed < LEAST_SPEED:
            continue
        yield [screen, block] + (["", ""] if lost else [f"{max(measured, 0.0):.2f}", f"{error:.2f}"])


def write(path, header, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    scree, site = sys.argv[1], Path(sys.argv[2])
    random = np.random.RandomState(20220609)
    law = site / "hidden_law.cpp"
    if law.exists():
        (site / "out_law").mkdir(exist_ok=True)
        subprocess.run(["c++", "-shared", "-fPIC", "-O2", "-I", HERE.parents[1] / "include", "-o", site / "out_law" / "hidden_law.so", law], check=True)
    with tempfile.TemporaryDirectory() as folder:
        stops, crossings = throw(scree, str(site / "truth.toml"), f"{folder}/truth")
    observed = site / "observed"
    observed.mkdir(exist_ok=True)
    write(observed / "stopping_points.csv", ["block_id", "easting_m", "northing_m", "crs", "position_error_m", "censored"],
          survey(random, stops))
    write(observed / "screen_crossings.csv", ["screen", "block_id", "speed_ms", "speed_error_ms"], film(random, crossings))


if __name__ == "__main__":
    main()
