#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks on blind cases that `scree diagnose` does not live on what it should not know. Run after find.py; opens the sealed truths.

Usage: checks.py SCREE FOLDER [--cases N] [--parallel N]

For up to N cases each:
  mixed    blocks' numbers are mixed up in the measurements: no effect of mass may be named (restitution_mass, rolling_size), nor be in a group
  shuffled rows in another order, other times of the files, another folder, other names of site and blocks: the same diagnosis
  without  the effect that was rightly named is said to be absent: UNKNOWN and GROUP are right; another name is wrong, and NONE says too little
That data of another seed with nothing hidden give NONE is what tier 5 counts (score.py).
"""
import argparse
import collections
import csv
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from seals import settings_of_finder

OF_MASS = {"restitution_mass", "rolling_size"}
TIME = 1.5e9  # of all files of a copy; those of a case have another (EPOCH in generate.py)


def said(diagnosis):
    """All of it but the hashes of the files and the name of the site."""
    return {key: value for key, value in diagnosis.items() if key not in ("inputs", "site", "field_test_sha256")}


def renamed(text, old, new):
    """Block B007 becomes X007, or back: in the same order, which is that of the random numbers."""
    return re.sub(rf"\b{old}(\d{{3}})\b", rf"{new}\1", text)


def diagnose(args, case, change=None, sets=()):
    """The diagnosis of a copy of the case with `change` done to its tables, (header, rows) each."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "another"
        shutil.copytree(case, folder)
        site = folder / "site.toml"
        text = site.read_text().replace("../../sites", str(args.folder.resolve() / "sites"))
        site.write_text(re.sub(r'name = "Case \d+"', 'name = "Elsewhere"', text))
        for table in [folder / "blocks.csv", *(folder / "observed").iterdir()]:
            table.write_text(renamed(table.read_text(), "B", "X"))
        tables = {}
        for table in sorted((folder / "observed").iterdir()):
            with open(table, newline="", encoding="utf-8") as file:
                header, *rows = csv.reader(file)
            tables[table] = header, rows
        if change:
            change(list(tables.values()))
        for table, (header, rows) in tables.items():
            with open(table, "w", newline="", encoding="utf-8") as file:
                csv.writer(file, lineterminator="\n").writerows([header, *rows])
        for file in folder.rglob("*"):
            os.utime(file, (TIME, TIME))
        line = [args.scree, "diagnose", str(site), "--observed", str(folder / "observed"), "--output", f"{name}/out", "--threads", "1", "--quiet"]
        for key in [*args.settings, *sets]:
            line += ["--set", key]
        done = subprocess.run(line, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{case}: {done.stderr}")
        return said(json.loads(renamed((Path(name) / "out" / "diagnosis.json").read_text(), "X", "B")))


def mix(tables):
    """The same mix-up in all tables: a block is taken for another."""
    blocks = sorted({row[header.index("block_id")] for header, rows in tables for row in rows})
    taken_for = dict(zip(blocks, random.Random(1).sample(blocks, len(blocks))))
    for header, rows in tables:
        at = header.index("block_id")
        for row in rows:
            row[at] = taken_for[row[at]]


def shuffle(tables):
    chance = random.Random(1)
    for _, rows in tables:
        chance.shuffle(rows)


def names(found):
    return {a["effect"] for a in found["answer"]} if found["verdict"] in ("NAMED", "DATA PROBLEM") else set()


def printed(found):
    return {a["effect"] for a in found["answer"]} if found["verdict"] != "UNKNOWN" else set()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cases", type=int, default=10, help="of each check (default 10)")
    parser.add_argument("--parallel", type=int, default=2)
    args = parser.parse_args()
    args.settings = settings_of_finder(args.folder, args.scree)
    mixed, shuffled, without = [], [], []
    for file in sorted((args.folder / "found").glob("*.json")):
        found, truth = json.loads(file.read_text()), json.loads((args.folder / "sealed" / file.name).read_text())
        case = args.folder / "cases" / file.stem
        shuffled.append((case, found))
        if truth["ids"] and {n for h in truth["hidden"] for n in h["families"]} & OF_MASS:
            mixed.append(case)
        right = [n for n in names(found) if any(n in h["families"] for h in truth["hidden"])]
        if truth["tier"] in (0, 1) and right:
            without.append((case, sorted({n for h in truth["hidden"] for n in h["families"]})))
    with ThreadPoolExecutor(args.parallel) as pool:
        answers = list(pool.map(lambda case: diagnose(args, case, mix), mixed[:args.cases]))
        of_mass = sum(bool(printed(f) & OF_MASS) for f in answers)
        print(f"mixed: an effect of mass is named in {of_mass} of {len(answers)}", flush=True)
        same = list(pool.map(lambda job: diagnose(args, job[0], shuffle) == said(job[1]), shuffled[:args.cases]))
        print(f"shuffled: the same diagnosis in {sum(same)} of {len(same)}", flush=True)
        answers = list(pool.map(lambda job: diagnose(args, job[0], None, [f"diagnosis.without={json.dumps(job[1])}"]), without[:args.cases]))
        verdicts = ", ".join(f"{verdict} {count}" for verdict, count in collections.Counter(f["verdict"] for f in answers).most_common())
        another = sum(bool(names(f)) for f in answers)
        nothing = sum(f["verdict"] == "NONE" for f in answers)
        print(f"without: another effect is named in {another} of {len(answers)}" + (f" ({verdicts})" if answers else ""), flush=True)
    sys.exit(1 if of_mass or another or nothing or not same or not all(same) else 0)


if __name__ == "__main__":
    main()
