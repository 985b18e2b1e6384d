# SPDX-License-Identifier: GPL-3.0-or-later
"""What the generators of the synthetic sites share: frames, shapes of ground, roughness, writing of layers and blocks, the
command line.

Two frames: local (x east, y north, origin at the south-west corner of the model) and path (s down the path from the
centre of the release area, t across it, positive to the left).
"""
import argparse
import csv
import math
import os
from dataclasses import dataclass
from pathlib import Path

os.environ["OGR_CURRENT_DATE"] = "2024-01-01T00:00:00.000Z"  # the date that GeoPackages carry: the same bytes every time

import numpy as np  # noqa: E402
from osgeo import gdal, ogr, osr  # noqa: E402

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()

EPSG = 2154                         # RGF93 / Lambert-93 [m]
CELL = 0.2                          # the paper's photogrammetric model [m]
HEIGHT_STEP = 1.0 / 1024.0          # heights are rounded to this [m]: a millimetre, but exact in binary, so it packs well
LINE_STEP = 2.0                     # distance between the vertices of crest lines [m]


@dataclass(frozen=True)
class Model:
    """Place and size of a synthetic terrain, and the path on it."""
    east: float                     # south-west corner [m]
    north: float
    length: float                   # extent to the east and to the north [m]
    width: float
    release_x: float                # centre of the release area, local [m]
    release_y: float
    bearing_south_of_east: float    # of the path [rad]

    def to_path(self, x, y):
        c, s = math.cos(self.bearing_south_of_east), math.sin(self.bearing_south_of_east)
        return (x - self.release_x) * c - (y - self.release_y) * s, (x - self.release_x) * s + (y - self.release_y) * c

    def to_local(self, s, t):
        c, n = math.cos(self.bearing_south_of_east), math.sin(self.bearing_south_of_east)
        return self.release_x + s * c + t * n, self.release_y - s * n + t * c

    def cells(self):
        return round(self.width / CELL), round(self.length / CELL)

    def cell_centres(self):
        """s and t of every cell, northernmost row first."""
        rows, columns = self.cells()
        x = (np.arange(columns) + 0.5) * CELL
        y = self.width - (np.arange(rows) + 0.5) * CELL
        return self.to_path(*np.meshgrid(x, y))

    def map_points(self, points):
        return [(self.east + x, self.north + y) for x, y in points]

    def line_across(self, difference, x_low, x_high):
        """The curve difference(s, t) = 0 from the southern to the northern edge, as [(x, y)] local, rounded to 1 cm."""
        line = []
        for y in np.arange(0.0, self.width + LINE_STEP / 2.0, LINE_STEP):
            low, high = x_low, x_high
            rising = difference(*self.to_path(high, y)) > 0.0
            assert (difference(*self.to_path(low, y)) > 0.0) != rising, f"no crossing of the crest at y = {y}"
            for _ in range(60):
                x = (low + high) / 2.0
                low, high = (low, x) if (difference(*self.to_path(x, y)) > 0.0) == rising else (x, high)
            line.append((round(low, 2), float(y)))
        return line

    def straight(self, x):
        return [(x, 0.0), (x, self.width)]

    def between(self, west, east):
        """Polygon between two lines that both run from south to north."""
        return self.polygon(west + east[::-1])

    def polygon(self, points):
        ring = ogr.Geometry(ogr.wkbLinearRing)
        for e, n in self.map_points(points + points[:1]):
            ring.AddPoint_2D(e, n)
        result = ogr.Geometry(ogr.wkbPolygon)
        result.AddGeometry(ring)
        assert result.IsValid()
        return result

    def path_polygon(self, corners):
        """Polygon of corners given as (s, t), rounded to a millimetre."""
        return self.polygon([(round(x, 3), round(y, 3)) for x, y in (self.to_local(s, t) for s, t in corners)])

    def release_square(self, half):
        """Square along the path around the centre of the release area."""
        return self.path_polygon([(-half, -half), (half, -half), (half, half), (-half, half)])

    def linestring(self, points):
        result = ogr.Geometry(ogr.wkbLineString)
        for e, n in self.map_points(points):
            result.AddPoint_2D(e, n)
        return result


# ---- shapes ----------------------------------------------------------------------------------------------------------

def rounded_min(a, b, k):
    """The lower of two surfaces; where they differ by less than k [m] the edge between them is rounded."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - h * h * k / 4.0


def rounded_max(a, b, k):
    return -rounded_min(-a, -b, k)


def wave(t, length, phase):
    return np.sin(2.0 * math.pi * t / length + phase)


def debris(s, foot, toe, height):
    """A low apron of fragments at the foot of a cut, at their angle of repose."""
    return foot + height - math.tan(math.radians(34.0)) * np.maximum(s - toe, 0.0)


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


@dataclass(frozen=True)
class Roughness:
    """Fields of noise of the model's cells, drawn in the order of the fields."""
    fine: np.ndarray
    middle: np.ndarray
    broad: np.ndarray
    rills: np.ndarray               # runnels and tipping streaks down the waste [about 1.6 m wide, 9 m long]
    joints: np.ndarray              # ribs and recesses of rock faces
    apron: np.ndarray

    @property
    def bulge(self):
        """Of rock faces, horizontal [m]."""
        return 0.16 * self.joints + 0.05 * self.middle


def draw_roughness(random, model):
    lengths = ((0.9, 0.9), (1.8, 1.8), (8.0, 8.0), (1.6, 9.0), (1.1, 3.0), (5.0, 5.0))  # of correlation, y and x [m]
    return Roughness(*(correlated_noise(random, *model.cells(), *length) for length in lengths))


def rounded_heights(z):
    return np.round(z / HEIGHT_STEP) * HEIGHT_STEP


# ---- files -----------------------------------------------------------------------------------------------------------

def projection():
    srs = osr.SpatialReference()
    srs.ImportFromEPSG(EPSG)
    return srs


def write_terrain(path, model, heights):
    rows, columns = heights.shape
    options = ["TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=DEFLATE", "PREDICTOR=3", "ZLEVEL=9"]
    dtm = gdal.GetDriverByName("GTiff").Create(str(path), columns, rows, 1, gdal.GDT_Float32, options)
    dtm.SetGeoTransform((model.east, CELL, 0.0, model.north + model.width, 0.0, -CELL))
    dtm.SetProjection(projection().ExportToWkt())
    band = dtm.GetRasterBand(1)
    band.SetNoDataValue(-9999.0)
    band.SetDescription("height")
    band.SetUnitType("m")
    band.WriteArray(heights.astype(np.float32))
    dtm.FlushCache()


def write_layer(path, geometry_type, fields, rows):
    """One GeoPackage with one layer of the file's name. rows: (geometry, one text for each field)."""
    path.unlink(missing_ok=True)
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


def write_blocks(path, random, letter, count=50):
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
            rows.append([f"{letter}{len(rows) + 1:02d}", round(density * volume), *(f"{length:.2f}" for length in size)])
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["block_id", "mass_kg", "L1_m", "L2_m", "L3_m"])
        table.writerows(rows)


# ---- command line ----------------------------------------------------------------------------------------------------

def generate(script, title, model, seed, letter, make_heights, write_vectors):
    """What a site's generate.py does: terrain, vector layers, blocks named by `letter`."""
    parser = argparse.ArgumentParser(description=title)
    parser.add_argument("--output", type=Path, default=Path(script).resolve().parent / "data", metavar="DIR")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    write_terrain(folder / "dtm.tif", model, make_heights(np.random.RandomState(seed)))
    write_vectors(folder)
    write_blocks(folder / "blocks.csv", np.random.RandomState(seed + 1), letter)
