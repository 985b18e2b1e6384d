#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the profiles of Scree with the flow paths of GRASS GIS on real terrain.

Usage: compare_drain.py --scree PROGRAM [SITE ...] [--spacing CELLS] [--keep DIR]      (default: tyrol_wog, vaujany)

Needs grass (Debian: grass-core), numpy and GDAL's Python module. Starting points lie on a lattice of cell centres on ground steeper than
LEAST_SLOPE. Three pairs of lines from each of them:

  drain   r.drain, steepest of 8 neighbours, until the first pit     against   the bare steepest line (no average, no rules), until its first pit
  flow    r.flow, along the interpolated gradient, until it stops    against   the same
  path    r.watershed and r.path: 8 directions, through pits         against   the line with the rules of the default settings

For each pair: how far the points of Scree's line lie from the other one, as far down as both go, and how much longer the other line is
for the same fall. Exit code: 0 done, 1 something failed, 77 skipped because GRASS, the shared data or a Python module is absent.
"""
import argparse
import csv
import math
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from sites import PREFIX, SKIPPED, gdal, np, ogr, path_changes, shared_folder, site_file

from osgeo import osr  # after sites, which skips where it is absent

LEAST_SLOPE = 25.0  # [degree] of a starting point
MARGIN = 4          # [cells] of valid ground around a starting point
SHORTEST = 20.0     # [m] of common fall below which a pair is not compared
BARE = ["smoothing=0", "gentle_slope_deg=0", "highest_rise=0", "run_up=0", "head=0", "longest=100000"]
RULES = ["head=0", "run_up=0", "longest=100000"]

GRASS = """
set -e
export GRASS_VERBOSE=0 GRASS_OVERWRITE=1
r.in.gdal -o input={dtm} output=dtm
g.region raster=dtm
v.in.ogr -o input={starts} output=starts
r.drain input=dtm output=drained drain=drain start_points=starts
v.out.ogr input=drain output={folder}/drain.gpkg type=line format=GPKG
r.flow elevation=dtm flowline=flow skip={skip}
v.out.ogr -c input=flow output={folder}/flow.gpkg type=line format=GPKG
r.watershed -s elevation=dtm drainage=direction threshold=1000
r.mapcalc "angle = if(direction == 0, null(), 45.0 * abs(direction))"
r.path input=angle format=degree vector_path=path start_points=starts
v.out.ogr input=path output={folder}/path.gpkg type=line format=GPKG
"""


class Terrain:
    def __init__(self, file):
        raster = gdal.Open(str(file))
        self.file, self.wkt = file, raster.GetProjection()
        self.x0, self.cell, _, self.y0, _, self.dy = raster.GetGeoTransform()
        band = raster.GetRasterBand(1)
        self.z = band.ReadAsArray().astype(float)
        self.z[self.z == band.GetNoDataValue()] = math.nan

    def centre(self, row, column):
        return self.x0 + (column + 0.5) * self.cell, self.y0 + (row + 0.5) * self.dy

    def at(self, points):
        """Heights at points by bilinear interpolation between centres."""
        u = (points[:, 0] - self.x0) / self.cell - 0.5
        v = (points[:, 1] - self.y0) / self.dy - 0.5
        i = np.clip(np.floor(u).astype(int), 0, self.z.shape[1] - 2)
        j = np.clip(np.floor(v).astype(int), 0, self.z.shape[0] - 2)
        u, v = u - i, v - j
        z = self.z
        return (1 - v) * ((1 - u) * z[j, i] + u * z[j, i + 1]) + v * ((1 - u) * z[j + 1, i] + u * z[j + 1, i + 1])

    def starts(self, spacing):
        gy, gx = np.gradient(self.z, abs(self.dy), self.cell)
        slope = np.degrees(np.arctan(np.hypot(gx, gy)))
        # r.flow begins at every spacing-th row and column, counted from the first
        for row in range(0, self.z.shape[0], spacing):
            for column in range(0, self.z.shape[1], spacing):
                around = self.z[max(0, row - MARGIN):row + MARGIN + 1, max(0, column - MARGIN):column + MARGIN + 1]
                whole = around.shape == (2 * MARGIN + 1, 2 * MARGIN + 1) and np.isfinite(around).all()
                if whole and slope[row, column] >= LEAST_SLOPE:
                    yield self.centre(row, column)


def write_points(file, points, wkt):
    source = ogr.GetDriverByName("GPKG").CreateDataSource(str(file))
    layer = source.CreateLayer("starts", osr.SpatialReference(wkt), ogr.wkbPoint)
    for x, y in points:
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetGeometry(ogr.CreateGeometryFromWkt(f"POINT ({x!r} {y!r})"))
        layer.CreateFeature(feature)


def run_grass(terrain, starts, spacing, folder):
    script = GRASS.format(dtm=terrain.file, starts=starts, folder=folder, skip=spacing)
    done = subprocess.run(["grass", "--tmp-location", str(terrain.file), "--exec", "bash", "-c", script], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"FAILED: GRASS said: {(done.stdout + done.stderr).strip()[-2000:]}")


def grass_lines(file, points, cell):
    """Lines by the starting point that they begin (or end) at."""
    key = lambda x, y: (round(20 * x / cell), round(20 * y / cell))
    near = {}
    source = ogr.Open(str(file))
    for feature in source.GetLayer(0):
        line = np.array(feature.GetGeometryRef().GetPoints())[:, :2]
        for way in (line, line[::-1]):
            near.setdefault(key(*way[0]), []).append(way)
    return {p: near.get(key(*p), []) for p in points}


def scree_lines(program, site, terrain, starts, settings, folder):
    command = [program, "profile", str(site_file(site)), *path_changes(site), "--set", f"profile.start={starts}", "--set", "terrain.resolution=0",
               "--set", "profile.pictures=0", "--output", str(folder), "--overwrite", "--quiet"]
    for setting in settings:
        command += ["--set", f"profile.{setting}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"FAILED: {site}: scree ended with {done.returncode}: {done.stderr.strip()}")
    lines = {}
    with open(Path(folder) / "profiles.csv") as file:
        for row in csv.DictReader(file):
            lines.setdefault(row["profile"], []).append((float(row["easting_m"]), float(row["northing_m"])))
    return [np.array(line) for line in lines.values()]


def length_of(line):
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def down_to(line, heights, level):
    """The part of a line above a height."""
    below = np.nonzero(heights < level)[0]
    return line[:max(2, below[0])] if len(below) else line


def distances(points, line):
    """Of points from a polyline."""
    a, along = line[:-1], np.diff(line, axis=0)
    size = np.maximum((along ** 2).sum(axis=1), 1e-12)
    best = np.full(len(points), math.inf)
    for k in range(len(a)):
        u = np.clip(((points - a[k]) @ along[k]) / size[k], 0, 1)
        best = np.minimum(best, np.hypot(*(points - a[k] - u[:, None] * along[k]).T))
    return best


def spaced(line, step):
    s = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.arange(0, s[-1], step)
    return np.column_stack([np.interp(at, s, line[:, 0]), np.interp(at, s, line[:, 1])])


def compare(terrain, ours, theirs):
    """Distances of our points from their line, ratio of the lengths and the fall, for one starting point; None if too short."""
    z_ours, z_theirs = terrain.at(ours), terrain.at(theirs)
    level = max(np.nanmin(z_ours), np.nanmin(z_theirs))
    fall = z_ours[0] - level
    if not fall >= SHORTEST:
        return None
    a, b = down_to(ours, z_ours, level), down_to(theirs, z_theirs, level)
    if len(b) < 2 or len(a) < 2:
        return None
    return distances(spaced(a, terrain.cell), b), length_of(b) / length_of(a), fall


def report(site, terrain, name, ours, theirs):
    by_start = {(round(line[0, 0], 3), round(line[0, 1], 3)): line for line in ours}
    all_distances, ratios, falls, apart = [], [], [], 0
    for start, candidates in theirs.items():
        line = by_start.get((round(start[0], 3), round(start[1], 3)))
        if line is None or not candidates:
            continue
        pair = compare(terrain, line, max(candidates, key=length_of))
        if pair is None:
            continue
        all_distances.append(pair[0])
        ratios.append(pair[1])
        falls.append(pair[2])
        apart += pair[0][-1] > 5 * terrain.cell
    if not ratios:
        sys.exit(f"FAILED: {site}: no line to compare with {name}")
    d = np.concatenate(all_distances) / terrain.cell
    print(f"{site} {name}: {len(ratios)} pairs, {len(d)} points; mean fall {np.mean(falls):.0f} m; distance in cells: median {np.median(d):.2f}, "
          f"mean {d.mean():.2f}, 90 % {np.quantile(d, 0.9):.2f}, 95 % {np.quantile(d, 0.95):.1f}, largest {d.max():.0f}; within 1 cell {100 * (d <= 1).mean():.0f} %, "
          f"2 cells {100 * (d <= 2).mean():.0f} %, 5 cells {100 * (d <= 5).mean():.0f} %; {apart} end more than 5 cells apart; "
          f"their length / ours, median {np.median(ratios):.3f}")
    return d


def run(site, arguments, folder):
    dtm = tomllib.loads(site_file(site).read_text())["terrain"]["dtm"]
    path_changes(site)  # skips where the data are absent
    terrain = Terrain(shared_folder() / dtm[len(PREFIX):])
    points = list(terrain.starts(arguments.spacing))
    folder.mkdir(parents=True, exist_ok=True)
    starts = folder / "starts.gpkg"
    starts.unlink(missing_ok=True)
    write_points(starts, points, terrain.wkt)
    run_grass(terrain, starts, arguments.spacing, folder)
    bare = scree_lines(arguments.scree, site, terrain, starts, BARE, folder / "bare")
    rules = scree_lines(arguments.scree, site, terrain, starts, RULES, folder / "rules")
    for name, ours in (("drain", bare), ("flow", bare), ("path", rules)):
        report(site, terrain, name, ours, grass_lines(folder / f"{name}.gpkg", points, terrain.cell))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sites", nargs="*", metavar="SITE", default=["tyrol_wog", "vaujany"])
    parser.add_argument("--scree", required=True, help="the program")
    parser.add_argument("--spacing", type=int, default=12, help="of the starting points, in cells")
    parser.add_argument("--keep", help="folder for the lines; without it they are thrown away")
    arguments = parser.parse_args()
    if not shutil.which("grass"):
        print("skipped: grass is not installed (Debian: apt-get install grass-core)")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as scratch:
        for site in arguments.sites:
            run(site, arguments, Path(arguments.keep or scratch) / site)


main()
