#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the data of the synthetic site quarry_a: terrain, soils, release area, screens, deposit zones, blocks.

Usage: generate.py [--output DIR]     (default: data/ beside this file; existing files of the site are replaced)

The terrain is a few smooth surfaces (slope of waste, rock cuts, track, platform) joined by rounded edges, plus
roughness that is correlated over a metre or two. Two frames: local (x east, y north, origin at the south-west corner
of the model) and path (s down the path from the centre of the release area, t across it, positive to the left).
"""
import argparse
import csv
import math
import os
from pathlib import Path

os.environ["OGR_CURRENT_DATE"] = "2024-01-01T00:00:00.000Z"  # the date that GeoPackages carry: the same bytes every time

import numpy as np  # noqa: E402
from osgeo import gdal, ogr, osr  # noqa: E402

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()

SEED = 20220155        # any number would do; RandomState's stream is frozen by numpy's compatibility promise
EPSG = 2154            # RGF93 / Lambert-93 [m]
EAST, NORTH = 890000.0, 6670000.0   # south-west corner [m]: round numbers, no quarry looks like this there
LENGTH, WIDTH = 160.0, 80.0         # extent to the east and to the north [m]
CELL = 0.2                          # the paper's photogrammetric model [m]
HEIGHT_STEP = 1.0 / 1024.0          # heights are rounded to this [m]: a millimetre, but exact in binary, so it packs well

RELEASE_X, RELEASE_Y = 22.0, 45.0   # centre of the release area, local [m]
RELEASE_SIDE = 4.0                  # [m]
BEARING_SOUTH_OF_EAST = math.radians(7.0)  # the path is not aligned with the grid, as in nature

RELEASE_HEIGHT = 265.0              # ground at the release centre [m]
DUMP_EDGE = -5.0                    # s of the edge of the tipping plateau [m]
SLOPE_TOP, SLOPE_END = math.tan(math.radians(38.0)), math.tan(math.radians(36.2))  # slope of waste at s = 0, UPPER_LENGTH
UPPER_LENGTH = 36.0                 # s of the first crest on the axis [m]
CUT_1_TOE, CUT_1_DIP = 38.4, math.tan(math.radians(76.0))   # s [m], slope [-]
TRACK_HEIGHT = 228.6                # at the axis [m]
CUT_2_TOE, CUT_2_DIP = 49.4, math.tan(math.radians(75.0))
PLATFORM_HEIGHT = 220.0             # at the foot of the second cut [m]
PLATFORM_FALL = 0.01                # falls outwards so that it drains [-]

MARGIN_WITHOUT_SOIL = 2.0           # western strip that no soil polygon covers: it takes the default soil [m]
LINE_STEP = 2.0                     # distance between the vertices of crest lines [m]


# ---- frames and shapes -----------------------------------------------------------------------------------------------

def to_path(x, y):
    c, s = math.cos(BEARING_SOUTH_OF_EAST), math.sin(BEARING_SOUTH_OF_EAST)
    return (x - RELEASE_X) * c - (y - RELEASE_Y) * s, (x - RELEASE_X) * s + (y - RELEASE_Y) * c


def to_local(s, t):
    c, n = math.cos(BEARING_SOUTH_OF_EAST), math.sin(BEARING_SOUTH_OF_EAST)
    return RELEASE_X + s * c + t * n, RELEASE_Y - s * n + t * c


def rounded_min(a, b, k):
    """The lower of two surfaces; where they differ by less than k [m] the edge between them is rounded."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * k / 4.0


def rounded_max(a, b, k):
    return -rounded_min(-a, -b, k)


def wave(t, length, phase):
    return np.sin(2.0 * math.pi * t / length + phase)


def waste_slope(s, t):
    """Tipped waste: 38 degrees at the top, a little flatter below, hollow in plan so that the blocks stay together."""
    r = s - 0.002 * t * t + 0.35 * wave(t, 33.0, 0.4) + 0.15 * wave(t, 14.0, 1.9)
    return RELEASE_HEIGHT - SLOPE_TOP * r + (SLOPE_TOP - SLOPE_END) / (2.0 * UPPER_LENGTH) * r * r


def plateau(s, t):
    edge = RELEASE_HEIGHT - SLOPE_TOP * DUMP_EDGE
    return edge - 0.01 * (DUMP_EDGE - s) + 0.10 * wave(t, 41.0, 2.6)


def track(s, t):
    """Nearly level: falls by 1.5 % outwards so that it drains, and by 0.5 % along itself."""
    return TRACK_HEIGHT - 0.015 * (s - CUT_1_TOE) - 0.005 * t


def platform(s, t):
    return PLATFORM_HEIGHT - PLATFORM_FALL * (s - CUT_2_TOE) + 0.06 * wave(t, 47.0, 1.0) * wave(s, 38.0, 0.3)


def toe_1(t):
    return CUT_1_TOE + 0.0035 * t * t + 0.55 * wave(t, 31.0, 0.7) + 0.22 * wave(t, 11.5, 2.1)


def toe_2(t):
    return CUT_2_TOE + 0.0030 * t * t + 0.60 * wave(t, 37.0, 2.9) + 0.25 * wave(t, 13.0, 0.2)


def cut_1(s, t):
    return track(toe_1(t), t) + CUT_1_DIP * (toe_1(t) - s)


def cut_2(s, t):
    return platform(toe_2(t), t) + CUT_2_DIP * (toe_2(t) - s)


def debris(s, t, foot, toe, height):
    """A low apron of fragments at the foot of a cut, at their angle of repose."""
    return foot + height - math.tan(math.radians(34.0)) * np.maximum(s - toe, 0.0)


# ---- terrain ---------------------------------------------------------------------------------------------------------

def correlated_noise(random, rows, columns, length_y, length_x):
    """Gaussian noise of unit variance, smoothed over the given lengths [m]."""
    def kernel(length):
        sigma = length / CELL / 2.0
        reach = int(math.ceil(3.0 * sigma))
        k = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
        return k / math.sqrt(float(np.sum(k * k)))
    ky, kx = kernel(length_y), kernel(length_x)
    field = random.standard_normal((rows + len(ky) - 1, columns + len(kx) - 1))
    field = sum(w * field[i:i + rows, :] for i, w in enumerate(ky))
    return sum(w * field[:, j:j + columns] for j, w in enumerate(kx))


def make_heights(random):
    rows, columns = round(WIDTH / CELL), round(LENGTH / CELL)
    x = (np.arange(columns) + 0.5) * CELL
    y = WIDTH - (np.arange(rows) + 0.5) * CELL
    s, t = to_path(*np.meshgrid(x, y))

    def noise(length_y, length_x):
        return correlated_noise(random, rows, columns, length_y, length_x)

    fine, middle, broad = noise(0.9, 0.9), noise(1.8, 1.8), noise(8.0, 8.0)
    rills = noise(1.6, 9.0)          # runnels and tipping streaks down the waste [about 1.6 m wide, 9 m long]
    joints = noise(1.1, 3.0)         # ribs and recesses of the rock faces
    apron = noise(5.0, 5.0)

    bulge = 0.16 * joints + 0.05 * middle                                   # of the rock faces, horizontal [m]
    waste = rounded_min(waste_slope(s, t), plateau(s, t), 1.2)
    waste = waste + 0.025 * fine + 0.030 * middle + 0.060 * broad + 0.040 * rills
    floor_1 = track(s, t) + 0.007 * fine + 0.012 * middle + 0.030 * broad
    floor_2 = platform(s, t) + 0.007 * fine + 0.012 * middle + 0.050 * broad

    heap_1 = np.clip(0.30 + 0.25 * apron, 0.0, 0.9)                         # height of the debris at the foot [m]
    heap_2 = np.clip(0.30 - 0.25 * apron, 0.0, 0.9)
    floor_1 = rounded_max(floor_1, debris(s, t, track(toe_1(t), t), toe_1(t), heap_1) + 0.03 * fine, 0.25)
    floor_2 = rounded_max(floor_2, debris(s, t, platform(toe_2(t), t), toe_2(t), heap_2) + 0.03 * fine, 0.25)

    z = rounded_max(rounded_min(waste, cut_1(s + bulge, t), 1.0), floor_1, 0.6)
    z = rounded_max(rounded_min(z, cut_2(s + bulge, t), 0.8), floor_2, 0.6)
    return np.round(z / HEIGHT_STEP) * HEIGHT_STEP


def write_terrain(path, heights):
    rows, columns = heights.shape
    options = ["TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=9"]
    dtm = gdal.GetDriverByName("GTiff").Create(str(path), columns, rows, 1, gdal.GDT_Float32, options)
    dtm.SetGeoTransform((EAST, CELL, 0.0, NORTH + WIDTH, 0.0, -CELL))
    dtm.SetProjection(projection().ExportToWkt())
    band = dtm.GetRasterBand(1)
    band.SetNoDataValue(-9999.0)
    band.SetDescription("height")
    band.SetUnitType("m")
    band.WriteArray(heights.astype(np.float32))
    dtm.FlushCache()


# ---- lines and polygons ----------------------------------------------------------------------------------------------

def line_across(difference, x_low, x_high):
    """The curve difference(s, t) = 0 from the southern to the northern edge, as [(x, y)] local, rounded to 1 cm."""
    line = []
    for y in np.arange(0.0, WIDTH + LINE_STEP / 2.0, LINE_STEP):
        low, high = x_low, x_high
        rising = difference(*to_path(high, y)) > 0.0
        assert (difference(*to_path(low, y)) > 0.0) != rising, f"no crossing of the crest at y = {y}"
        for _ in range(60):
            x = (low + high) / 2.0
            low, high = (low, x) if (difference(*to_path(x, y)) > 0.0) == rising else (x, high)
        line.append((round(low, 2), float(y)))
    return line


def straight(x):
    return [(x, 0.0), (x, WIDTH)]


def between(west, east):
    """Polygon between two lines that both run from south to north."""
    return polygon(west + east[::-1])


def map_points(points):
    return [(EAST + x, NORTH + y) for x, y in points]


def polygon(points):
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for e, n in map_points(points + points[:1]):
        ring.AddPoint_2D(e, n)
    result = ogr.Geometry(ogr.wkbPolygon)
    result.AddGeometry(ring)
    assert result.IsValid()
    return result


def linestring(points):
    result = ogr.Geometry(ogr.wkbLineString)
    for e, n in map_points(points):
        result.AddPoint_2D(e, n)
    return result


def projection():
    srs = osr.SpatialReference()
    srs.ImportFromEPSG(EPSG)
    return srs


def write_layer(path, geometry_type, fields, rows):
    """One GeoPackage with one layer of the file's name. rows: (geometry, one text for each field)."""
    source = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    layer = source.CreateLayer(path.stem, projection(), geometry_type)
    for field in fields:
        layer.CreateField(ogr.FieldDefn(field, ogr.OFTString))
    for geometry, *values in rows:
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetGeometry(geometry)
        for field, value in zip(fields, values):
            feature.SetField(field, value)
        layer.CreateFeature(feature)


def write_vectors(folder):
    dump_edge = line_across(lambda s, t: plateau(s, t) - waste_slope(s, t), 5.0, 40.0)
    crest_1 = line_across(lambda s, t: waste_slope(s, t) - cut_1(s, t), 45.0, 75.0)
    before_crest_1 = line_across(lambda s, t: waste_slope(s + 1.0, t) - cut_1(s + 1.0, t), 45.0, 75.0)
    crest_2 = line_across(lambda s, t: track(s, t) - cut_2(s, t), 55.0, 85.0)
    half_way = [(round((a[0] + b[0]) / 2.0, 2), a[1]) for a, b in zip(dump_edge, crest_1)]

    write_layer(folder / "zones.gpkg", ogr.wkbPolygon, ["soil", "part"], [
        (between(straight(MARGIN_WITHOUT_SOIL), crest_1), "loose waste", "plateau and upper slope"),
        (between(crest_1, crest_2), "compact waste", "first cut and track"),
        (between(crest_2, straight(LENGTH)), "compact waste", "second cut and platform")])

    h = RELEASE_SIDE / 2.0
    corners = [to_local(s, t) for s, t in ((-h, -h), (h, -h), (h, h), (-h, h))]
    write_layer(folder / "release.gpkg", ogr.wkbPolygon, ["name"],
                [(polygon([(round(x, 3), round(y, 3)) for x, y in corners]), "release A")])

    write_layer(folder / "screens.gpkg", ogr.wkbLineString, ["name"],
                [(linestring(before_crest_1), "ES1-A"), (linestring(crest_2), "ES2-A")])

    write_layer(folder / "deposit_zones.gpkg", ogr.wkbPolygon, ["name"], [
        (between(dump_edge, half_way), "1A"), (between(half_way, crest_1), "2A"),
        (between(crest_1, crest_2), "3A"), (between(crest_2, straight(LENGTH)), "4A")])


# ---- blocks ----------------------------------------------------------------------------------------------------------

def write_blocks(path, random, count=50):
    """Compact blocks of 0.1 to 0.75 m3. The body fills 50 to 60 % of the box L1 x L2 x L3 around it."""
    rows = []
    while len(rows) < count:
        volume = 0.10 * 7.5 ** random.uniform(0.0, 1.0)      # [m3] as many small as large ones on a logarithmic scale
        fill = random.uniform(0.50, 0.60)                    # [-] volume of the body over that of its box
        density = random.normal(2600.0, 25.0)                # [kg/m3] limestone
        b = float(np.clip(random.normal(0.80, 0.06), 0.68, 0.93))     # L2 / L1
        c = float(np.clip(random.normal(0.65, 0.06), 0.50, b - 0.05))  # L3 / L1
        longest = (volume / fill / (b * c)) ** (1.0 / 3.0)
        size = [round(longest * ratio, 2) for ratio in (1.0, b, c)]   # measured to a centimetre
        if size[0] > size[1] > size[2]:
            rows.append([f"A{len(rows) + 1:02d}", round(density * volume), *(f"{length:.2f}" for length in size)])
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["block_id", "mass_kg", "L1_m", "L2_m", "L3_m"])
        table.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=Path(__file__).resolve().parent / "data", metavar="DIR")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("dtm.tif", "zones.gpkg", "release.gpkg", "screens.gpkg", "deposit_zones.gpkg", "blocks.csv"):
        (folder / name).unlink(missing_ok=True)
    write_terrain(folder / "dtm.tif", make_heights(np.random.RandomState(SEED)))
    write_vectors(folder)
    write_blocks(folder / "blocks.csv", np.random.RandomState(SEED + 1))


if __name__ == "__main__":
    main()
