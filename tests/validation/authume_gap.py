#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The gap between simulated and measured stopping places at Authume P1, with what chance alone would give.

Usage: authume_gap.py RESULTS      (RESULTS: folder that scree run wrote; the data are found by SCREE_SHARED_DATA)

Both sides pass the same operator: east and north of the stop only (the survey's heights have another datum), runout from the centre of the drop
box, passing judged by where a block stopped. Blocks that left the terrain or still moved count at the place where they were last seen: they
had run at least that far. Intervals are 95 %, by resampling the blocks; those of measured shares are Wilson's.
"""
import json
import sys

from sites import SKIPPED, features, np, ogr, run_table, shared_folder

DATA = shared_folder() / "data" / "authume_P1"
QUANTILES = (5, 10, 25, 50, 75, 90, 95)
DRAWS = 2000
SEED = 1


def w1(a, b):
    """Mean distance between the quantile functions of two samples [m]."""
    grid = np.sort(np.concatenate([a, b]))
    share_a = np.searchsorted(np.sort(a), grid[:-1], side="right") / len(a)
    share_b = np.searchsorted(np.sort(b), grid[:-1], side="right") / len(b)
    return float(np.sum(np.abs(share_a - share_b) * np.diff(grid)))


def interval(values):
    low, high = np.percentile(values, [2.5, 97.5])
    return f"{low:.1f} to {high:.1f}"


def wilson(k, n):
    z, p = 1.96, k / n
    centre, half = (p + z * z / (2 * n)) / (1 + z * z / n), z * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return f"{centre - half:.3f} to {centre + half:.3f}"


def drop_box_centre():
    source = ogr.Open(str(DATA / "release.gpkg"))
    for feature in source.GetLayerByName("release_area"):
        x0, x1, y0, y1 = feature.GetGeometryRef().GetEnvelope()
        return np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)])


def screens():
    source = ogr.Open(str(DATA / "screens.gpkg"))
    return {f["screen"]: f.GetGeometryRef().GetX(0) for f in source.GetLayerByName("screens")}


def observed():
    source = ogr.Open(str(DATA / "stops.gpkg"))
    return np.array([[f["E"], f["N"]] for f in source.GetLayerByName("stops")])


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        sys.exit(2)
    if not DATA.exists():
        print("skipped: shared data not found: data/authume_P1")
        sys.exit(SKIPPED)
    random = np.random.Generator(np.random.PCG64(SEED))
    box = drop_box_centre()
    stops = features(sys.argv[1], "stopping_points")
    simulated = np.array([s["xyz"][0][:2] for s in stops if s["stop_reason"] != "failed"])
    measured = observed()
    n, m = len(simulated), len(measured)
    resample_s = [random.integers(0, n, n) for _ in range(DRAWS)]
    resample_m = [random.integers(0, m, m) for _ in range(DRAWS)]
    run = run_table(sys.argv[1])
    print(f"{run['program']}, seed {run['seed']}: {n} blocks thrown, {m} measured; " +
          ", ".join(f"{value} {key[len('ended_'):]}" for key, value in run.items() if key.startswith("ended_")))

    print("\n| observable | measured | simulated | 95 % of sampling, simulated |\n|---|---|---|---|")
    runout_s, runout_m = (np.linalg.norm(p - box, axis=1) for p in (simulated, measured))
    lateral_s, lateral_m = simulated[:, 1] - box[1], measured[:, 1] - box[1]
    for name, a, b in (("runout", runout_s, runout_m), ("lateral (north)", lateral_s, lateral_m)):
        for q in QUANTILES:
            draws = [np.percentile(a[k], q) for k in resample_s[:500]]
            print(f"| {name}, {q} % [m] | {np.percentile(b, q):.1f} | {np.percentile(a, q):.1f} | {interval(draws)} |")
        print(f"| {name}, mean [m] | {b.mean():.1f} | {a.mean():.1f} | {interval([a[k].mean() for k in resample_s])} |")
        print(f"| {name}, standard deviation [m] | {b.std(ddof=1):.1f} | {a.std(ddof=1):.1f} | {interval([a[k].std(ddof=1) for k in resample_s])} |")

    print("\n| stopped beyond screen | measured (95 % interval) | simulated (95 % interval) |\n|---|---|---|")
    for name, x in screens().items():
        k_s, k_m = int((simulated[:, 0] > x).sum()), int((measured[:, 0] > x).sum())
        print(f"| {name} | {k_m / m:.3f} ({wilson(k_m, m)}) | {k_s / n:.3f} ({wilson(k_s, n)}) |")

    print("\n| distance of the distributions (W1) [m] | simulated to measured | 95 % of sampling, both sides | measured to a resample of itself, median / 95 % |")
    print("|---|---|---|---|")
    for name, a, b in (("runout", runout_s, runout_m), ("lateral", lateral_s, lateral_m)):
        draws = [w1(a[i], b[j]) for i, j in zip(resample_s, resample_m)]
        floor = [w1(b[j], b) for j in resample_m]
        print(f"| {name} | {w1(a, b):.1f} | {interval(draws)} | {np.median(floor):.1f} / {np.percentile(floor, 95):.1f} |")
    baseline = json.loads((DATA / "observed_metrics.json").read_text())["rockable_DEM_baseline"]["W1_to_measured_m"]["all"]
    print(f"\nThe DEM of the authors of the data: {baseline} m in runout.")


main()
