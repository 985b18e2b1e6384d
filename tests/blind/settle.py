#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes the deltas of sealed cases again, with a recalibration all over the ranges, where those on record were settled by Gauss-Newton steps alone (test-H and before).

Usage: settle.py SCREE FOLDER --seed S [--slopes SET] [--least D] [--cases N,N,...] [--threads N]

FOLDER holds the sealed/ of a run. Looks at truths only, never at what was found, and at all of them alike: every effect or fault with a delta of at least D on record (all, if D is 0: what is
left may also be more than on record, where the recalibrated model scatters less). Adds to FOLDER/settled.csv, which score.py goes by, and goes on where it was stopped.
"""
import argparse
import csv
import json
import tempfile
from pathlib import Path

import generate
import terrains


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", required=True)
    parser.add_argument("--slopes", choices=list(terrains.SETS), default="test")
    parser.add_argument("--least", type=float, default=0.0)
    parser.add_argument("--cases", type=lambda text: [int(n) for n in text.split(",")], help="these alone")
    parser.add_argument("--threads", type=int, default=0)
    args = parser.parse_args()
    args.tiers, args.count, args.blocks, args.search = list(generate.TIERS), generate.COUNT, 0, "whole"
    for name in terrains.SETS[args.slopes]:
        terrains.write(name, args.folder / "sites")
    table = args.folder / "settled.csv"
    done = {int(row["case"]) for row in csv.DictReader(table.open())} if table.exists() else set()
    with tempfile.TemporaryDirectory() as folder, table.open("a", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        if not done:
            rows.writerow(["case", "hidden", "on_record", "delta"])
        generate.compile_laws(Path(folder))
        for sealed in sorted((args.folder / "sealed").glob("*.json")):
            truth = json.loads(sealed.read_text())
            settling = [h for h in truth["hidden"] if h["delta"] is not None and h["delta"] >= args.least]
            if not settling or truth["case"] in done or (args.cases and truth["case"] not in args.cases):
                continue
            case = generate.Case(args, truth["case"])
            for hidden in settling:
                effects, fault = ([hidden["entry"]], None) if "entry" in hidden else ((), (hidden["name"], hidden["strength"]))
                delta = case.settled(Path(folder), effects, fault)
                rows.writerow([truth["case"], hidden["name"], f"{hidden['delta']:.2f}", f"{delta:.2f}"])
                print(f"case {truth['case']:04d}, {hidden['name']}: {hidden['delta']:.2f} on record, {delta:.2f}", flush=True)
            file.flush()


if __name__ == "__main__":
    main()
