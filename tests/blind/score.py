#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the sealed truths of blind cases, checks their hashes, and scores what `scree diagnose` found.

Usage: score.py FOLDER... [--table FILE] [--picture FILE]

Prints rates with their 95 % intervals (Wilson), of all cases and of those with 50 blocks, power by delta, of all effects together and of each, and a confusion
matrix; a case that the program refused counts as one in which nothing was detected. --table writes one line per case, --picture draws the power curve (needs python3-matplotlib). Several folders are scored as one run. FOLDER/settled.csv, if there is one,
has deltas that were taken again (of test-H).
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

import terrains
from seals import seals

AXIS_FROM_HEAD = terrains.RELEASE + 5.0 - 1.5  # the axis of the observations begins in the middle of the release, the profile at its head [m]
BINS = (0.0, 1.5, 2.5, 3.75, 5.25, 7.5, math.inf)
ONE_HIDDEN = (0, 1, 3, 6)  # tiers
VISIBLE = 2.5  # delta of each of two effects from which both may be asked for
REFUSED = {"verdict": "REFUSED", "answer": [], "effects": [], "simulated_blocks": 0}
# where a fault's strength stands in an answer: form and parameter
FAULTS = {"speed_bias": ("speed_error", "bias"), "speed_noise": ("speed_error", "noise"), "slow_missed": ("slow_missed", "least_speed"),
          "ids_shuffled": ("ids_shuffled", "share"), "height_datum": ("height_datum", "offset")}


def wilson(hits, n):
    """Ends of the 95 % interval of a share."""
    z, p = 1.96, hits / n
    middle, half = (p + z * z / (2 * n)) / (1 + z * z / n), z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def share(hits, n):
    if n == 0:
        return "no cases"
    low, high = (round(100 * x, 1) for x in wilson(hits, n))
    return f"{100 * hits / n:.3g} % of {n} ({low:g} to {high:g})"


def taken_again(folder):
    """Deltas that were taken again, by case and name of what is hidden."""
    table = folder / "settled.csv"
    return {(int(row["case"]), row["hidden"]): float(row["delta"]) for row in csv.DictReader(table.open())} if table.exists() else {}


def read(folder):
    cases, missing = [], []
    settled = taken_again(folder)
    for name, value in sorted(seals(folder).items()):
        file = folder / name
        found = folder / "found" / file.name
        if not file.exists():
            if found.exists():
                sys.exit(f"{file}: the truth of a case that was found is not there")
            missing.append(file.stem)
            continue
        text = file.read_bytes()
        if hashlib.sha256(text).hexdigest() != value:
            sys.exit(f"{file}: is not the truth that was sealed")
        if not found.exists() and not found.with_suffix(".error").exists():
            missing.append(file.stem)
            continue
        truth, result = json.loads(text), json.loads(found.read_text()) if found.exists() else REFUSED
        if "field_test_sha256" in result and result["field_test_sha256"] != truth["field_test_sha256"]:
            sys.exit(f"{found}: was found from another field test than the one that was sealed")
        answer = result["answer"]
        taken_back = bool(answer) and result["verdict"] == "UNKNOWN"  # by the blocks that were held out, or by what is left over all
        names = [a["effect"] for a in answer] if not taken_back else []
        ranked = sorted((f for f in result["effects"] if f.get("weight") is not None), key=lambda f: -f["weight"])
        families = [set(h["families"]) for h in truth["hidden"]]
        right = [any(name in f for f in families) for name in names]
        together = bool(answer) and answer[0]["together"]
        both = len(families) == 2 and len(names) == 2 and all(any(name in f for name in names) for f in families)
        answered = [a["effect"] for a in answer]  # taken back or not
        # of the hidden effect where several are named, else of the best
        judged = next((a for a in answer if any(a["effect"] in f for f in families)), answer[0] if answer else {})
        deltas = [settled.get((truth["case"], h["name"]), h["delta"]) for h in truth["hidden"] if h["delta"] is not None]
        cases.append({
            "run": folder.resolve().name, "case": truth["case"], "tier": truth["tier"], "slope": truth["slope"], "n": truth["n"], "ids": truth["ids"],
            "instruments": "+".join(truth["instruments"]), "hidden": " and ".join(h["name"] for h in truth["hidden"]) or "nothing",
            "delta": max(deltas, default=None), "least_delta": min(deltas, default=None), "verdict": result["verdict"],
            "names": (" and " if together else " or ").join(names), "taken_back": taken_back,
            "right": both if together else any(right), "one_right": any(right), "both": both,
            "top": bool(ranked) and any(ranked[0]["effect"] in f for f in families), "p": result.get("global_test", {}).get("p"),
            "covered": covered(truth, answer) if names else None, "closed": judged.get("removable_gap_closed"),
            "worse": judged["held_out_loss"] >= result["baseline"]["held_out_loss"] if "held_out_loss" in judged else None,
            "judged_right": any(judged.get("effect") in f for f in families) and (not together or len(families) == 2 and all(any(name in f for name in answered) for f in families)), "place_error": place_error(truth, answer),
            "simulated": result["simulated_blocks"]})
    return cases, missing


def place_error(truth, answer):
    """Between the middles of the hidden reach, along the profile, and of the one rightly named, along the axis of the observations [m]."""
    for hidden in truth["hidden"]:
        for a in answer:
            if hidden["at"] and "between_m" in a and a["effect"] in hidden["families"]:
                return abs(sum(a["between_m"]) / 2 + AXIS_FROM_HEAD - sum(hidden["at"]) / 2)
    return None


def covered(truth, answer):
    """Whether the interval of a strength holds the hidden one, where the name, form and parameter are the hidden ones; else None. Where a screen stood is not asked: it may be either."""
    for a in answer:
        for h in truth["hidden"]:
            entry = dict(line.split(" = ", 1) for line in h.get("entry", "").splitlines() if " = " in line)
            low, high = a["interval_95"]
            if entry.get("kind") == json.dumps(a["form"]) and a["parameter"] in entry:
                return low <= float(entry[a["parameter"]]) <= high
            if FAULTS.get(h["name"]) == (a["form"], a["parameter"]):
                return low <= h["strength"] <= high
    return None


def detected(case):
    return case["verdict"] not in ("NONE", "REFUSED")


def by_delta(cases):
    """For each bin of delta that has cases of one hidden effect: (low, high, those cases)."""
    chosen = [c for c in cases if c["tier"] in ONE_HIDDEN and c["delta"] is not None]
    bins = [(low, high, [c for c in chosen if low <= c["delta"] < high]) for low, high in zip(BINS, BINS[1:])]
    return [b for b in bins if b[2]]


def picture(cases, file):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "power"
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(7, 5))
    deltas = [0.05 * k for k in range(221)]
    axes.plot(deltas, [statistics.NormalDist().cdf(d - 1.645) for d in deltas], color="0.6", lw=1, label="detected by a linear test that knows the effect (level 5 %)")
    axes.plot([3, 4.5], [0.5, 0.9], "k+", ms=9, label="aim: 0.5 at 3, 0.9 at 4.5")
    inside = [b[2] for b in by_delta(cases)]
    for label, color, of, hit in (("detected", "#0b4f8a", lambda c: True, detected), ("with its right name (in the catalogue)", "#d65f00", lambda c: c["tier"] != 3, lambda c: c["right"])):
        points = [(statistics.fmean(c["delta"] for c in chosen), sum(map(hit, chosen)), len(chosen)) for chosen in ([c for c in b if of(c)] for b in inside) if chosen]
        shares = [hits / n for _, hits, n in points]
        ends = [wilson(hits, n) for _, hits, n in points]
        axes.errorbar([x for x, _, _ in points], shares, [[max(y - e[0], 0.0) for y, e in zip(shares, ends)], [max(e[1] - y, 0.0) for y, e in zip(shares, ends)]],
                      color=color, marker="o", ms=4, lw=1.5, capsize=2, label=label)
    null = [c for c in cases if c["tier"] == 5]
    if null:
        axes.axhline(sum(map(detected, null)) / len(null), color="#0b4f8a", lw=0.8, ls=":", label=f"false alarms, {len(null)} cases without effect")
    axes.set(xlabel="delta of the hidden effect, after recalibration", ylabel="share of cases", ylim=(0, 1), xlim=(0, 11))
    axes.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(0, 1), ncols=2)
    axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, nargs="+")
    parser.add_argument("--table", type=Path)
    parser.add_argument("--picture", type=Path)
    args = parser.parse_args()
    cases, missing = [], []
    for folder in args.folder:
        found, absent = read(folder)
        cases += found
        missing += [f"{folder.resolve().name}/{name}" if len(args.folder) > 1 else name for name in absent]
    if args.picture:
        picture(cases, args.picture)
    if args.table:
        with open(args.table, "w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, cases[0].keys(), lineterminator="\n")
            table.writeheader()
            table.writerows(cases)

    def rate(of, hit):
        chosen = [c for c in cases if of(c)]
        fifty = [c for c in chosen if c["n"] == 50]
        return f"{share(sum(map(hit, chosen)), len(chosen)):<28}{share(sum(map(hit, fifty)), len(fifty))}"

    def named(c):
        return bool(c["names"]) and c["verdict"] in ("NAMED", "DATA PROBLEM")

    def single(c):
        return bool(c["names"]) and " or " not in c["names"] and " and " not in c["names"]

    def wrong(c):
        return named(c) and not c["right"]

    def physical(c):
        return c["tier"] in (0, 1)

    def strong(c):
        return c["tier"] in (0, 1) and c["delta"] is not None and c["delta"] >= 4.5
    print(f"{len(cases)} cases, of which nothing hidden in {sum(c['tier'] == 5 for c in cases)}")
    for folder in args.folder:
        if settled := taken_again(folder):
            others = [c["delta"] for c in cases if c["run"] == folder.resolve().name and c["delta"] is not None and (c["case"], c["hidden"].split(" and ")[0]) not in settled]
            print(f"deltas that were taken again: of {len({case for case, _ in settled})} cases; on record for the others: up to {max(others, default=0.0):.2f}")
    if missing:
        print(f"not found, or their truths are not here, and in none of the rates: {len(missing)} ({', '.join(missing)})")
    if refused := [f"{c['run']}/{c['case']:04d}" if len(args.folder) > 1 else f"{c['case']:04d}" for c in cases if c["verdict"] == "REFUSED"]:
        print(f"refused, and counted as nothing detected: {len(refused)} ({', '.join(refused)})")
    print(f"\n{'':<45}{'all cases (95 % interval)':<28}50 blocks")
    print("false alarms where nothing is hidden        ", rate(lambda c: c["tier"] == 5, detected))
    print("wrong name where nothing is hidden          ", rate(lambda c: c["tier"] == 5, wrong))
    print("wrong name, all cases                       ", rate(lambda c: True, wrong))
    print("a single printed name is right              ", rate(single, lambda c: c["right"]))
    print("  where the catalogue has what was hidden   ", rate(lambda c: single(c) and c["tier"] != 3, lambda c: c["right"]))
    for words, of in (("of a fault of measurement", lambda c: c["verdict"] == "DATA PROBLEM"),
                      ("of the third dimension", lambda c: c["verdict"] == "NAMED" and c["names"] == "third_dimension"),
                      ("of an effect on blocks or ground", lambda c: c["verdict"] == "NAMED" and c["names"] != "third_dimension")):
        print(f"  {words:<42}", rate(lambda c: single(c) and of(c), lambda c: c["right"]))
    print("truth among the names, where any are printed", rate(lambda c: c["tier"] in (0, 1, 6) and c["names"], lambda c: c["right"]))
    print("truth in a printed group of 2 or 3          ", rate(lambda c: c["tier"] in (0, 1, 6) and c["verdict"] == "GROUP" and c["names"].count(" or ") <= 2, lambda c: c["right"]))
    for words, instruments in (("stops and speeds", "stops+speed"), ("heights, spins", "stops+speed+height+spin"),
                               ("heights, spins, impacts", "stops+speed+height+spin+impacts")):
        print(f"best of detected is right, {words:<18}", rate(lambda c: physical(c) and detected(c) and c["instruments"] == instruments, lambda c: c["top"]))
    print("  of all instruments, delta of 3.75 and more", rate(lambda c: physical(c) and detected(c) and c["delta"] >= 3.75, lambda c: c["top"]))
    print("outside the catalogue: wrong name           ", rate(lambda c: c["tier"] == 3, named))
    print("outside, detected: wrong name               ", rate(lambda c: c["tier"] == 3 and detected(c), named))
    print("outside, detected: UNKNOWN or GROUP         ", rate(lambda c: c["tier"] == 3 and detected(c), lambda c: c["verdict"] in ("UNKNOWN", "GROUP")))
    print("two effects, detected: a name is right      ", rate(lambda c: c["tier"] == 2 and detected(c), lambda c: c["one_right"]))
    print("two effects, detected: both are named       ", rate(lambda c: c["tier"] == 2 and detected(c), lambda c: c["both"]))
    print("  where each has a delta of 2.5 and more    ", rate(lambda c: c["tier"] == 2 and detected(c) and c["least_delta"] >= VISIBLE, lambda c: c["both"]))
    print("two names said, both are right              ", rate(lambda c: " and " in c["names"], lambda c: c["both"]))
    print("3D under a 2D model: a wrong name           ", rate(lambda c: c["tier"] == 4, wrong))
    print("3D under a 2D model, detected: right         ", rate(lambda c: c["tier"] == 4 and detected(c), lambda c: c["right"]))
    print("fault of measurement, detected: right       ", rate(lambda c: c["tier"] == 6 and detected(c), lambda c: c["right"]))
    for words, of in (("rightly named", single), ("rightly named or in the group", lambda c: True)):
        closed = [c["closed"] for c in cases if strong(c) and c["right"] and of(c) and c["closed"] is not None]
        if closed:
            print(f"removable gap closed on held-out blocks, median {100 * statistics.median(closed):.0f} % of {len(closed)} (delta of 4.5 and more, {words})")
    # a name with which held-out blocks are predicted worse is taken back: counted with those here
    print("held-out blocks worse with the right name   ", rate(lambda c: strong(c) and c["judged_right"] and c["worse"] is not None, lambda c: c["worse"]))
    print("names that were taken back: wrong ones      ", rate(lambda c: c["taken_back"], lambda c: not c["judged_right"]))
    print("interval of the strength (95 %) holds it    ", rate(lambda c: c["covered"] is not None, lambda c: c["covered"]))
    places = [c["place_error"] for c in cases if c["right"] and c["place_error"] is not None]
    if places:
        print(f"place of a local effect, median error        {statistics.median(places):.1f} m of {len(places)}")
    print("place within 3 m or 5 % of the slope         ", rate(lambda c: c["right"] and c["place_error"] is not None,
                                                                lambda c: c["place_error"] <= max(3.0, 0.05 * (terrains.SLOPES[c["slope"]]["floor"] - terrains.RELEASE))))

    print("\npower by delta (tiers 0, 1, 3, 6): detected, of all and of 50 blocks; named or in the printed group, of all and of 50 blocks")
    for low, high, inside in by_delta(cases):
        hit = rate(lambda c: c in inside, detected), rate(lambda c: c in inside and c["tier"] != 3, lambda c: c["right"])
        print(f"  {low:4.2f} to {high:4.2f}  {hit[0]:<56}{hit[1]}")

    print("\npower of each: detected / with its right name / cases, by delta\n  " + " " * 44 + "".join(f"{f'{low:g} to {high:g}':<14}" for low, high in zip(BINS, BINS[1:])))
    for hidden in sorted({c["hidden"] for c in cases if c["tier"] in ONE_HIDDEN}):
        cells = []
        for low, high in zip(BINS, BINS[1:]):
            inside = [c for c in cases if c["hidden"] == hidden and c["delta"] is not None and low <= c["delta"] < high]
            cells.append(f"{sum(map(detected, inside))} / {sum(c['right'] for c in inside)} / {len(inside)}" if inside else "-")
        print(f"  {hidden:<44}" + "".join(f"{cell:<14}" for cell in cells))

    print("\nwhat was hidden -> verdicts")
    matrix = collections.defaultdict(collections.Counter)
    for c in cases:
        matrix[c["hidden"] if c["tier"] != 2 else "two effects"][c["verdict"] + (": " + c["names"] if c["names"] else "")] += 1
    for hidden in sorted(matrix):
        print(f"  {hidden:<44}" + ", ".join(f"{k} {v}" for k, v in matrix[hidden].most_common()))


if __name__ == "__main__":
    main()
