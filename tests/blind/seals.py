# SPDX-License-Identifier: GPL-3.0-or-later
"""Hashes that hold a run of blind cases together: of the truths (sealed.sha256), and of all that the finder gets of a case."""
import hashlib
import sys


def seals(folder):
    """Hash of every sealed truth, by its path in the folder."""
    hashes = {}
    for line in (folder / "sealed.sha256").read_text().splitlines():
        value, name = line.split()
        if hashes.setdefault(name, value) != value:
            sys.exit(f"{folder / 'sealed.sha256'}: {name} was sealed twice")
    return hashes


def hash_of(case):
    """Of all that the finder gets."""
    text = hashlib.sha256()
    for path in sorted(path for path in case.rglob("*") if path.is_file()):
        text.update(f"{path.relative_to(case)}\0".encode() + path.read_bytes() + b"\0")
    return text.hexdigest()
