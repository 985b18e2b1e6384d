#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scorer on answers made by hand, whose right scores can be counted on the fingers.

Usage: score_test.py
"""
import hashlib
import io
import json
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

import score

TRUTHS, FOUND = [], []


def case(tier, hidden, verdict, names=(), together=False, n=50, instruments=("stops", "speed"), ranked=(), **told):
    """One case: `hidden` are (families, delta, more), `names` what is answered, `told` goes into the first answer."""
    TRUTHS.append({"case": len(TRUTHS), "tier": tier, "slope": "road", "n": n, "ids": True, "instruments": instruments,
                   "hidden": [{"name": families[0], "families": families, "delta": delta, "at": None, **more} for families, delta, more in hidden]})
    answer = [{"effect": name, "form": f"{name}_form", "together": together, "parameter": "coefficient", "interval_95": [1.0, 3.0],
               "removable_gap_closed": 0.9, "held_out_loss": 1.0} for name in names]
    if answer:
        answer[0].update(told)
    FOUND.append({"verdict": verdict, "answer": answer, "effects": [{"effect": name, "weight": weight} for name, weight in ranked] + [{"effect": "not_asked", "weight": None}],
                  "global_test": {"p": 0.5 if verdict == "NONE" else 0.001}, "baseline": {"held_out_loss": 2.0}, "simulated_blocks": 1000})


def write(folder):
    lines = []
    for kind in ("sealed", "found"):
        (folder / kind).mkdir()
    for k, (truth, found) in enumerate(zip(TRUTHS, FOUND)):
        text = json.dumps(truth).encode()
        (folder / "sealed" / f"{k:04}.json").write_bytes(text)
        lines.append(f"{hashlib.sha256(text).hexdigest()}  sealed/{k:04}.json")
        if found is score.REFUSED:
            (folder / "found" / f"{k:04}.error").write_text("error: nothing was measured")
        elif found:
            (folder / "found" / f"{k:04}.json").write_text(json.dumps(found))
    (folder / "sealed.sha256").write_text("\n".join(lines) + "\n")


def line(said, start):
    """What is said of all cases and of those with 50 blocks."""
    rest, = [text[45:] for text in said.splitlines() if text.startswith(start)]
    return rest[:28].strip(), rest[28:].strip()


def main():
    drag, patch, speeds = ("ground_drag", "forest_drag"), ("soil_patch",), ("speed_error",)
    place = score.AXIS_FROM_HEAD
    case(5, [], "NONE")
    case(5, [], "UNKNOWN", n=30)  # a false alarm
    case(5, [], "NAMED", ["ground_drag"])  # and a wrong name
    case(5, [], "UNKNOWN", ["ground_drag"])  # taken back: a false alarm, no name
    entry = "[[effect]]\nkind = \"ground_drag_form\"\ncoefficient = 2.0"
    case(0, [(drag, 5.0, {"entry": entry})], "NAMED", ["ground_drag"], ranked=[("soil_patch", 0.1), ("ground_drag", 0.8)])  # right; its interval holds the strength
    case(0, [(drag, 5.0, {"entry": entry.replace("2.0", "3.5")})], "NAMED", ["ground_drag"], ranked=[("ground_drag", 0.9)], held_out_loss=2.5)  # here it does not; held-out blocks worse
    case(1, [(drag, 3.0, {})], "NAMED", ["forest_drag"], ranked=[("forest_drag", 0.7)])  # the other right name
    case(1, [(drag, 3.0, {})], "NAMED", ["soil_patch"], ranked=[("soil_patch", 0.7), ("ground_drag", 0.2)])  # wrong
    case(1, [(drag, 3.0, {})], "GROUP", ["soil_patch", "ground_drag"], ranked=[("soil_patch", 0.5), ("ground_drag", 0.4)])  # right in the group, the best is not
    case(1, [(drag, 1.0, {})], "NONE")  # not detected
    case(0, [(patch, 6.0, {"at": [20.0 + place, 30.0 + place]})], "NAMED", ["soil_patch"], between_m=[22.0, 32.0], ranked=[("soil_patch", 0.7)])  # right, 2 m off
    case(2, [(drag, 4.0, {}), (patch, 4.0, {})], "NAMED", ["ground_drag", "soil_patch"], together=True)  # both
    case(2, [(drag, 4.0, {}), (patch, 4.0, {})], "NAMED", ["ground_drag", "roughness"], together=True)  # one of two: a wrong name was said
    case(2, [(drag, 4.0, {}), (patch, 4.0, {})], "NAMED", ["soil_patch"])  # one, rightly
    case(3, [(("own_law",), 4.0, {})], "NAMED", ["roughness"])  # the catalogue has none
    case(3, [(("own_law",), 4.0, {})], "UNKNOWN")
    case(4, [(("third_dimension",), None, {})], "NAMED", ["third_dimension"])
    case(6, [(speeds, 9.0, {})], "DATA PROBLEM", ["speed_error"])
    case(6, [(speeds, 9.0, {})], "NONE")
    case(0, [(drag, 9.0, {})], "NONE")
    FOUND[-1] = None  # not looked at yet: in no rate
    case(1, [(drag, 9.0, {})], "REFUSED")  # counts as not detected
    FOUND[-1] = score.REFUSED
    case(1, [(drag, 9.0, {})], "NAMED", ["ground_drag", "soil_patch"], together=True, ranked=[("ground_drag", 0.7)])  # of one that is hidden, two: wrong
    case(6, [(speeds, 9.0, {"name": "speed_noise", "strength": 2.0})], "DATA PROBLEM", ["speed_error"], form="speed_error", parameter="noise")  # its interval holds the strength
    case(1, [(drag, 3.0, {})], "GROUP", ["soil_patch", "roughness"], ranked=[("soil_patch", 0.5)])  # not in the group
    case(1, [(drag, 3.0, {})], "GROUP", ["soil_patch", "roughness", "low_friction", "ground_drag"], ranked=[("soil_patch", 0.5)])  # too large a group
    case(2, [(drag, 4.0, {}), (patch, 1.0, {})], "UNKNOWN")  # one of the two cannot be seen

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder)
        sys.argv = ["score.py", name]
        with redirect_stdout(io.StringIO()) as out:
            score.main()
        sys.argv.append(name)  # two runs as one
        with redirect_stdout(io.StringIO()) as out_of_two:
            score.main()
    said, of_two = out.getvalue(), out_of_two.getvalue()
    for start, hits, n in (("false alarms", 3, 4), ("wrong name where nothing is hidden", 1, 4), ("wrong name, all", 5, 25),
                           ("a single printed name is right", 8, 11), ("  where the catalogue has", 8, 10), ("  of a fault", 2, 2),
                           ("  of the third dimension", 1, 1), ("  of an effect on blocks", 5, 8), ("truth among the names", 8, 11), ("truth in a printed group", 1, 2),
                           ("best of detected is right, stops and speeds", 5, 9), ("outside the catalogue: wrong name", 1, 2), ("outside, detected: wrong name", 1, 2),
                           ("outside, detected: UNKNOWN", 1, 2), ("two effects, detected: a name is right", 3, 4), ("two effects, detected: both", 1, 4),
                           ("  where each has a delta", 1, 3), ("two names said", 1, 3),
                           ("3D under a 2D model: a wrong", 0, 1), ("3D under a 2D model, detected", 1, 1), ("fault of measurement, detected", 2, 2),
                           ("held-out blocks worse", 1, 3), ("names that were taken back", 1, 1), ("interval of the strength", 2, 3),
                           ("place within", 1, 1)):
        assert line(said, start)[0] == score.share(hits, n), f"{start}: {line(said, start)[0]} is said, {hits} of {n} is right\n{said}"
    assert line(said, "false alarms")[1] == score.share(2, 3), said  # the case of 30 blocks is not among them
    assert line(of_two, "false alarms")[0] == score.share(6, 8), of_two
    assert f"refused, and counted as nothing detected: 2 ({folder.resolve().name}/0020, {folder.resolve().name}/0020)" in of_two, of_two
    for words in ("25 cases, of which nothing hidden in 4", "in none of the rates: 1 (0019)", "counted as nothing detected: 1 (0020)", "median error        2.0 m of 1",
                  f"  2.50 to 3.75  {score.share(5, 5):<28}{score.share(5, 5):<28}{score.share(3, 5)}"):
        assert words in said, f"{words}\n{said}"
    low, high = score.wilson(8, 10)  # Wilson (1927): 0.490 to 0.943
    assert abs(low - 0.490) < 0.001 and abs(high - 0.943) < 0.001, (low, high)
    print(f"{len(TRUTHS)} cases made by hand are scored rightly")


if __name__ == "__main__":
    main()
