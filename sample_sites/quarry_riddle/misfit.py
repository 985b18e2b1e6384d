#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The misfit of this site: who passes its screens and how slowly, measured and for settings of the soils.

Usage: misfit.py SCREE [BLOCKS]     (500 blocks a setting; prints the table of README.md)

The settings are those of the loose waste; mu_r = 0 around the release is the third soil of ../quarry_a/three_zones.toml, which without
it is the loose waste as well. With so many settings nothing is fitted: `scree calibrate` looks for the best one.
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

from osgeo import ogr

ogr.UseExceptions()

HERE = Path(__file__).resolve().parent
SLOW = 3.0  # [m/s]
# e [-], mu [-], mu_r [m], mu_r around the release [m]
SETTINGS = [(0.0, 0.5, 0.04, None), (0.0, 0.5, 0.2, None), (0.2, 0.5, 0.2, None), (0.4, 0.5, 0.2, None), (0.0, 0.7, 0.2, None),
            (0.0, 0.9, 0.1, None), (0.0, 0.9, 0.2, None), (0.0, 0.9, 0.25, None), (0.0, 0.9, 0.2, 0.0), (0.0, 0.9, 0.25, 0.0)]


def row(name, blocks, speeds, passed):
    """Speeds at ES1-A that are known, and how many blocks pass each screen."""
    slow = sum(v < SLOW for v in speeds) / len(speeds) * passed["ES1-A"] / blocks
    print(f"| {name} | {100 * passed['ES1-A'] / blocks:.1f} % | {100 * slow:.1f} % | {100 * passed['ES2-A'] / blocks:.1f} % |", flush=True)


def measured():
    with open(HERE / "observed" / "screen_crossings.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    passed = {s: sum(r["screen"] == s for r in rows) for s in ("ES1-A", "ES2-A")}
    row("**measured**", 50, [float(r["speed_ms"]) for r in rows if r["screen"] == "ES1-A" and r["speed_ms"]], passed)


def simulated(scree, blocks, e, mu, rolling, at_release):
    sets = {"model.dimension": 2, "model.seed": 1, "release.count": blocks}
    for soil in ("loose waste", "release ground"):
        sets |= {f"soil.{soil}.restitution": e, f"soil.{soil}.friction": mu, f"soil.{soil}.rolling": rolling}
    if at_release is not None:
        sets["soil.release ground.rolling"] = at_release
    with tempfile.TemporaryDirectory() as folder:
        command = [scree, "run", HERE.parent / "quarry_a" / "three_zones.toml", "--quiet", "--output", f"{folder}/out"]
        for key, value in sets.items():
            command += ["--set", f"{key}={value}"]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        results = ogr.Open(f"{folder}/out/results.gpkg")
        crossings = [(f["screen"], f["speed_ms"]) for f in results.GetLayer("screen_crossings")]
    passed = {s: sum(c[0] == s for c in crossings) for s in ("ES1-A", "ES2-A")}
    name = f"{mu} and {rolling} m" + (f", e = {e}" if e else "") + ("" if at_release is None else ", mu_r = 0 around the release")
    row(name, blocks, [v for s, v in crossings if s == "ES1-A"], passed)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    blocks = int(sys.argv[2]) if len(sys.argv) == 3 else 500
    print("| mu and mu_r of the loose waste | pass ES1-A, the end of the upper slope | slower than 3 m/s there | pass ES2-A |\n|---|---|---|---|")
    measured()
    for setting in SETTINGS:
        simulated(sys.argv[1], blocks, *setting)


if __name__ == "__main__":
    main()
