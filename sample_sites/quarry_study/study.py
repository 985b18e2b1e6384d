#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The programme of Bourrier & Acary (2022) on the two synthetic quarries, with scree's own commands and one report.

Usage: study.py SCREE [--output DIR] [--sets N] [--calibrate-in 2|3] [--threads N]

Calibrates on path A, predicts path B in 2D and 3D and path A in the other dimension, with one, two and three soil zones; repeats
sets of 50 blocks; varies the number of blocks, their shape and the soil parameters one at a time. Every step is a command that is
printed; steps whose results are there already are not run again. Writes DIR/report.html (default: out beside this file).
"""
import argparse
import html
import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SITES = HERE.parent
FREE = ["soil.loose waste.restitution=0:0.4", "soil.loose waste.friction=0.3:0.9", "soil.loose waste.rolling=0.002:0.15:log",
        "soil.compact waste.restitution=0:0.4", "soil.compact waste.friction=0.3:0.9", "soil.compact waste.rolling=0.002:0.15:log"]
# the paper's starting point of its influence study: e = 0, mu = 0.6, mu_r = 0 everywhere, one at a time
FROM_ZERO = ["soil.*.restitution=0", "soil.*.friction=0.6", "soil.*.rolling=0"]
INFLUENCE = ["soil.*.friction=0.4,0.5,0.6,0.7,0.8", "soil.*.restitution=0,0.1,0.2,0.4", "soil.*.rolling=0,0.02,0.05,0.1"]


class Study:
    """Steps of a programme, each a command of scree whose results are kept in a folder of their own, and the report on them.

    `sites`: name -> (site file, measurements, further options of every command). A step whose results are there is not run again.
    """

    def __init__(self, scree, out, sites, threads=0):
        self.scree, self.out, self.sites, self.threads = scree, Path(out), sites, threads
        self.parts = []      # (title, text, [svg files])
        self.out.mkdir(parents=True, exist_ok=True)

    def run(self, name, command, site, *options):
        """Runs a command unless its results are there; returns the folder of them."""
        file, observed, always = self.sites[site]
        folder = self.out / name
        if (folder / "SHA256SUMS").exists():
            return folder
        line = [self.scree, command, str(file), "--observed", str(observed), "--output", str(folder), "--threads", str(self.threads), *always,
                *options]
        if command == "calibrate" and (self.out / f"{name}.journal.jsonl").exists():
            line.append("--resume")
        print("$", " ".join(f'"{word}"' if set(word) & set(" *|") else word for word in line), flush=True)
        done = subprocess.run(line)
        if done.returncode:
            sys.exit(done.returncode)
        return folder

    def add(self, title, text, *figures):
        self.parts.append((title, text, [f for f in figures if f.exists()]))


def sets(*changes):
    return [word for change in changes for word in ("--set", change)]


def frees(*keys):
    return [word for key in keys for word in ("--free", key)]


def read(folder, name):
    return json.loads((folder / name).read_text())


def gap_of(folder):
    overall = read(folder, "compare.json")["overall"]["pooled"]
    return f"{overall['gap']:.2f} (chance {overall['chance_95'][0]:.2f} to {overall['chance_95'][1]:.2f})"


def calibrated_changes(folder):
    return [f"{p['key']}={p['value']!r}" for p in read(folder, "calibrate.json")["parameters"]]


def told_apart(folder):
    """key -> [(value, share of sets told apart)], without the site as it is."""
    values = {}
    for v in read(folder, "sweep.json")["values"]:
        values.setdefault(v["key"], []).append((v["value"], v["told_apart"]))
    return values


def measure(folder, key, name):
    """Means of a measure in the order of a swept key's values."""
    return [v["measures"][name]["mean"] for v in read(folder, "sweep.json")["values"] if v["key"] == key]


def measures_of(folder):
    return list(read(folder, "sweep.json")["values"][0]["measures"])


def deviations(folder, key, name):
    return [v["measures"][name]["deviation"] for v in read(folder, "sweep.json")["values"] if v["key"] == key]


def influences(study, site, dimension, count):
    """Number of blocks, shapes and soil parameters on one site; returns rows of the table of findings: (finding, paper, here, agrees)."""
    rows = []
    options = ["--sets", str(count), *sets(f"model.dimension={dimension}")]

    size = study.run("sample_size", "sweep", site, *options, *sets("release.count=10,50,200,500,2000"))
    scatter = deviations(size, "release.count", "distance along, mean")
    study.add("Scatter from set to set and number of blocks", "", size / "figures" / "sweep.svg")
    rows.append(("Scatter falls with the number of blocks", "yes, some is left at 2000",
                 "standard deviation of the mean distance of 10, 50, 200, 500, 2000 blocks [m]: " + ", ".join(f"{v:.2f}" for v in scatter),
                 all(a > b for a, b in zip(scatter, scatter[2:]))))

    shapes = study.run("shapes", "sweep", site, *options, *sets("blocks.shape=box,eota,sharp,hull,round"))
    apart = dict(told_apart(shapes)["blocks.shape"])
    study.add("Shape of the blocks", "", shapes / "figures" / "sweep.svg")
    rows.append(("Boxes and EOTA blocks differ from irregular ones by more than scatter", "yes",
                 ", ".join(f"{k}: {100 * v:.0f} % of the sets told apart" for k, v in apart.items()), min(apart["box"], apart["eota"]) > 0.5))
    rows.append(("Irregular blocks of more or fewer corners do not", "yes", "as above", max(apart["sharp"], apart["round"]) < 0.5))

    influence = study.run("influence", "sweep", site, *options, *sets(*FROM_ZERO, *INFLUENCE))
    study.add("Soil parameters, one at a time from e = 0, mu = 0.6, mu_r = 0", "", influence / "figures" / "sweep.svg")
    apart = told_apart(influence)
    for name, key, matters in (("e", "restitution", True), ("mu_r", "rolling", True), ("mu", "friction", False)):
        shares = apart[f"soil.*.{key}"]
        most = max(share for _, share in shares)
        rows.append((f"{name} matters beyond the scatter of a field test" if matters else f"{name} between 0.4 and 0.8 hardly matters", "yes",
                     ", ".join(f"{v}: {100 * share:.0f} %" for v, share in shares) + " of the sets told apart", (most > 0.5) == matters))
    for name, key, sign in (("Higher e runs farther", "restitution", 1.0), ("Lower mu_r runs farther", "rolling", -1.0)):
        means = measure(influence, f"soil.*.{key}", "distance along, mean")
        rows.append((name, "yes", "mean distance [m]: " + ", ".join(f"{m:.1f}" for m in means), sign * (means[-1] - means[0]) > 0.0))
    for name, key, sign in (("Higher e is faster", "restitution", 1.0), ("Lower mu_r is faster", "rolling", -1.0)):
        speeds = [m for m in measures_of(influence) if "speed" in m and "mean" in m]
        if not speeds:
            continue
        means = {m: measure(influence, f"soil.*.{key}", m) for m in speeds}
        rows.append((name, "yes", "; ".join(f"{m} [m/s]: " + ", ".join(f"{v:.1f}" for v in means[m]) for m in speeds),
                     all(sign * (v[-1] - v[0]) > 0.0 for v in means.values())))
    return rows


def steps(study, dimension, count):
    """The programme on the quarries; returns the rows of the table of findings."""
    rows = []
    other = 5 - dimension
    both = sets(f"model.dimension={dimension}")
    repeat = sets("observed.repeats=40")

    # calibration on path A, prediction
    before = study.run("path_a_before", "compare", "a", *both, *repeat)
    calibrated = study.run("path_a_calibrated", "calibrate", "a", *both, *frees(*FREE))
    values = sets(*calibrated_changes(calibrated))
    predictions = {}
    for site in "ab":
        for d in (2, 3):
            predictions[site, d] = study.run(f"path_{site}_{d}d", "compare", site, *sets(f"model.dimension={d}"), *values, *repeat)
    text = f"Overall gap before: {gap_of(before)}. " + " ".join(
        f"Path {site.upper()} in {d}D with the calibrated values: {gap_of(folder)}." for (site, d), folder in predictions.items())
    study.add(f"Calibration on path A in {dimension}D", text, calibrated / "figures" / "parameters.svg", calibrated / "figures" / "pairs.svg",
              calibrated / "figures" / "overview.svg")
    for (site, d), folder in predictions.items():
        study.add(f"Path {site.upper()} in {d}D" + ("" if (site, d) == ("a", dimension) else ": predicted"), f"Overall gap {gap_of(folder)}.",
                  folder / "figures" / "overview.svg", folder / "figures" / "map.svg")
    own = read(predictions["a", dimension], "compare.json")["overall"]["pooled"]["gap"]
    across = read(predictions["a", other], "compare.json")["overall"]["pooled"]["gap"]
    rows.append((f"Parameters calibrated in {dimension}D match in {other}D as well", "yes, slightly better in 3D",
                 f"gap on path A {own:.2f} in {dimension}D, {across:.2f} in {other}D", across <= 1.5 * own + 0.5))

    # soil zones, with the paper's values
    gaps = {}
    for name, site, changes in (("1 zone", "a", sets("zones.file=", "zones.default=loose waste")), ("2 zones", "a", []), ("3 zones", "a3", [])):
        folder = study.run("path_a_" + name.replace(" ", "_"), "compare", site, *both, *changes, *repeat)
        gaps[name] = read(folder, "compare.json")["overall"]["pooled"]["gap"]
        study.add(f"Path A, {name}, values of the paper", f"Overall gap {gap_of(folder)}.", folder / "figures" / "overview.svg")
    rows.append(("Three zones describe path A better than one", "yes, slightly", ", ".join(f"{k}: gap {v:.2f}" for k, v in gaps.items()),
                 gaps["3 zones"] < gaps["1 zone"]))

    # scatter and sample size, shapes, parameters
    return rows + influences(study, "a", dimension, count)


def write_report(study, rows, title, remark):
    rows = [(finding, paper, here, bool(agrees)) for finding, paper, here, agrees in rows]
    (study.out / "findings.json").write_text(json.dumps(rows, indent=1) + "\n")

    def cell(text, kind="td"):
        return f"<{kind}>{html.escape(text)}</{kind}>"
    lines = ["<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8"><title>' + html.escape(title) + '</title><style>',
             "body{font:15px/1.45 Arial,Helvetica,sans-serif;max-width:1320px;margin:24px auto;padding:0 20px;color:#222}",
             "table{border-collapse:collapse;font-size:13px}td,th{padding:4px 9px;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}",
             "svg{max-width:100%;height:auto}h2{font-size:18px;margin-top:30px}</style></head><body>",
             f"<h1>{html.escape(title)}</h1>", f"<p>{html.escape(remark)}</p>",
             "<table><tr>" + "".join(cell(h, "th") for h in ("finding", "paper", "here", "agrees")) + "</tr>"]
    for finding, paper, here, agrees in rows:
        lines.append("<tr>" + cell(finding) + cell(paper) + cell(here) + cell("yes" if agrees else "no") + "</tr>")
    lines.append("</table>")
    for title, text, figures in study.parts:
        lines.append(f"<h2>{html.escape(title)}</h2><p>{html.escape(text)}</p>")
        for figure in figures:
            svg = figure.read_text()
            lines.append(svg[svg.index("<svg"):])
    lines.append("</body></html>")
    (study.out / "report.html").write_text("\n".join(lines) + "\n")
    print(f"report: {study.out / 'report.html'}")
    for finding, _, here, agrees in rows:
        print(("agrees   " if agrees else "DIFFERS  ") + finding + ": " + here)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("--output", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--sets", type=int, default=20, help="sets of 50 blocks per value of a sweep (default 20)")
    parser.add_argument("--calibrate-in", type=int, choices=(2, 3), default=2, help="dimension of calibration and sweeps (default 2)")
    parser.add_argument("--threads", type=int, default=0)
    args = parser.parse_args()
    sites = {"a": (SITES / "quarry_a" / "site.toml", SITES / "quarry_a" / "observed", []),
             "a3": (SITES / "quarry_a" / "three_zones.toml", SITES / "quarry_a" / "observed", []),
             "b": (SITES / "quarry_b" / "site.toml", SITES / "quarry_b" / "observed", [])}
    study = Study(args.scree, args.output, sites, args.threads)
    write_report(study, steps(study, args.calibrate_in, args.sets), "The paper's programme on quarry_a and quarry_b",
                 "The quarries are synthetic and so are their field tests (README.md): where findings differ from the paper's, ground, blocks and "
                 "truth differ, too.")


if __name__ == "__main__":
    main()
