#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps a run of blind cases, whole or so far: what was sealed and what was found, without the cases themselves, which follow from the seed.

Usage: keep.py TARGET FOLDER [FOLDER ...]

Writes TARGET/sealed.sha256 and, of what was found so far, TARGET/finder.json and TARGET/run.tar.xz with sealed/NNNN.json and found/NNNN.json, of which what
score.py reads is kept. The hashes of cases that were not yet looked at are kept, their truths stay out. Unpacked beside the other two files a run can be
scored, and generate.py and find.py go on from there.
"""
import argparse
import io
import json
import sys
import tarfile
from pathlib import Path

from seals import seals

KEPT = ("program", "field_test_sha256", "verdict", "sentence", "answer", "weight_none", "weight_unnamed", "measured_blocks", "simulated_blocks")


def condensed(found):
    result = json.loads(found.read_text())
    kept = {key: result[key] for key in KEPT if key in result}
    kept["effects"] = [{key: effect.get(key) for key in ("effect", "form", "z", "weight", "left_over", "left_over_p")} for effect in result["effects"]]
    kept["global_test"] = {key: result.get("global_test", {}).get(key) for key in ("q", "p")}
    kept["baseline"] = {"held_out_loss": result.get("baseline", {}).get("held_out_loss")}
    return json.dumps(kept, separators=(",", ":")).encode()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("target", type=Path)
    parser.add_argument("folders", type=Path, nargs="+")
    args = parser.parse_args()
    finders = {(folder / "finder.json").read_text() for folder in args.folders if (folder / "finder.json").exists()}
    if len(finders) > 1:
        sys.exit("the folders were found by different programs or with different settings")
    sealed, files = {}, {}
    for folder in args.folders:
        for name, digest in seals(folder).items():
            if sealed.setdefault(name, digest) != digest:
                sys.exit(f"{folder}: {name} was sealed twice")
        for found in (folder / "found").glob("*.json"):
            name = f"sealed/{found.name}"
            files[name] = (folder / name).read_bytes()
            files[f"found/{found.name}"] = condensed(found)
        for refused in (folder / "found").glob("*.error"):
            files[f"sealed/{refused.stem}.json"] = (folder / "sealed" / f"{refused.stem}.json").read_bytes()
            files[f"found/{refused.name}"] = refused.read_bytes()
    args.target.mkdir(parents=True, exist_ok=True)
    (args.target / "sealed.sha256").write_text("".join(f"{sealed[name]}  {name}\n" for name in sorted(sealed)))
    if not files:
        sys.exit(f"{len(sealed)} hashes kept, nothing was found yet")
    (args.target / "finder.json").write_text(finders.pop())
    with tarfile.open(args.target / "run.tar.xz", "w:xz") as tar:
        for name in sorted(files):
            member = tarfile.TarInfo(name)
            member.size = len(files[name])
            tar.addfile(member, io.BytesIO(files[name]))
    print(f"{sum(name.startswith('found') for name in files)} of {len(sealed)} cases kept")


if __name__ == "__main__":
    main()
