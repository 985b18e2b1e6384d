#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tschamut: calibrates on one half of the measured runs and scores on the other, both ways round.

Usage: halves.py SCREE [--output DIR] [--threads N]

Runs of each of the three blocks are dealt alternately, in the order of their numbers. Free are e, mu and mu_r of the whole slope and the height of
release. Each half is compared with the model as it was given and as the other half calibrated it, with 40 repeats of every run. Steps whose results
are in DIR are not run again. The data are found by SCREE_SHARED_DATA; without them: exit code 77. What the terrain, which was not measured, allows to
conclude is in ../README.md.
"""
import argparse
import csv
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[2] / "sample_sites" / "quarry_study")]

import observations  # noqa: E402
from sites import path_changes, shared_folder, site_file  # noqa: E402
from study import Study, calibrated_changes, frees, gap_of, read, sets  # noqa: E402

FREE = ["soil.*.restitution=0:0.5", "soil.*.friction=0.2:0.9", "soil.*.rolling=0.002:0.15:log", "release.height=0.1:1"]
SCREENS = ["A40", "A60", "A80", "A100"]
HALVES = ["first", "second"]


def deal(folder):
    """Writes the tables of both halves; returns their folders."""
    whole = folder / "observed"
    observations.convert("tschamut", whole)
    runs = observations.rows_of(shared_folder() / "data" / "tschamut2014_visible" / "runs.csv")
    half_of, seen = {}, {}
    for run in sorted(runs, key=lambda r: r["run_id"]):
        seen[run["block_no"]] = seen.get(run["block_no"], -1) + 1
        half_of[run["run_id"]] = HALVES[seen[run["block_no"]] % 2]
    for half in HALVES:
        (folder / half).mkdir(exist_ok=True)
        for name in ("stopping_points", "release_points"):
            with open(whole / f"{name}.csv", newline="", encoding="utf-8") as table:
                rows = [r for r in csv.DictReader(table) if half_of[r["block_id"]] == half]
            observations.write(folder / half, name, rows)
    return {half: folder / half for half in HALVES}


def row_of(folder):
    compared = read(folder, "compare.json")
    runout = next(o for o in compared["observables"] if o["name"] == "runout")
    w = runout["wasserstein"]
    beyond = {s["name"]: (s["simulated"]["share"], s["measured"]["share"]) for s in compared["stopped_beyond_screens"]}
    return (f"W1 of runout {w['distance']:.1f} m ({w['distance_95'][0]:.1f} to {w['distance_95'][1]:.1f}; noise floor {w['resampled_median']:.1f}, 95 % "
            f"{w['resampled_p95']:.1f}); mean {runout['simulated']['mean']:.1f}, measured {runout['measured']['mean']:.1f} m; overall gap {gap_of(folder)}; stopped beyond "
            + ", ".join(f"{name} {beyond[name][0]:.3f} (measured {beyond[name][1]:.3f})" for name in SCREENS))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("--output", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--threads", type=int, default=0)
    args = parser.parse_args()
    changes = path_changes("tschamut")
    args.output.mkdir(parents=True, exist_ok=True)
    study = Study(args.scree, args.output, {half: (site_file("tschamut"), folder, changes) for half, folder in deal(args.output).items()}, args.threads)
    fits = {half: study.run(f"calibrated_on_{half}", "calibrate", half, *frees(*FREE)) for half in HALVES}
    lines = []
    for half, other in (HALVES, HALVES[::-1]):
        lines.append(f"calibrated on the {half} half: " + ", ".join(
            f"{p['key']} {p['value']:.3g} ({p['interval_95'][0]:.3g} to {p['interval_95'][1]:.3g})" for p in read(fits[half], "calibrate.json")["parameters"]))
        found = calibrated_changes(fits[half])
        for name, on, values in (("as given", other, []), (f"calibrated on the {half} half", other, found), (f"calibrated on the {half} half", half, found)):
            folder = study.run(f"{name.replace(' ', '_')}_on_{on}", "compare", on, *sets(*values), *sets("observed.repeats=40"))
            lines.append(f"{name}, against the {on} half: {row_of(folder)}")
    print("\n".join(lines))
    (args.output / "summary.txt").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
