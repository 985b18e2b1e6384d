#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs real sites with a few blocks and checks what must hold whatever the parameters are.

Usage: run_sites.py --scree PROGRAM [SITE ...] [--full] [--threads N] [--keep DIR]      (default: all sites)

--full throws FULL_COUNT blocks a site (tens of minutes). Exit code: 0 all is well, 1 not (one line per finding), 77 skipped because
the shared data, numpy or GDAL's Python module is absent.
"""
import argparse
import math
import sys
import tempfile
import tomllib
from pathlib import Path

from sites import PREFIX, Heights, features, gdal, np, run_site, run_table, shared_folder, site_file

COUNTS = {"authume_P1": 60, "vaujany": 25, "tyrol_kot": 30, "tyrol_wog": 30, "tschamut": 60}  # blocks of the short run
FULL_COUNT = 5000
MOST_PENETRATION = 0.02    # [m] that 99.9 % of the steps in contact stay below
LEAST_ABOVE = -0.02        # [m] of a stopped centre of mass above the ground: it lies in the block, so above the ground but for overlap
GRAVITY = 9.80665          # [m/s2]
ENERGY_TOLERANCE = 1.001   # [-] of the largest energy beside the fall, for the bins and the rises the solver may make


class Site:
    def __init__(self, name, arguments, folder):
        self.name, self.findings = name, []
        self.results = Path(folder) / name
        self.count = FULL_COUNT if arguments.full else COUNTS[name]
        self.code, self.said = run_site(arguments.scree, name, self.results, self.count, arguments.threads)

    def check(self, condition, sentence):
        if not condition:
            self.findings.append(f"{self.name}: {sentence}")

    def check_account(self):
        run = run_table(self.results)
        ends = {key[len("ended_"):]: int(value) for key, value in run.items() if key.startswith("ended_")}
        self.check(int(run["released"]) == self.count, f"{run['released']} of {self.count} blocks were released")
        self.check(sum(ends.values()) == self.count, f"the account does not close: {ends} for {self.count} blocks")
        self.check(ends["failed"] == 0, f"{ends['failed']} blocks failed")
        self.check(ends["time_limit"] == 0, f"{ends['time_limit']} blocks were still moving at the time limit")
        depth = float(run["penetration_p999_m"])
        self.check(depth < MOST_PENETRATION, f"99.9 % of the steps stay below {depth} m of penetration, not {MOST_PENETRATION} m")
        for layer in ("stopping_points", "release_points"):
            self.check(len(features(self.results, layer)) == self.count, f"{layer} does not hold every block")
        stops = features(self.results, "stopping_points")
        for reason, count in ends.items():
            listed = sum(s["stop_reason"] == reason for s in stops)
            self.check(listed == count, f"{listed} stopping points say {reason}, the account {count}")
        print(f"{self.name}: {self.count} blocks, {ends}, penetration 99.9 % {depth} m, largest {run['largest_penetration_m']} m, "
              f"{run['contact_problems_above_tolerance']} of {run['contact_problems']} problems above tolerance")

    def check_numbers(self):
        for layer in ("stopping_points", "release_points", "screen_crossings", "trajectories"):
            for row in features(self.results, layer):
                numbers = [v for v in row.values() if isinstance(v, float)]
                fine = row["xyz"] is not None and np.isfinite(row["xyz"]).all() and np.isfinite(numbers).all()
                self.check(fine, f"{layer}: block {row['block']} has a value that is no number")
        passed = self.raster("passages") > 0
        self.check(passed.any(), "no cell was passed")
        for path in sorted((self.results / "rasters").glob("*.tif")):
            values = self.raster(path.stem)
            if path.stem == "deposits":
                self.check(not (np.isfinite(values) & ~passed).any(), "a block stopped in a cell it did not pass")
            elif path.stem.split("_")[0] in ("reach", "energy", "height", "speed", "spin"):
                self.check((np.isfinite(values) == passed).all(), f"{path.stem} has not a value exactly where blocks passed")

    def raster(self, name):
        raster = gdal.Open(str(self.results / "rasters" / f"{name}.tif"))
        band = raster.GetRasterBand(1)
        values = band.ReadAsArray().astype(float)
        if band.GetNoDataValue() is not None and not math.isnan(band.GetNoDataValue()):
            values[values == band.GetNoDataValue()] = math.nan
        return values

    def check_stops(self):
        dtm = tomllib.loads(site_file(self.name).read_text())["terrain"]["dtm"]
        surface = Heights(shared_folder() / dtm[len(PREFIX):], self.results)
        lowest = np.nanmin(surface.z)
        starts = {r["block"]: r["xyz"][0] for r in features(self.results, "release_points")}
        for s in features(self.results, "stopping_points"):
            x, y, z = s["xyz"][0][:3]
            above = z - surface.at(x, y)
            if s["stop_reason"] == "at_rest":
                self.check(above > LEAST_ABOVE, f"block {s['block']} rests with its centre {-above:.2f} m below the ground")
                # in a steep gully the ground straight below is farther away than the walls that hold the block
                around = [(a, b) for a in np.linspace(-1, 1, 21) * s["l1_m"] for b in np.linspace(-1, 1, 21) * s["l1_m"]]
                nearest = min(math.hypot(a, b, z - h) for a, b in around if math.isfinite(h := surface.at(x + a, y + b)))
                self.check(nearest < s["l1_m"], f"block {s['block']} rests {nearest:.2f} m from the ground")
            elif s["stop_reason"] == "left_terrain":
                # a block ends when a vertex hangs beyond the rim; scree and GDAL may judge a cell that the DTM covers in part differently
                d = max(1.01 * surface.cell, s["l1_m"])
                near = [surface.at(x + a, y + b) for a in (-d, 0, d) for b in (-d, 0, d)]
                self.check(not np.isfinite(near).all(), f"block {s['block']} left the terrain where there is terrain: {x:.2f} {y:.2f}")
            most = s["mass_kg"] * GRAVITY * (starts[s["block"]][2] - lowest) / 1000.0
            self.check(s["energy_max_kj"] <= ENERGY_TOLERANCE * most, f"block {s['block']} has {s['energy_max_kj']:.1f} kJ, its fall gives {most:.1f} kJ")

    def judge(self):
        self.check(self.code == 0, f"scree ended with {self.code}: {self.said}")
        if self.code == 0:
            self.check_account()
            self.check_numbers()
            self.check_stops()
        return self.findings


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sites", nargs="*", metavar="SITE")
    parser.add_argument("--scree", required=True, help="the program")
    parser.add_argument("--full", action="store_true", help=f"{FULL_COUNT} blocks a site")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", help="folder for the results; without it they are thrown away")
    arguments = parser.parse_args()
    findings = []
    with tempfile.TemporaryDirectory() as scratch:
        for name in arguments.sites or sorted(COUNTS):
            findings += Site(name, arguments, arguments.keep or scratch).judge()
    for finding in findings:
        print("FAILED", finding)
    sys.exit(1 if findings else 0)


main()
