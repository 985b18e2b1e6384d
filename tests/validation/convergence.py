#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the statistics of a campaign depend on the time step, on the smooth and the rough quarry_a, in both modes.

Usage: convergence.py run   --scree PROGRAM --work FOLDER [--count 100000] [--threads N] [--only SITE/MODE/STEP ...]
       convergence.py keep  --work FOLDER
       convergence.py table [--plot OUT.svg]

`run` throws blocks in shards of SHARD, every shard with a seed of its own, and keeps what is compared in FOLDER; stopped and started again it goes on
where it was. Runs of all steps advance side by side. `keep` writes the distributions of whole runs to results/convergence. `table` compares them: successive
steps of a mode, and moreau_jean with the finest of event mode; shifts in standard deviations with their standard error, and the two-sample
Kolmogorov-Smirnov distance with its 1 % limit.
"""
import argparse
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from sites import PROJECT, features, np, run_table

SHARD = 5000                                  # blocks of one call of scree
STEPS = {"event": [16e-3, 8e-3, 4e-3, 2e-3, 1e-3, 5e-4], "moreau_jean": [8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4]}  # [s]
SITES = ["smooth", "rough"]
SITE_FILE = PROJECT / "sample_sites" / "quarry_a" / "site.toml"
KS_LIMIT = math.sqrt(-math.log(0.01 / 2.0) / 2.0)  # times sqrt(1/n + 1/m): two-sample Kolmogorov-Smirnov at 1 %
LEVELS = np.linspace(0.0, 1.0, 1001)          # at which distributions are kept: distances between them come out too small by 3 % of the limit at most
RESULTS = Path(__file__).resolve().parent / "results" / "convergence"
QUANTITIES = {"speed_ms": "speed", "height_m": "passing height", "spin_rads": "spin"}


def name_of(step):
    return f"{step * 1e3:g}ms"


def dtm(site, work):
    original = SITE_FILE.parent / "data" / "dtm.tif"
    if site == "smooth":
        return original
    rough = work / "rough.tif"
    if not rough.exists():
        subprocess.run([sys.executable, str(Path(__file__).with_name("make_rough.py")), str(original), str(rough)], check=True)
    return rough


def run_shard(scree, work, site, mode, step, number, threads):
    """Runs one shard and keeps its values; the file appears under its name only when it is whole."""
    seed = 1 + number + 1000 * (STEPS[mode].index(step) + 10 * list(STEPS).index(mode) + 100 * SITES.index(site))
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder) / "results"
        done = subprocess.run([scree, "run", str(SITE_FILE), "--set", f"terrain.dtm={dtm(site, work)}", "--set", f"release.count={SHARD}",
                               "--set", f"model.mode={mode}", "--set", f"model.time_step={step}", "--seed", str(seed),
                               "--set", "output.trajectories=0", "--threads", str(threads), "--output", str(results), "--quiet"],
                              capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{site}, {mode}, {step} s: {done.stdout}{done.stderr}")
        values = {}
        stops = [s for s in features(results, "stopping_points") if s["stop_reason"] == "at_rest"]
        values["stop x [m]"] = [s["xyz"][0][0] for s in stops]
        values["stop y [m]"] = [s["xyz"][0][1] for s in stops]
        for row in features(results, "screen_crossings"):
            for field, quantity in QUANTITIES.items():
                unit = {"speed_ms": "m/s", "height_m": "m", "spin_rads": "rad/s"}[field]
                values.setdefault(f"{row['screen']} {quantity} [{unit}]", []).append(row[field])
        shares = {f"share:{z['name']}": [z["count"], z["released"]] for z in features(results, "deposit_zones")}
        table = run_table(results)
        shares["share:not at rest"] = [SHARD - int(table["ended_at_rest"]), SHARD]
        shares["problems"] = [int(table["contact_problems_above_tolerance"]), int(table["contact_problems"])]
        target = work / site / mode / name_of(step) / f"{number:04d}.npz"
        target.parent.mkdir(parents=True, exist_ok=True)
        draft = target.with_suffix(".part")
        with open(draft, "wb") as file:
            np.savez_compressed(file, **{k: np.array(v) for k, v in {**values, **shares}.items()})
        draft.replace(target)


def run(arguments):
    work = Path(arguments.work).resolve()
    work.mkdir(parents=True, exist_ok=True)
    wanted = [tuple(w.split("/")) for w in arguments.only] if arguments.only else None
    for number in range(math.ceil(arguments.count / SHARD)):
        for site in SITES:
            for mode, steps in STEPS.items():
                for step in steps:
                    if wanted and (site, mode, name_of(step)) not in wanted:
                        continue
                    if not (work / site / mode / name_of(step) / f"{number:04d}.npz").exists():
                        run_shard(arguments.scree, work, site, mode, step, number, arguments.threads)


class Sample:
    """Size, mean, standard deviation and quantiles of what was seen of one observable."""

    def __init__(self, size, mean, sd, quantiles):
        self.size, self.mean, self.sd, self.quantiles = int(size), float(mean), float(sd), quantiles

    @staticmethod
    def of(values):
        return Sample(len(values), values.mean(), values.std(), np.quantile(values, LEVELS))

    def below(self, places):
        """Share of the sample below each place."""
        return np.interp(places, self.quantiles, LEVELS)


class Run:
    """What is kept of one site, mode and step."""

    def __init__(self, count, samples, shares, problems):
        self.count, self.samples, self.shares, self.problems = count, samples, shares, problems

    @staticmethod
    def of_shards(files):
        shards = [dict(np.load(f)) for f in files]
        keys = list(shards[0])
        samples = {k: Sample.of(np.concatenate([s[k] for s in shards if k in s])) for k in keys if not k.startswith(("share:", "problems"))}
        shares = {k[len("share:"):]: sum(s[k] for s in shards) for k in keys if k.startswith("share:")}
        return Run(SHARD * len(shards), samples, shares, sum(s["problems"] for s in shards))

    def write(self, file):
        file.parent.mkdir(parents=True, exist_ok=True)
        table = {f"sample:{k}": np.array([s.size, s.mean, s.sd]) for k, s in self.samples.items()}
        table |= {f"quantiles:{k}": (s.quantiles - s.mean).astype(np.float32) for k, s in self.samples.items()}
        np.savez_compressed(file, count=self.count, problems=self.problems, **table, **{f"share:{k}": v for k, v in self.shares.items()})

    @staticmethod
    def read(file):
        kept = dict(np.load(file))
        names = [k[len("sample:"):] for k in kept if k.startswith("sample:")]
        samples = {k: Sample(*kept["sample:" + k], kept["sample:" + k][1] + kept["quantiles:" + k].astype(float)) for k in names}
        return Run(int(kept["count"]), samples, {k[len("share:"):]: v for k, v in kept.items() if k.startswith("share:")}, kept["problems"])


def keep(arguments):
    for site in SITES:
        for mode, steps in STEPS.items():
            for step in steps:
                shards = sorted((Path(arguments.work) / site / mode / name_of(step)).glob("*.npz"))
                if SHARD * len(shards) >= arguments.count:
                    Run.of_shards(shards).write(RESULTS / site / mode / f"{name_of(step)}.npz")
                    print(f"{site}, {mode}, {name_of(step)}: {SHARD * len(shards)} blocks")


def ks_distance(a, b):
    both = np.concatenate([a.quantiles, b.quantiles])
    return np.abs(a.below(both) - b.below(both)).max()


def compare(a, b):
    """Per observable: shift from a to b in standard deviations of b, its standard error, KS distance over its 1 % limit. Shares: in standard errors."""
    rows = {}
    for key in b.samples:
        x, y = a.samples[key], b.samples[key]
        error = math.sqrt(1.0 / x.size + 1.0 / y.size)
        rows[key] = ((y.mean - x.mean) / y.sd, error, ks_distance(x, y) / (KS_LIMIT * error))
    for key in b.shares:
        p, q = (r.shares[key][0] / r.shares[key][1] for r in (a, b))
        pooled = (a.shares[key][0] + b.shares[key][0]) / (a.shares[key][1] + b.shares[key][1])
        error = math.sqrt(pooled * (1.0 - pooled) * (1.0 / a.shares[key][1] + 1.0 / b.shares[key][1]))
        rows["share " + key] = (100.0 * (q - p), 100.0 * error, abs(q - p) / error / 2.576 if error > 0.0 else 0.0)
    return rows


def print_means(site, mode, runs):
    print(f"\n### {site}, {mode}: means (standard error)\n")
    keys = [(k, False) for k in runs[-1][1].samples] + [(k, True) for k in runs[-1][1].shares]
    print("| | " + " | ".join(f"{name_of(h)}, n = {r.count}" for h, r in runs) + " |")
    print("|---" * (len(runs) + 1) + "|")
    for key, share in keys:
        cells = []
        for _, r in runs:
            if share:
                k, n = r.shares[key]
                cells.append(f"{100.0 * k / n:.2f} ({100.0 * math.sqrt(max(k, 1) * (n - k) / n) / n:.2f})")
            else:
                v = r.samples[key]
                origin = math.floor(runs[-1][1].samples[key].mean / 1000.0) * 1000.0 if key.startswith("stop") else 0.0
                cells.append(f"{v.mean - origin:.3f} ({v.sd / math.sqrt(v.size):.3f})")
        print(f"| {'stops in ' + key + ' [%]' if share else key} | " + " | ".join(cells) + " |")


def print_comparison(title, pairs):
    """Each cell: shift in standard deviations (shares: points of percent), and KS distance (shares: |z| / 2.576) as a multiple of its 1 % limit."""
    print(f"\n### {title}: shift in SD (shares: %), and distance over its 1 % limit\n")
    print("| | " + " | ".join(label for label, _, _ in pairs) + " |")
    print("|---" * (len(pairs) + 1) + "|")
    compared = [compare(a, b) for _, a, b in pairs]
    for key in compared[0]:
        print(f"| {key} | " + " | ".join(f"{c[key][0]:+.3f} +- {c[key][1]:.3f}; {c[key][2]:.2f}" for c in compared) + " |")


def table(arguments):
    series = {}
    for site in SITES:
        for mode, steps in STEPS.items():
            files = [(h, RESULTS / site / mode / f"{name_of(h)}.npz") for h in steps]
            runs = [(h, Run.read(f)) for h, f in files if f.exists()]
            if not runs:
                continue
            series[site, mode] = runs
            print_means(site, mode, runs)
            if len(runs) > 1:
                print_comparison(f"{site}, {mode}", [(f"{name_of(a[0])} to {name_of(b[0])}", a[1], b[1]) for a, b in zip(runs, runs[1:])])
            print("\ncontact problems above the tolerance: " + ", ".join(f"{name_of(h)} {r.problems[0]} of {r.problems[1]}" for h, r in runs))
        if (site, "event") in series and (site, "moreau_jean") in series:
            finest = series[site, "event"][-1]
            print_comparison(f"{site}: moreau_jean against event at {name_of(finest[0])}",
                             [(f"moreau_jean {name_of(h)}", r, finest[1]) for h, r in series[site, "moreau_jean"]])
    if arguments.plot:
        Path(arguments.plot).write_text(plot(series))


PLOTTED = ["stop x [m]", "ES1-A speed [m/s]", "ES2-A speed [m/s]", "ES2-A spin [rad/s]"]
STYLE = {("smooth", "event"): ("#1b6ca8", ""), ("smooth", "moreau_jean"): ("#d1495b", ""), ("rough", "event"): ("#1b6ca8", "5 4"),
         ("rough", "moreau_jean"): ("#d1495b", "5 4")}


def plot(series):
    """Means against the step, with two standard errors: one panel an observable. Differences from the finest event run of the site."""
    width, height, left, top = 360, 250, 62, 46
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * width}" height="{2 * height + 40}" font-family="sans-serif" font-size="12">',
             f'<rect width="{2 * width}" height="{2 * height + 40}" fill="white"/>']
    steps = sorted({step for runs in series.values() for step, _ in runs}, reverse=True)
    for k, key in enumerate(PLOTTED):
        x0, y0 = (k % 2) * width + left, (k // 2) * height + top
        w, h = width - left - 18, height - top - 44
        lines = {}
        for (site, mode), runs in series.items():
            if (site, "event") not in series:
                continue
            base = series[site, "event"][-1][1].samples[key]
            lines[site, mode] = [(step, (r.samples[key].mean - base.mean) / base.sd, 2.0 * r.samples[key].sd / base.sd / math.sqrt(r.samples[key].size))
                                 for step, r in runs]
        every = [v + s * e for points in lines.values() for _, v, e in points for s in (-1, 1)] + [-0.05, 0.05]
        low, high = min(every), max(every)
        low, high = low - 0.05 * (high - low), high + 0.05 * (high - low)

        def px(step):
            return x0 + w * (math.log2(step / steps[-1]) + 0.3) / (math.log2(steps[0] / steps[-1]) + 0.6)

        def py(value):
            return y0 + h * (high - value) / (high - low)
        parts.append(f'<text x="{x0}" y="{y0 - 10}" font-weight="bold">{key.split(" [")[0]}: mean, shift in SD</text>')
        parts.append(f'<rect x="{x0}" y="{py(0.05):.1f}" width="{w}" height="{py(-0.05) - py(0.05):.1f}" fill="#eee"/>')
        parts.append(f'<rect x="{x0}" y="{y0}" width="{w}" height="{h}" fill="none" stroke="#999"/>')
        spacing = next(s for s in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0) if (high - low) / s <= 6.0)
        for j in range(math.ceil(low / spacing), math.floor(high / spacing) + 1):
            y = py(j * spacing)
            parts.append(f'<text x="{x0 - 6}" y="{y + 4:.1f}" text-anchor="end">{j * spacing:.2f}</text><line x1="{x0}" x2="{x0 + w}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>')
        for step in steps:
            parts.append(f'<text x="{px(step):.1f}" y="{y0 + h + 16}" text-anchor="middle">{step * 1e3:g}</text>')
        parts.append(f'<text x="{x0 + w / 2}" y="{y0 + h + 32}" text-anchor="middle">time step [ms]</text>')
        for (site, mode), points in lines.items():
            colour, dash = STYLE[site, mode]
            path = " ".join(f"{px(s):.1f},{py(v):.1f}" for s, v, _ in points)
            parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dash}"/>')
            for s, v, e in points:
                parts.append(f'<line x1="{px(s):.1f}" x2="{px(s):.1f}" y1="{py(v - e):.1f}" y2="{py(v + e):.1f}" stroke="{colour}"/>'
                             f'<circle cx="{px(s):.1f}" cy="{py(v):.1f}" r="2.5" fill="{colour}"/>')
    for j, ((site, mode), (colour, dash)) in enumerate((run, style) for run, style in STYLE.items() if run in series):
        x = 30 + 174 * j
        y = 2 * height + 22
        parts.append(f'<line x1="{x}" x2="{x + 24}" y1="{y}" y2="{y}" stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dash}"/><text x="{x + 30}" y="{y + 4}">{mode}, {site}</text>')
    return "\n".join(parts + ["</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    runner = commands.add_parser("run", help="throw blocks")
    runner.add_argument("--scree", required=True)
    runner.add_argument("--work", required=True)
    runner.add_argument("--count", type=int, default=100000, help="blocks of every run")
    runner.add_argument("--threads", type=int, default=0)
    runner.add_argument("--only", nargs="*", help="runs such as smooth/event/4ms")
    keeper = commands.add_parser("keep", help="write the distributions of whole runs to results/convergence")
    keeper.add_argument("--work", required=True)
    keeper.add_argument("--count", type=int, default=100000, help="blocks of a whole run")
    writer = commands.add_parser("table", help="print the tables, draw the plot")
    writer.add_argument("--plot", help="SVG file")
    arguments = parser.parse_args()
    {"run": run, "keep": keep, "table": table}[arguments.command](arguments)


if __name__ == "__main__":
    main()
