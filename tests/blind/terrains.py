# SPDX-License-Identifier: GPL-3.0-or-later
"""The slopes of the blind cases: some for development, on which thresholds were chosen as on the sample sites; others for tests, whose cases were looked at when they had been scored; others again for later tests."""
import math
import os
import sys

os.environ["OGR_CURRENT_DATE"] = "2024-01-01T00:00:00.000Z"

try:
    import numpy as np
    from osgeo import gdal, ogr, osr
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()

EPSG, EAST, NORTH = 2154, 700000.0, 6500000.0
WIDTH = 120.0                # [m] of slopes that do not say theirs: 3 to 12 % of the blocks in 3D leave at its sides
RELEASE = 8.0                # [m] from the western edge

# Reaches from the release down: (length [m], slope [degrees]), corners are rounded over some metres; "floor" is where the second soil begins;
# screens stand at these distances from the western edge. The last ones end on the opposite side of the valley, which holds all blocks.
SLOPES = {
    "talus": {"reaches": [(18, 37), (42, 35), (15, 25), (15, 12), (60, 0), (80, -12)], "floor": 74.0, "screens": (35.0, 66.0), "crown": 10.0},
    "benches": {"reaches": [(30, 37), (5, 55), (7, 3), (22, 38), (6, 4), (25, 35), (60, 0), (80, -12)], "floor": 102.0, "screens": (40.0, 78.0), "crown": 10.0},
    "convex": {"reaches": [(15, 28), (20, 34), (20, 40), (6, 2), (25, 33), (20, 15), (60, 0), (80, -12)], "floor": 94.0, "screens": (50.0, 84.0), "crown": 8.0},
    "couloir": {"reaches": [(22, 40), (10, 30), (28, 37), (18, 22), (15, 8), (100, 0)], "floor": 88.0, "screens": (38.0, 78.0), "crown": 10.0},
    "steps": {"reaches": [(20, 36), (4, 60), (9, 6), (26, 37), (5, 50), (8, 4), (20, 33), (100, 0)], "floor": 102.0, "screens": (52.0, 92.0), "crown": 10.0},
    "hollow": {"reaches": [(15, 43), (15, 38), (15, 34), (15, 28), (15, 18), (15, 8), (100, 0)], "floor": 78.0, "screens": (34.0, 64.0), "crown": 10.0},
    "road": {"reaches": [(34, 38), (6, 2), (3, 45), (28, 34), (14, 14), (60, 0), (80, -12)], "floor": 86.0, "screens": (40.0, 80.0), "crown": 10.0},
    "terraces": {"reaches": [(18, 36), (3, 62), (12, 16), (22, 38), (3, 62), (10, 10), (18, 36), (60, 0), (80, -12)], "floor": 96.0, "screens": (48.0, 88.0), "crown": 10.0},
    "gorge": {"reaches": [(12, 46), (24, 36), (12, 44), (16, 28), (18, 16), (60, 0), (90, -14)], "floor": 92.0, "screens": (44.0, 74.0), "crown": 10.0},
    "bluff": {"reaches": [(24, 36), (7, 4), (4, 64), (30, 35), (16, 18), (70, 0), (80, -12)], "floor": 92.0, "screens": (52.0, 82.0), "crown": 10.0},
    "spur": {"reaches": [(20, 42), (8, 18), (28, 39), (16, 29), (14, 10), (70, 0), (80, -12)], "floor": 94.0, "screens": (44.0, 82.0), "crown": 9.0},
    "glacis": {"reaches": [(14, 45), (26, 39), (24, 34), (18, 24), (16, 9), (70, 0), (80, -12)], "floor": 98.0, "screens": (40.0, 84.0), "crown": 11.0},
    "shoulder": {"reaches": [(24, 35), (10, 20), (26, 40), (14, 30), (14, 12), (70, 0), (80, -12)], "floor": 96.0, "screens": (48.0, 82.0), "crown": 10.0},
    "scarp": {"reaches": [(18, 38), (4, 66), (18, 30), (24, 37), (14, 20), (12, 8), (70, 0), (80, -12)], "floor": 94.0, "screens": (42.0, 80.0), "crown": 9.0},
    "ramp": {"reaches": [(70, 36), (12, 16), (70, 0), (80, -12)], "floor": 88.0, "screens": (38.0, 76.0), "crown": 10.0},
    "cliff": {"reaches": [(8, 38), (5, 64), (36, 35), (16, 27), (14, 13), (70, 0), (80, -12)], "floor": 84.0, "screens": (40.0, 74.0), "crown": 10.0, "width": 300.0},
    "moraine": {"reaches": [(34, 38), (6, 8), (4, -12), (28, 37), (14, 16), (70, 0), (80, -12)], "floor": 90.0, "screens": (38.0, 82.0), "crown": 10.0, "width": 300.0},
    "ravine": {"reaches": [(26, 34), (34, 39), (8, 20), (14, 3), (90, -20)], "floor": 78.0, "screens": (42.0, 74.0), "crown": 10.0, "width": 300.0},
}
SETS = {"development": ("talus", "benches", "convex"), "test": ("couloir", "steps", "hollow"), "final": ("road", "terraces", "gorge"), "later": ("bluff", "spur", "glacis"), "last": ("shoulder", "scarp", "ramp"),
        "newest": ("cliff", "moraine", "ravine")}


def heights(name, x):
    slope = SLOPES[name]
    corners, z = [0.0, slope["crown"]], [0.0, 0.0]
    for length, degrees in slope["reaches"]:
        corners.append(corners[-1] + length)
        z.append(z[-1] - length * math.tan(math.radians(degrees)))
    fine = np.arange(-5.0, corners[-1] + 5.0, 0.1)
    line = np.interp(fine, corners, z)
    kernel = np.hanning(31)
    smooth = np.convolve(line, kernel / kernel.sum(), "same")
    return np.interp(x, fine[20:-20], smooth[20:-20]) + 500.0


def length_of(name):
    return SLOPES[name]["crown"] + sum(length for length, _ in SLOPES[name]["reaches"]) - 5.0


def width_of(name):
    return SLOPES[name].get("width", WIDTH)


def srs():
    s = osr.SpatialReference()
    s.ImportFromEPSG(EPSG)
    return s


def rectangle(x0, x1, y0, y1):
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)):
        ring.AddPoint_2D(EAST + x, NORTH + y)
    polygon = ogr.Geometry(ogr.wkbPolygon)
    polygon.AddGeometry(ring)
    return polygon


def line(points):
    geometry = ogr.Geometry(ogr.wkbLineString)
    for x, y in points:
        geometry.AddPoint_2D(EAST + x, NORTH + y)
    return geometry


def layer(path, kind, rows, field="name"):
    source = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    target = source.CreateLayer(path.stem, srs(), kind)
    target.CreateField(ogr.FieldDefn(field, ogr.OFTString))
    for name, geometry in rows:
        feature = ogr.Feature(target.GetLayerDefn())
        feature.SetField(field, name)
        feature.SetGeometry(geometry)
        target.CreateFeature(feature)


def write(name, folder):
    """DTM, soil zones, release and the line of the profile of one slope, into folder/name."""
    target = folder / name
    if target.exists():
        return target
    target.mkdir(parents=True)
    columns, width = int(length_of(name)), width_of(name)
    rows = int(width)
    random = np.random.default_rng([20240101, list(SLOPES).index(name)])
    noise = random.standard_normal((rows + 2, columns + 2))
    rough = 0.05 * (noise[1:-1, 1:-1] + 0.5 * (noise[:-2, 1:-1] + noise[2:, 1:-1] + noise[1:-1, :-2] + noise[1:-1, 2:])) / math.sqrt(2.0)
    z = heights(name, np.arange(columns) + 0.5)[None, :] + rough
    dtm = gdal.GetDriverByName("GTiff").Create(str(target / "dtm.tif"), columns, rows, 1, gdal.GDT_Float32)
    dtm.SetGeoTransform((EAST, 1.0, 0.0, NORTH + width, 0.0, -1.0))
    dtm.SetProjection(srs().ExportToWkt())
    dtm.GetRasterBand(1).WriteArray(z.astype(np.float32))
    dtm = None
    floor = SLOPES[name]["floor"]
    layer(target / "zones.gpkg", ogr.wkbPolygon,
          [("slope", rectangle(0, floor, 0, width)), ("floor", rectangle(floor, columns, 0, width))], "soil")
    layer(target / "release.gpkg", ogr.wkbPolygon, [("release", rectangle(RELEASE + 3, RELEASE + 7, width / 2 - 2, width / 2 + 2))])
    layer(target / "line.gpkg", ogr.wkbLineString, [("profile", line([(1.5, width / 2), (columns - 1.5, width / 2)]))])
    layer(target / "screens.gpkg", ogr.wkbLineString,
          [(f"ES{k + 1}", line([(x, 1.0), (x, width - 1.0)])) for k, x in enumerate(SLOPES[name]["screens"])])
    return target
