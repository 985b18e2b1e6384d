#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The programme of Bourrier & Acary (2022) on the real quarry of Authume, profile P1: 41 measured stops.

Usage: programme.py SCREE [--output DIR] [--sets N] [--threads N]
       programme.py SCREE --check [--threads N]

1. Calibrates in 2D with one, two and three kinds of ground, with the release height known only to lie between 2 and 8.5 m, and takes the
   simplest that predicts held-out blocks as well as the best, within the standard error of their difference over the folds.
2. Calibrates the same keys in 3D.
3. Compares before and after in 2D and in 3D, each with both calibrations, with 40 repeats of every block.
4. Scatter, shapes and influence of the parameters as on the synthetic quarries (sample_sites/quarry_study).

--check only sees that the frozen sites are those that were frozen, and compares them with the measurements, with a few repeats: a change of the model that spoils them shows.
Steps whose results are in DIR are not run again. Writes DIR/report.html and the calibrated sites DIR/site_2d.toml and DIR/site_3d.toml as they would be
frozen beside this file, and says whether they have the bytes of those that are; what is frozen is not touched. The data are found by SCREE_SHARED_DATA; without them: exit code 77.
"""
import argparse
import hashlib
import re
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[2]
sys.path[:0] = [str(HERE.parent), str(PROJECT / "sample_sites" / "quarry_study")]

import observations  # noqa: E402
from sites import PREFIX, features, np, path_changes, run_site, site_file  # noqa: E402
from study import Study, calibrated_changes, frees, gap_of, influences, read, sets, write_report  # noqa: E402

RANGES = {"restitution": "0:0.5", "friction": "0.3:0.9", "rolling": "0.002:0.3:log"}
GROUNDS = {  # kinds of ground: the authors' zones blue (vegetated slope), gray (hard rock, floor), red (rocky slope)
    "one ground": ["soil.*"],
    "slope and rock": ["soil.blue", "soil.gray|red"],
    "three grounds": ["soil.blue", "soil.gray", "soil.red"],
}
HEIGHT = "release.height=2:8.5"  # the authors' drop points lie 4.2 to 8.2 m over the DTM, the shovel's height above ground is not known
SCREENS = ["S1_cliff_top", "S2_bench1", "S3_below_cliff2", "S4_quarry_floor"]
MEASURED = [0.976, 0.951, 0.415, 0.122]
REPEATS = sets("observed.repeats=40")
SEARCH = sets("calibration.starts=4", "calibration.generations=16")


def keys(ground):
    return [f"{soil}.{name}={limits}" for soil in GROUNDS[ground] for name, limits in RANGES.items()] + [HEIGHT]


def simplest(fits):
    """The first whose loss of held-out blocks exceeds the least by no more than its standard error (Breiman et al. 1984: the one-standard-error rule)."""
    losses = {name: np.array([f["test"]["loss"] for f in read(folder, "calibrate.json")["folds"]]) for name, folder in fits.items()}
    best = min(losses.values(), key=np.mean)

    def as_good(of):
        more = of - best
        return more.mean() <= more.std(ddof=1) / np.sqrt(len(more))
    return next(name for name, of in losses.items() if as_good(of))


def observable(folder, name):
    return next(o for o in read(folder, "compare.json")["observables"] if o["name"] == name)


def runout(folder):
    """'mean distance (95 % of sampling)' of the runout distributions."""
    w = observable(folder, "runout")["wasserstein"]
    return f"{w['distance']:.1f} ({w['distance_95'][0]:.1f} to {w['distance_95'][1]:.1f})"


def passing(folder):
    """Shares stopped beyond the screens, simulated."""
    shares = {s["name"]: s["simulated"]["share"] for s in read(folder, "compare.json")["stopped_beyond_screens"]}
    return [shares[name] for name in SCREENS]


def freeze(calibrated, out, name):
    """Writes the calibrated site to `out`, with the paths of the data as the frozen one beside this file has them; returns what the two have in common."""
    text = (calibrated / "calibrated.toml").read_text()
    text = re.sub(r"'[^']*/(data/authume_P1/[^']*)'", rf"'{PREFIX[3:]}\1'", text)
    (out / name).write_text(text)
    same = (out / name).read_bytes() == (HERE / name).read_bytes()
    return f"{name}: {'the same bytes as' if same else 'other bytes than'} the frozen one"


def speeds(study, name, changes):
    """Speeds at the cliff top of 1000 blocks: least, 5, 50, 95 %, largest [m/s]."""
    folder = study.out / name
    if not (folder / "SHA256SUMS").exists():
        code, said = run_site(study.scree, "authume_P1", folder, 1000, study.threads, changes)
        if code:
            sys.exit(said)
    v = [f["speed_ms"] for f in features(folder, "screen_crossings") if f["screen"] == SCREENS[0]]
    return np.quantile(v, [0, 0.05, 0.5, 0.95, 1])


def steps(study, count):
    rows, fits = [], {}
    for ground in GROUNDS:
        fits[ground] = study.run("calibrated_2d_" + ground.replace(" ", "_"), "calibrate", "p1", *sets("model.dimension=2"), *SEARCH, *frees(*keys(ground)))
    losses = {ground: read(folder, "calibrate.json")["fit_held_out"]["loss"] for ground, folder in fits.items()}
    best = simplest(fits)
    calibrated = {2: fits[best], 3: study.run("calibrated_3d", "calibrate", "p1", *sets("model.dimension=3"), *SEARCH, *frees(*keys(best)))}
    frozen = "; ".join(freeze(folder, study.out, f"site_{d}d.toml") for d, folder in calibrated.items())
    changes = {"before": [], **{f"{d}D": sets(*calibrated_changes(folder)) for d, folder in calibrated.items()}}

    lines = [f"Score of held-out blocks [m]: " + ", ".join(f"{k} {v:.2f}" for k, v in losses.items()) + f"; taken: {best}.", f"{frozen}."]
    gaps, shares, beyond = {}, {}, {}
    for name, values in changes.items():
        for d in (2, 3):
            folder = study.run(f"compare_{name.lower()}_in_{d}d", "compare", "p1", *sets(f"model.dimension={d}"), *values, *REPEATS)
            gaps[name, d] = folder
            shares[name, d] = passing(folder)
            fastest = speeds(study, f"run_{name.lower()}_in_{d}d", [*sets(f"model.dimension={d}"), *values])
            beyond[name, d] = fastest
            lines.append(f"Calibrated {name if name != 'before' else 'nowhere'}, simulated in {d}D: W1 of runout {runout(folder)} m, overall gap {gap_of(folder)}; passing "
                         + ", ".join(f"{v:.3f}" for v in shares[name, d])
                         + f"; stops above S1 {100 * (1 - shares[name, d][0]):.1f} %, S1 to S2 {100 * (shares[name, d][0] - shares[name, d][1]):.1f} %; speeds at S1 "
                         + " / ".join(f"{v:.1f}" for v in fastest) + " m/s (least, 5, 50, 95 %, largest).")
            study.add(f"Calibrated {name if name != 'before' else 'nowhere'}, simulated in {d}D", lines[-1],
                      folder / "figures" / "overview.svg", folder / "figures" / "map.svg")
    floor = observable(gaps["before", 2], "runout")["wasserstein"]
    lines.append(f"Noise floor of W1: median {floor['resampled_median']:.1f}, 95 % {floor['resampled_p95']:.1f} m; chance of 41 simulated blocks {floor['chance_median']:.1f}, "
                 f"{floor['chance_p95']:.1f} m; another code 24.8 m. Measured passing " + ", ".join(f"{v:.3f}" for v in MEASURED) + ".")
    for d, folder in calibrated.items():
        study.add(f"Calibration in {d}D", "", folder / "figures" / "parameters.svg", folder / "figures" / "pairs.svg")
    print("\n".join(lines))
    (study.out / "summary.txt").write_text("\n".join(lines) + "\n")

    w = {key: observable(folder, "runout")["wasserstein"]["distance"] for key, folder in gaps.items()}
    rows.append(("Parameters calibrated in 2D match in 3D as well", "yes, slightly better in 3D",
                 f"W1 of runout {w['2D', 2]:.1f} m in 2D, {w['2D', 3]:.1f} m in 3D", w["2D", 3] <= max(w["2D", 2], floor["resampled_p95"])))
    rows.append(("Too many stops on the upper slope remain", "yes: more than 2 %", f"{100 * (1 - shares['2D', 2][0]):.1f} % in 2D, {100 * (1 - shares['3D', 3][0]):.1f} % in 3D",
                 1 - shares["2D", 2][0] > 0.05))
    rows.append(("Too few slow blocks at ES1-A remain", "yes; measured 0 to 7.5 m/s",
                 f"5 % slower than {beyond['2D', 2][1]:.1f} m/s in 2D, {beyond['3D', 3][1]:.1f} m/s in 3D", beyond["2D", 2][1] > 2.0))
    return rows + influences(study, "p1", 2, count)


LARGEST = 6.0  # [m] W1 of runout of a frozen site: 2.1 to 4.3 m, 22.8 and 15.0 m before calibration
FROZEN = {  # sha256. Held out: what these files predict of a path is fixed before its measurements are opened; do not edit them
    "site_2d": "b7d9ef9bb17bc5f3bee405cf2e9c387b9ac24fb060fb88e36ab6042fd8ec64fe",
    "site_3d": "32ca713eef9e15d0ecfeae5434e2b38ceaf944f67057f4f9ca2c920bc22bf5f5",
    "site_extended_2d": "ff41a567f2f4c886d7152ba4b02fe52fd5a7e50b10ea1c5ae7fb87323ba0c563",
    "site_extended_3d": "d72c0be37f19b18d87b3bd1a2c2eca11d32cde6a1bb07eb2c41716f1fcb2dd7d",
}


def check(args):
    for name, frozen in FROZEN.items():
        found = hashlib.sha256((HERE / f"{name}.toml").read_bytes()).hexdigest()
        if found != frozen:
            sys.exit(f"{name}.toml is not the one that was frozen: its sha256 is {found}, and that of the frozen one {frozen}")
    with tempfile.TemporaryDirectory() as folder:
        observations.convert("authume_P1", Path(folder) / "observed")
        for name in FROZEN:  # the extended ones by ../diagnose_sites.py
            study = Study(args.scree, folder, {"frozen": (HERE / f"{name}.toml", Path(folder) / "observed", path_changes("authume_P1"))}, args.threads)
            distance = observable(study.run(name, "compare", "frozen", *sets("observed.repeats=10")), "runout")["wasserstein"]["distance"]
            print(f"{name}: W1 of runout {distance:.2f} m")
            if not distance < LARGEST:
                sys.exit(f"more than {LARGEST} m")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("--output", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--sets", type=int, default=20, help="sets of 41 blocks per value of a sweep (default 20)")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    if args.check:
        check(args)
        return
    if args.output.resolve() == HERE:
        parser.error("--output: the frozen sites lie there, take another folder")
    changes = path_changes("authume_P1")
    args.output.mkdir(parents=True, exist_ok=True)
    observations.convert("authume_P1", args.output / "observed")
    study = Study(args.scree, args.output, {"p1": (site_file("authume_P1"), args.output / "observed", changes)}, args.threads)
    rows = steps(study, args.sets)
    write_report(study, rows, "The paper's programme on the quarry of Authume, profile P1",
                 "Stops are measured; speeds, heights and the height of release are not. The paper's figures are those of its text, for path A.")


if __name__ == "__main__":
    main()
