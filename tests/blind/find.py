#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs `scree diagnose` on blind cases, knowing nothing but what is in FOLDER/cases.

Usage: find.py SCREE FOLDER [--parallel N] [--set KEY=VALUE ...]

Writes FOLDER/found/NNNN.json (diagnosis.json of the program, with the hash of the case that it saw), or NNNN.error with what the program said when it refused a case; what is
found is not done again. FOLDER/finder.json says which program with which settings:
another one needs another folder. Refuses a case that has no hash in FOLDER/sealed.sha256, or whose truth, where it is there, has another: it must be fixed before.
"""
import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from seals import hash_of, seals, write_whole

# smaller than the defaults, and nothing beyond the verdict: a case of 50 blocks takes one to fifteen minutes of one core; one of 100 as a pool took more than 48
BUDGET = ["calibration.starts=1", "calibration.generations=8", "calibration.surroundings=40", "calibration.repeats=4", "calibration.folds=3",
          "calibration.final_repeats=100", "diagnosis.reference_repeats=100", "diagnosis.repeats=12", "diagnosis.draws=499", "diagnosis.finalists=6",
          "observed.draws=200", "diagnosis.further=false", "diagnosis.power_search=0"]

REFUSED = 3  # exit code of the program where the measurements cannot be used


def diagnose(args, case):
    found = args.folder / "found" / f"{case.name}.json"
    refused = found.with_suffix(".error")
    if found.exists() or refused.exists():
        return
    sealed = f"sealed/{case.name}.json"
    hashes = seals(args.folder)
    truth = args.folder / sealed  # which a finder need not have
    if sealed not in hashes or (truth.exists() and hashlib.sha256(truth.read_bytes()).hexdigest() != hashes[sealed]):
        sys.exit(f"case {case.name} is not sealed, or its truth is not the one that was")
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        line = [args.scree, "diagnose", str(case / "site.toml"), "--observed", str(case / "observed"), "--output", f"{folder}/out", "--threads",
                "1", "--quiet"]
        for change in BUDGET + args.set:
            line += ["--set", change]
        done = subprocess.run(line, capture_output=True, text=True)
        if done.returncode:
            if done.returncode == REFUSED:
                write_whole(refused, done.stderr)
            print(f"case {case.name}: exit code {done.returncode}: {done.stderr.strip()[-300:]}", flush=True)
            return
        answer = json.loads((Path(folder) / "out" / "diagnosis.json").read_text())
        write_whole(found, json.dumps(answer | {"field_test_sha256": hash_of(case)}, indent=1) + "\n")
    print(f"case {case.name}: {time.monotonic() - begin:.0f} s", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--parallel", type=int, default=2, help="cases at once, one thread each (default 2)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    args = parser.parse_args()
    (args.folder / "found").mkdir(exist_ok=True)
    finder = {"program_sha256": hashlib.sha256(Path(args.scree).read_bytes()).hexdigest(), "settings": BUDGET + args.set}
    known = args.folder / "finder.json"
    if known.exists() and json.loads(known.read_text()) != finder:
        sys.exit(f"{known}: the cases found so far were found by another program or with other settings; use another folder")
    known.write_text(json.dumps(finder, indent=1) + "\n")
    cases = sorted((args.folder / "cases").iterdir())
    with ThreadPoolExecutor(args.parallel) as pool:
        list(pool.map(lambda case: diagnose(args, case), cases))


if __name__ == "__main__":
    main()
