#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs `scree compare` on the measurements of the real sites and checks what follows from the measurements alone.

Usage: compare_sites.py --scree PROGRAM [SITE ...] [--repeats N] [--threads N] [--keep DIR]      (default: all sites)

The measurements are converted by observations.py into a scratch folder. Exit code: 0 all is well, 1 not (one line per finding), 77 skipped because the
shared data, numpy or GDAL's Python module is absent.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import observations
from sites import path_changes, shared_folder, site_file

REPEATS = 6             # of the short run
RUNOUT_TOLERANCE = 0.1  # [m] between our quantiles and those printed beside the data
FLOOR_TOLERANCE = 0.2   # [m] of medians of a bootstrap with other random numbers

# What the folders of the data say of themselves, and what scree must find in them.
EXPECTED = {
    "authume_P1": {"n": 41, "findings": {"height_datum", "density"}, "measured": {"S1_cliff_top": 0.976, "S2_bench1": 0.951, "S3_below_cliff2": 0.415,
                                                                                "S4_quarry_floor": 0.122}},
    "tschamut": {"n": 40, "findings": {"no_error_stated", "censored"}, "measured": {"A40": 0.975, "A60": 0.95, "A80": 0.875, "A100": 0.475}},
    "chant_sura": {"n": 5, "findings": {"no_error_stated", "few_blocks"}, "measured": {}},
}


def compare(arguments, site, folder):
    """Runs scree compare; returns its exit code, what it said, and its numbers."""
    tables = Path(folder) / f"{site}_observations"
    observations.convert(site, tables)
    changes = path_changes(site)
    if site == "chant_sura":
        changes += ["--set", f"release.file={tables / 'release.gpkg'}", "--set", f"screens.file={tables / 'screens.gpkg'}", "--set",
                    f"blocks.list={tables / 'blocks.csv'}"]
    output = Path(folder) / site
    command = [arguments.scree, "compare", str(site_file(site)), "--observed", str(tables), *changes, "--set", f"observed.repeats={arguments.repeats}",
               "--threads", str(arguments.threads), "--output", str(output), "--overwrite"]
    done = subprocess.run(command, capture_output=True, text=True)
    numbers = json.loads((output / "compare.json").read_text()) if done.returncode == 0 else {}
    return done.returncode, done.stdout + done.stderr, numbers


def observable(numbers, name):
    return next(o for o in numbers["observables"] if o["name"] == name)


def judge(site, numbers):
    expected, findings = EXPECTED[site], []

    def check(condition, sentence):
        if not condition:
            findings.append(f"{site}: {sentence}")

    found = {f["check"] for f in numbers["findings"]}
    check(numbers["measured_blocks"] == expected["n"], f"{numbers['measured_blocks']} measured blocks, not {expected['n']}")
    check(numbers["design"] == "known blocks", f"the blocks are compared as a {numbers['design']}")
    check(found == expected["findings"], f"the audit finds {sorted(found)}, not {sorted(expected['findings'])}")
    check(not any(f["severity"] == "error" for f in numbers["findings"]), "the audit finds errors")
    shares = {s["name"]: s["measured"]["share"] for s in numbers["stopped_beyond_screens"]}
    for name, share in expected["measured"].items():
        check(abs(shares.get(name, -1) - share) < 5e-4, f"{shares.get(name)} of the measured blocks stopped beyond {name}, not {share}")
    for o in numbers["observables"]:
        check(o["pooled"]["gap"] is not None or "status" in o, f"{o['name']} has neither a gap nor a reason for none")
    if site == "authume_P1":
        own = json.loads((shared_folder() / "data" / "authume_P1" / "observed_metrics.json").read_text())
        runout = observable(numbers, "runout")
        for percent in ("5", "10", "25", "50", "75", "90", "95"):
            ours, theirs = runout["measured"]["quantiles_percent"][percent], own["runout_h_m"][percent]
            check(abs(ours - theirs) < RUNOUT_TOLERANCE, f"the {percent} % quantile of the measured runout is {ours:.2f} m, the data say {theirs} m")
        floor = own["W1_noise_floor_m"]
        for ours, theirs in ((runout["wasserstein"]["resampled_median"], floor["median"]), (runout["wasserstein"]["resampled_p95"], floor["p95"])):
            check(abs(ours - theirs) < FLOOR_TOLERANCE, f"the noise floor is {ours:.2f} m, the data say {theirs} m")
        check(runout["pooled"]["gap"] > runout["pooled"]["chance_95"][1], "the uncalibrated model is not told from the measurements")
    return findings


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sites", nargs="*", metavar="SITE")
    parser.add_argument("--scree", required=True, help="the program")
    parser.add_argument("--repeats", type=int, default=REPEATS, help="how often every measured block is simulated")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", help="folder for tables and results; without it they are thrown away")
    arguments = parser.parse_args()
    findings = []
    with tempfile.TemporaryDirectory() as scratch:
        for site in arguments.sites or sorted(EXPECTED):
            code, said, numbers = compare(arguments, site, arguments.keep or scratch)
            if code != 0:
                findings.append(f"{site}: scree ended with {code}: {said}")
                continue
            print(said)
            findings += judge(site, numbers)
    for finding in findings:
        print("FAILED", finding)
    sys.exit(1 if findings else 0)


main()
