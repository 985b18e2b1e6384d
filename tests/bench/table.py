#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of Google Benchmark (JSON) as a table in Markdown. Usage: table.py FILE.json

Speeds stand per second and per 1e9 dependent additions (core_clock.hpp): the latter can be compared between runs on one kind of processor whatever its
clock was. Real time where the name says so, CPU time elsewhere.
"""
import json
import sys

STANDARD = {"items_per_second", "per_1e9_additions", "additions_per_s"}
FIELDS = {"name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions", "repetition_index", "threads", "iterations",
          "real_time", "cpu_time", "time_unit", "aggregate_name", "aggregate_unit"}
THINGS = {"campaign": "blocks", "campaign_threads": "blocks", "campaign_terrain": "blocks", "campaign_plane": "blocks", "path_a": "blocks",
          "surface_build": "cells", "terrain_read": "cells", "hull_build": "hulls", "detection": "looks", "solver": "problems", "flight": "flights"}


def number(value):
    """Three or four digits."""
    return f"{value:.4g}" if value < 1e4 else f"{value:.3e}"


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        sys.exit(2)
    with open(sys.argv[1]) as file:
        output = json.load(file)
    context = output["context"]
    print(f"- dependent additions per second at the start: {float(context['dependent_additions_per_s']):.3g}")
    print("\n| scene | things | time of one run | things per second | things per 1e9 dependent additions | additions per second meanwhile | what came up |")
    print("|---|---|---|---|---|---|---|")
    for b in sorted(output["benchmarks"], key=lambda b: (b["family_index"], b["per_family_instance_index"])):
        if "error_occurred" in b:
            sys.exit(f"{b['name']}: {b.get('error_message', 'failed')}")
        if b["run_type"] == "aggregate" and b["aggregate_name"] != "median":
            continue
        time = b["real_time"] if b["name"].endswith("/real_time") or "/real_time_" in b["name"] else b["cpu_time"]
        speeds = [number(b[key]) if key in b else "" for key in ("items_per_second", "per_1e9_additions", "additions_per_s")]
        others = ", ".join(f"{key} {number(value)}" for key, value in b.items() if key not in STANDARD | FIELDS)
        scene = b["name"].replace("/iterations:1", "")
        things = THINGS.get(b["run_name"].split("/")[0], "")
        print(f"| {scene} | {things} | {number(time)} {b['time_unit']} | {' | '.join(speeds)} | {others} |")


main()
