#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the truth itself leaves of the measurements of blind cases: where a wrong effect leaves no more, no search could have told. Run after find.py; opens the sealed truths.

Usage: truths.py SCREE FOLDER [--parallel N]

Of every case in which effects were hidden (not a third dimension, not a fault of measurement) the model is the true one, effects and soils, calibrated and tested with the
finder's settings; no effect is searched. One line per case in FOLDER/truths.csv, where what is done is not done again: delta on record; Q and p of the model without effect, as
found; the effect that leaves least, and its Q; Q and p of the truth. Where an effect moves means, Q of the model without it less that of the truth is about delta squared, give or take
2 delta; delta sees little of what only widens them.
"""
import argparse
import csv
import json
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from generate import compile_laws
from seals import settings_of_finder

COLUMNS = ["case", "tier", "hidden", "delta", "verdict", "q_without", "p_without", "best", "best_right", "q_best", "q_truth", "p_truth"]


def true_site(text, truth):
    """The site of the case with the true soils and what was hidden."""
    for name, soil in truth["soils"].items():
        lines = "".join(f"{key} = {value!r}\n" for key, value in soil.items())
        text, found = re.subn(rf'(name = "{name}"\n)(?:\w+ = \S+\n)+', rf"\g<1>{lines}", text)
        assert found == 1, name
    return text + "\n" + "".join(hidden["entry"] for hidden in truth["hidden"])


def look(args, laws, file):
    found, truth = json.loads(file.read_text()), json.loads((args.folder / "sealed" / file.name).read_text())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "case"
        shutil.copytree(args.folder / "cases" / file.stem, folder)
        shutil.copy(laws, folder)
        site = folder / "site.toml"
        site.write_text(true_site(site.read_text().replace("../../sites", str(args.folder.resolve() / "sites")), truth))
        line = [args.scree, "diagnose", str(site), "--observed", str(folder / "observed"), "--output", f"{name}/out", "--threads", "1", "--quiet"]
        none = {e["effect"] for e in found["effects"]}.union(*(json.loads(change.split("=", 1)[1]) for change in args.settings if change.startswith("diagnosis.without=")))
        for change in [*args.settings, f"diagnosis.without={json.dumps(sorted(none))}"]:
            line += ["--set", change]
        done = subprocess.run(line, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{file.stem}: {done.stderr}")
        own = json.loads((Path(name) / "out" / "diagnosis.json").read_text())["global_test"]
    best = min((e for e in found["effects"] if e.get("left_over") is not None), key=lambda e: e["left_over"], default=None)
    families = {n for h in truth["hidden"] for n in h["families"]}
    return {"case": file.stem, "tier": truth["tier"], "hidden": " and ".join(h["name"] for h in truth["hidden"]),
            "delta": f"{max(h['delta'] for h in truth['hidden']):.2f}", "verdict": found["verdict"], "q_without": f"{found['global_test']['q']:.1f}", "p_without": found["global_test"]["p"],
            "best": best["effect"] if best else "", "best_right": best["effect"] in families if best else "", "q_best": f"{best['left_over']:.1f}" if best else "",
            "q_truth": f"{own['q']:.1f}", "p_truth": own["p"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program that found the cases")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--parallel", type=int, default=2)
    args = parser.parse_args()
    args.settings = settings_of_finder(args.folder, args.scree)
    table = args.folder / "truths.csv"
    rows = list(csv.DictReader(table.open())) if table.exists() else []
    done = {row["case"] for row in rows}
    todo = []
    for file in sorted((args.folder / "found").glob("*.json")):
        truth = json.loads((args.folder / "sealed" / file.name).read_text())
        if file.stem not in done and truth["hidden"] and all("entry" in h for h in truth["hidden"]):
            todo.append(file)
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(args.parallel) as pool:
        compile_laws(Path(name))
        for row in pool.map(lambda file: look(args, Path(name) / "laws.so", file), todo):
            rows.append(row)
            with open(table, "w", newline="", encoding="utf-8") as out:
                writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
                writer.writeheader()
                writer.writerows(sorted(rows, key=lambda row: row["case"]))
            print(", ".join(str(value) for value in row.values()), flush=True)


if __name__ == "__main__":
    main()
