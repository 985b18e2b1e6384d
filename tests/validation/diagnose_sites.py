#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is missing at the real sites, as far as their measurements say: `scree diagnose` on each of them.

Usage: diagnose_sites.py SCREE [--output DIR] [--only NAME ...] [--threads N] [--set KEY=VALUE ...]

Names: authume_2d, authume_3d, tschamut. A diagnosis takes from ten minutes to a few hours of one core; one that is in DIR is not done again, one that
was stopped goes on. Writes DIR/NAME/ (report.html, diagnosis.json) and prints the verdicts. The extended sites of Authume are
written to DIR as they would be frozen beside authume/programme.py; what is frozen there is not touched (README.md says which it is). The five runs of Chant Sura are too few for a diagnosis: chant_sura/contacts.py. The data are found by SCREE_SHARED_DATA; without them: exit code 77.
"""
import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

import observations
from sites import HERE, PREFIX, path_changes, site_file

SOILS = ["soil.*.restitution=0:0.5", "soil.*.friction=0.3:0.9", "soil.*.rolling=0.002:0.3:log"]
SEARCH = ["calibration.starts=4", "calibration.generations=16"]  # as in authume/programme.py
# name -> (site, free keys, more changes)
DIAGNOSES = {
    "authume_2d": ("authume_P1", [*SOILS, "release.height=2:8.5"], ["model.dimension=2", *SEARCH]),
    "authume_3d": ("authume_P1", [*SOILS, "release.height=2:8.5"], ["model.dimension=3", *SEARCH]),
    "tschamut": ("tschamut", [*SOILS, "release.height=0.1:1"], []),
}


def diagnose(args, name):
    site, free, changes = DIAGNOSES[name]
    measured = args.output / f"{site}_observed"
    if not measured.exists():
        observations.convert(site, measured)
    line = [args.scree, "diagnose", str(site_file(site)), "--observed", str(measured), "--output", str(args.output / name), "--threads", str(args.threads),
            "--quiet", *path_changes(site)]
    for key in free:
        line += ["--free", key]
    for change in [*changes, *args.set]:
        line += ["--set", change]
    if (args.output / f"{name}.journal").exists():
        line.append("--resume")
    done = subprocess.run(line, capture_output=True, text=True)
    (args.output / f"{name}.txt").write_text(done.stdout + done.stderr)
    if done.returncode:
        sys.exit(f"{name}: {done.stdout}{done.stderr}")
    if name.startswith("authume"):  # with the paths of the data as the other real sites have them
        text = (args.output / name / "site_extended.toml").read_text()
        text = re.sub(r"'[^']*/(data/authume_P1/[^']*)'", rf"'{PREFIX[3:]}\1'", text)
        (args.output / f"site_extended_{name[-2:]}.toml").write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("--output", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--only", nargs="+", default=list(DIAGNOSES), choices=DIAGNOSES, metavar="NAME")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    for name in args.only:
        if not (args.output / name / "diagnosis.json").exists():
            diagnose(args, name)
        print(f"{name}: {json.loads((args.output / name / 'diagnosis.json').read_text())['sentence']}", flush=True)


if __name__ == "__main__":
    main()
