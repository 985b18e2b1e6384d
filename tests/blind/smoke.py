#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two blind cases, one of them with nothing hidden, from end to end with budgets that are far too small: that the parts fit together and that cases give nothing away.

Usage: smoke.py SCREE
"""
import csv
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import terrains  # noqa: F401  (ends here as skipped where numpy or GDAL's module is absent)
import truths

HERE = Path(__file__).resolve().parent
# hardly anything is rejected at this level, so that the time does not depend on chance: what follows a rejection has tests of its own (tests/cli/diagnose_test.cpp)
SMALL = ["calibration.screening=6", "calibration.generations=1", "calibration.search_repeats=3", "calibration.surroundings=30", "calibration.repeats=3",
         "calibration.final_repeats=6", "calibration.folds=0", "diagnosis.reference_repeats=20", "diagnosis.repeats=6", "diagnosis.draws=999",
         "diagnosis.finalists=1", "diagnosis.rounds=1", "diagnosis.wide_search=0", "diagnosis.level=0.001",
         'diagnosis.without=["soil_patch", "low_friction", "forest_drag", "slip_friction", "release_motion", "block_shape", "rolling_speed", "friction_speed", "soil_scatter", "restitution_mass", '
         '"restitution_half_speed", "fragmentation", "roughness", "third_dimension"]']
DRAWN = ["--seed", "smoke", "--count", "40", "--blocks", "14", "--threads", "2", "--search", "none", "--slopes", "development"]
TRACES = ("own_law", "[[effect]]", "tier", "delta", "laws.so", "truth")


def run(script, *arguments):
    done = subprocess.run([sys.executable, "-B", str(HERE / script), *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{script} {' '.join(arguments)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def main():
    with tempfile.TemporaryDirectory() as folder:
        for first, tier in enumerate("51"):
            run("generate.py", sys.argv[1], folder, "--first", str(first), "--tiers", tier, *DRAWN)
        for file in (Path(folder) / "cases").rglob("*"):
            if file.is_file():
                text = file.read_text()
                assert not [t for t in TRACES if t in text], f"{file.name} gives something away"
        truth = json.loads((Path(folder) / "sealed" / "0001.json").read_text())
        assert truth["tier"] == 1 and len(truth["hidden"]) == 1 and truth["hidden"][0]["strength"] > 0.0, truth
        sets = [word for change in SMALL for word in ("--set", change)]
        print(run("find.py", sys.argv[1], folder, *sets), end="")
        assert len(list((Path(folder) / "found").glob("*.json"))) == 2, "a case was not diagnosed"
        said = run("score.py", folder)
        assert said.startswith("2 cases, of which nothing hidden in 1"), said
        print(said)
        checked = run("checks.py", sys.argv[1], folder, "--cases", "1")
        assert "shuffled: the same diagnosis in 1 of 1" in checked, checked
        true = truths.true_site((Path(folder) / "cases" / "0001" / "site.toml").read_text(), truth)
        assert truth["hidden"][0]["entry"] in true and all(f"{key} = {value!r}\n" in true for soil in truth["soils"].values() for key, value in soil.items()), true
        run("truths.py", sys.argv[1], folder)
        left = list(csv.DictReader((Path(folder) / "truths.csv").open()))
        assert [row["case"] for row in left] == ["0001"] and float(left[0]["q_truth"]) > 0.0 and float(left[0]["q_without"]) > 0.0, left
        other = subprocess.run([sys.executable, "-B", str(HERE / "truths.py"), sys.executable, folder], capture_output=True, text=True)
        assert other.returncode and "is not the program that found the cases" in other.stderr, other
        kept = Path(folder) / "kept"
        run("keep.py", str(kept), folder)
        shutil.unpack_archive(kept / "run.tar.xz", kept)
        assert run("score.py", str(kept)) == said, "a kept run scores otherwise"
        run("generate.py", sys.argv[1], str(kept), "--first", "1", "--tiers", "1", *DRAWN)
        for file in (Path(folder) / "cases" / "0001").rglob("*.*"):
            again = kept / file.relative_to(folder)
            assert again.read_bytes() == file.read_bytes(), f"{file.name} of a kept case is thrown otherwise"
        other = ["15" if word == "14" else word for word in DRAWN]
        shutil.rmtree(kept / "cases")
        refused = subprocess.run([sys.executable, "-B", str(HERE / "generate.py"), sys.argv[1], str(kept), "--first", "1", "--tiers", "1", *other], capture_output=True, text=True)
        assert refused.returncode and "cannot be thrown again as it was" in refused.stderr and not (kept / "cases" / "0001").exists(), refused
        file = Path(folder) / "sealed" / "0000.json"
        file.write_text(file.read_text().replace("5", "6", 1))
        forged = subprocess.run([sys.executable, "-B", str(HERE / "score.py"), folder], capture_output=True, text=True)
        assert forged.returncode and "is not the truth that was sealed" in forged.stderr, forged


if __name__ == "__main__":
    main()
