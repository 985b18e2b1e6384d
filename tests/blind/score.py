#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the sealed truths of blind cases, checks their hashes, and scores what `scree diagnose` found.

Usage: score.py FOLDER [--table FILE]

Prints rates with their 95 % intervals (Wilson), power by delta, and a confusion matrix; --table writes one line per case.
"""
import argparse
import collections
import csv
import hashlib
import json
import math
import statistics
import sys
from pathlib import Path

BINS = (0.0, 1.5, 2.5, 3.75, 5.25, 7.5, math.inf)


def wilson(hits, n):
    if n == 0:
        return "no cases"
    z, p = 1.96, hits / n
    middle, half = (p + z * z / (2 * n)) / (1 + z * z / n), z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return f"{100 * p:.0f} % of {n} ({100 * max(middle - half, 0.0):.0f} to {100 * (middle + half):.0f})"


def read(folder):
    hashes = dict(reversed(line.split()) for line in (folder / "sealed.sha256").read_text().splitlines())
    cases = []
    for file in sorted((folder / "sealed").glob("*.json")):
        text = file.read_bytes()
        if hashlib.sha256(text).hexdigest() != hashes[f"sealed/{file.name}"]:
            sys.exit(f"{file}: is not the truth that was sealed")
        found = folder / "found" / file.name
        if not found.exists():
            continue
        truth, result = json.loads(text), json.loads(found.read_text())
        answer = result["answer"]
        names = [a["effect"] for a in answer] if result["verdict"] != "UNKNOWN" else []  # a name that was taken back is none
        ranked = sorted((f for f in result["effects"] if f.get("weight") is not None), key=lambda f: -f["weight"])
        families = [set(h["families"]) for h in truth["hidden"]]
        right = [any(name in f for f in families) for name in names]
        cases.append({
            "case": truth["case"], "tier": truth["tier"], "slope": truth["slope"], "n": truth["n"], "ids": truth["ids"],
            "instruments": "+".join(truth["instruments"]), "hidden": " and ".join(h["name"] for h in truth["hidden"]) or "nothing",
            "delta": max((h["delta"] for h in truth["hidden"] if h["delta"] is not None), default=None), "verdict": result["verdict"],
            "names": (" and " if answer and answer[0]["together"] else " or ").join(names), "right": any(right), "all_right": bool(right) and all(right),
            "both": len(families) == 2 and len(names) == 2 and all(any(name in f for name in names) for f in families),
            "top": bool(ranked) and any(ranked[0]["effect"] in f for f in families), "p": result.get("global_test", {}).get("p"),
            "covered": covered(truth, answer), "closed": answer[0].get("removable_gap_closed") if answer else None,
            "worse": answer[0]["held_out_loss"] >= result["baseline"]["held_out_loss"] if answer else None, "place_error": place_error(truth, answer),
            "simulated": result["simulated_blocks"]})
    return cases


def place_error(truth, answer):
    """Between the middles of the hidden and the named reach [m]; the profile's chainage begins 1.5 m east of the terrain's edge."""
    hidden = [h["at"] for h in truth["hidden"] if h["at"]]
    named = [a["between_m"] for a in answer if "between_m" in a]
    if not hidden or not named:
        return None
    return abs(sum(named[0]) / 2 - sum(hidden[0]) / 2)


def covered(truth, answer):
    """Whether the interval of a strength holds the hidden one, where the name, form and parameter are the hidden ones; else None."""
    for a in answer:
        for h in truth["hidden"]:
            entry = dict(line.split(" = ", 1) for line in h.get("entry", "").splitlines() if " = " in line)
            if entry.get("kind") == json.dumps(a["form"]) and a["parameter"] in entry:
                low, high = a["interval_95"]
                return low <= float(entry[a["parameter"]]) <= high
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--table", type=Path)
    args = parser.parse_args()
    cases = read(args.folder)
    if args.table:
        with open(args.table, "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, cases[0].keys(), lineterminator="\n")
            table.writeheader()
            table.writerows(cases)

    def rate(of, hit):
        chosen = [c for c in cases if of(c)]
        return wilson(sum(map(hit, chosen)), len(chosen))

    def named(c):
        return c["verdict"] == "NAMED"

    def wrong(c):  # of two names both must be right
        return bool(c["names"]) and c["verdict"] in ("NAMED", "DATA PROBLEM") and not (c["all_right"] if " and " in c["names"] else c["right"])

    def detected(c):
        return c["verdict"] != "NONE"

    def physical(c):
        return c["tier"] in (0, 1)
    print(f"{len(cases)} cases, of which nothing hidden in {sum(c['tier'] == 5 for c in cases)}\n")
    print("false alarms where nothing is hidden        ", rate(lambda c: c["tier"] == 5, detected))
    print("wrong name where nothing is hidden          ", rate(lambda c: c["tier"] == 5, wrong))
    print("wrong name, all cases                       ", rate(lambda c: True, wrong))
    print("a single printed name is right              ", rate(lambda c: bool(c["names"]) and " or " not in c["names"] and " and " not in c["names"], lambda c: c["right"]))
    print("truth among the names, where any are printed", rate(lambda c: c["tier"] in (0, 1, 6) and c["names"], lambda c: c["right"]))
    for words, instruments in (("stops and speeds", "stops+speed"), ("with heights and spins", "stops+speed+height+spin")):
        print(f"best of detected is right, {words:<25}", rate(lambda c: physical(c) and detected(c) and c["instruments"] == instruments, lambda c: c["top"]))
    print("outside the catalogue: wrong name           ", rate(lambda c: c["tier"] == 3, named))
    print("outside, detected: UNKNOWN or GROUP         ", rate(lambda c: c["tier"] == 3 and detected(c), lambda c: c["verdict"] in ("UNKNOWN", "GROUP")))
    print("two effects, detected: a name is right      ", rate(lambda c: c["tier"] == 2 and bool(c["names"]), lambda c: c["right"]))
    print("two effects, detected: both are named       ", rate(lambda c: c["tier"] == 2 and detected(c), lambda c: c["both"]))
    print("two names said, both are right              ", rate(lambda c: " and " in c["names"], lambda c: c["both"]))
    print("3D under a 2D model: wrong name             ", rate(lambda c: c["tier"] == 4, named))
    print("fault of measurement, detected: right       ", rate(lambda c: c["tier"] == 6 and detected(c), lambda c: c["right"]))
    strong = [c for c in cases if c["right"] and c["delta"] and c["delta"] >= 4.0]
    closed = [c["closed"] for c in strong if c["closed"] is not None and (c["closed"] > 0.0) != c["worse"]]  # else there was nothing to close
    if closed:
        print(f"held-out removable gap closed, median        {100 * statistics.median(closed):.0f} % of {len(closed)}")
    print("held-out blocks worse than without          ", wilson(sum(c["worse"] for c in strong), len(strong)))
    print("interval of the strength (95 %) holds it      ", rate(lambda c: c["covered"] is not None, lambda c: c["covered"]))
    places = [c["place_error"] for c in cases if c["right"] and c["place_error"] is not None]
    if places:
        print(f"place of a local effect, median error        {statistics.median(places):.1f} m of {len(places)}")

    print("\npower by delta (tiers 0, 1, 3, 6): detected; named or in the printed group")
    for low, high in zip(BINS, BINS[1:]):
        def inside(c):
            return c["tier"] in (0, 1, 3, 6) and c["delta"] is not None and low <= c["delta"] < high
        print(f"  {low:4.2f} to {high:4.2f}  {rate(inside, detected):<28}{rate(lambda c: inside(c) and c['tier'] != 3, lambda c: c['right'])}")

    print("\nwhat was hidden -> verdicts")
    matrix = collections.defaultdict(collections.Counter)
    for c in cases:
        matrix[c["hidden"] if c["tier"] != 2 else "two effects"][c["verdict"] + (": " + c["names"] if c["names"] else "")] += 1
    for hidden in sorted(matrix):
        print(f"  {hidden:<44}" + ", ".join(f"{k} {v}" for k, v in matrix[hidden].most_common()))


if __name__ == "__main__":
    main()
