# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds a run of blind cases together: hashes of the truths (sealed.sha256) and of all that the finder gets of a case, and files that are whole."""
import hashlib
import json
import sys
from pathlib import Path


def seals(folder):
    """Hash of every sealed truth, by its path in the folder."""
    hashes, file = {}, folder / "sealed.sha256"
    for line in file.read_text().splitlines() if file.exists() else []:
        value, name = line.split()
        if hashes.setdefault(name, value) != value:
            sys.exit(f"{file}: {name} was sealed twice")
    return hashes


def settings_of_finder(folder, scree):
    """With which the cases of the folder were found; by this very program, or the script ends."""
    finder = json.loads((folder / "finder.json").read_text())
    if hashlib.sha256(Path(scree).read_bytes()).hexdigest() != finder["program_sha256"]:
        sys.exit(f"{scree} is not the program that found the cases of {folder}")
    return finder["settings"]


def write_whole(file, text):
    """What is there under its name is whole: a file that was cut short would count as done."""
    draft = file.with_name(file.name + ".part")
    draft.write_text(text)
    draft.replace(file)


def hash_of(case):
    """Of all that the finder gets."""
    text = hashlib.sha256()
    for path in sorted(path for path in case.rglob("*") if path.is_file()):
        text.update(f"{path.relative_to(case)}\0".encode() + path.read_bytes() + b"\0")
    return text.hexdigest()
