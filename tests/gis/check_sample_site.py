#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Is the data/ of a synthetic sample site what its generate.py writes, and do its layers fit together?

Contents are compared, not bytes, since other versions of GDAL may pack them differently. Exit code: 0 yes, 1 no (one line
per difference), 77 skipped because numpy or GDAL's Python module is absent.
Usage: check_sample_site.py SITE [--data DIR]     (SITE: a folder of sample_sites; default: its data in the repository)
"""
import argparse
import re
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
    from osgeo import gdal, gdal_array, ogr  # noqa: F401  (gdal_array: reading rasters needs it)
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)

gdal.UseExceptions()
ogr.UseExceptions()

SITES = Path(__file__).resolve().parents[2] / "sample_sites"
FIRST_ZONE = {"quarry_a": "1A", "quarry_b": "1B"}   # deposit zone that the release area lies in
RASTERS = ["dtm.tif"]
LAYERS = ["zones.gpkg", "release.gpkg", "screens.gpkg", "deposit_zones.gpkg"]
MORE_LAYERS = {"quarry_a": ["zones_release.gpkg"]}
SITE_FILES = {"quarry_a": {"site.toml": "zones.gpkg", "truth.toml": "zones.gpkg", "three_zones.toml": "zones_release.gpkg"},
              "quarry_b": {"site.toml": "zones.gpkg", "truth.toml": "zones.gpkg"}}   # each with its layer of soils
TABLES = ["blocks.csv"]

# Another processor or numpy may round exp and sin differently in the last bit: a height near a half step then rounds the
# other way. One step of 1/1024 m in very few cells is that; anything else is a change of the site.
HEIGHT_STEP = 1.0 / 1024.0      # [m] the rounding of the heights
MAX_CELLS_ROUNDED_APART = 20    # [-] of 320 000
SAME_POINT = 0.011              # [m] vertices are rounded to a centimetre
SAME_AREA = 1e-6                # [m2]


def read_raster(path):
    dataset = gdal.Open(str(path))
    band = dataset.GetRasterBand(1)
    facts = {"size": (dataset.RasterXSize, dataset.RasterYSize, dataset.RasterCount), "placement": dataset.GetGeoTransform(),
             "crs": dataset.GetSpatialRef().GetAuthorityCode(None), "type": gdal.GetDataTypeName(band.DataType),
             "nodata": band.GetNoDataValue(), "unit": band.GetUnitType(),
             "compression": dataset.GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE")}
    return facts, band.ReadAsArray().astype(float)


def read_layer(path):
    """(facts, [(attributes, geometry)]) of the only layer of a file."""
    source = ogr.Open(str(path))
    layer = source.GetLayer(0)
    facts = {"layers": source.GetLayerCount(), "name": layer.GetName(), "type": layer.GetGeomType(),
             "crs": layer.GetSpatialRef().GetAuthorityCode(None),
             "fields": [layer.GetLayerDefn().GetFieldDefn(i).GetName() for i in range(layer.GetLayerDefn().GetFieldCount())],
             "features": layer.GetFeatureCount()}
    return facts, [(feature.items(), feature.GetGeometryRef().Clone()) for feature in layer]


def vertices(geometry):
    parts = [geometry.GetGeometryRef(i) for i in range(geometry.GetGeometryCount())] or [geometry]
    return np.array([point[:2] for part in parts for point in part.GetPoints()])


def compare_raster(name, kept, made):
    (kept_facts, a), (made_facts, b) = kept, made
    if kept_facts != made_facts:
        yield f"{name}: {kept_facts} is kept, generate.py writes {made_facts}"
        return
    apart = np.abs(a - b)
    if apart.max() > 1.01 * HEIGHT_STEP or np.count_nonzero(apart) > MAX_CELLS_ROUNDED_APART:
        yield f"{name}: {np.count_nonzero(apart)} cells differ, by up to {apart.max():.4f} m"


def compare_layer(name, kept, made):
    (kept_facts, a), (made_facts, b) = kept, made
    if kept_facts != made_facts:
        yield f"{name}: {kept_facts} is kept, generate.py writes {made_facts}"
        return
    for i, ((kept_values, kept_shape), (made_values, made_shape)) in enumerate(zip(a, b), start=1):
        if kept_values != made_values:
            yield f"{name}, feature {i}: {kept_values} is kept, generate.py writes {made_values}"
        p, q = vertices(kept_shape), vertices(made_shape)
        if p.shape != q.shape or np.abs(p - q).max() > SAME_POINT:
            yield f"{name}, feature {i}: another geometry"


def compare_table(name, kept, made):
    if kept != made:
        lines = [i for i, (a, b) in enumerate(zip(kept.splitlines(), made.splitlines()), start=1) if a != b]
        yield f"{name}: differs first in line {lines[0] if lines else 'that only one of them has'}"


def shared_area(a, b):
    shared = a.Intersection(b)
    return shared.Area() if shared.GetDimension() == 2 else 0.0


def check_fit(rasters, layers, first_zone):
    """What a user takes for granted: one CRS, everything on the terrain, soils that do not overlap."""
    facts, _ = rasters["dtm.tif"]
    west, cell, _, north, _, _ = facts["placement"]
    columns, rows, _ = facts["size"]
    extent = (west, north - rows * cell, west + columns * cell, north)
    for name, (layer_facts, features) in layers.items():
        if layer_facts["crs"] != facts["crs"]:
            yield f"{name}: EPSG:{layer_facts['crs']}, but the DTM has EPSG:{facts['crs']}"
        for values, shape in features:
            p = vertices(shape)
            if (p < np.array(extent[:2]) - 1e-6).any() or (p > np.array(extent[2:]) + 1e-6).any():
                yield f"{name}, {values}: leaves the DTM"
            if not shape.IsValid():
                yield f"{name}, {values}: invalid geometry"
    for name in (name for name in layers if name.startswith(("zones", "deposit_zones"))):
        shapes = [shape for _, shape in layers[name][1]]
        for i, first in enumerate(shapes):
            if any(shared_area(first, other) > SAME_AREA for other in shapes[i + 1:]):
                yield f"{name}: polygons overlap"
    release = layers["release.gpkg"][1][0][1]
    for name, field, wanted in (("zones.gpkg", "soil", "loose waste"), ("deposit_zones.gpkg", "name", first_zone)):
        if not any(values[field] == wanted and shape.Contains(release) for values, shape in layers[name][1]):
            yield f"release.gpkg: does not lie inside {wanted} of {name}"


def check_site_file(site, name, zones):
    """Every file and every soil that a site file names exists."""
    text = (site / name).read_text(encoding="utf-8")
    for path in re.findall(r'"(data/[^"]+)"', text):
        if not (site / path).is_file():
            yield f"{name}: {path} does not exist"
    soils = set(re.findall(r'^name = "([^"]+)"', text.split("[[soil]]", 1)[1], flags=re.MULTILINE))
    used = {values["soil"] for values, _ in read_layer(site / "data" / zones)[1]}
    if soils != used:
        yield f"{name}: describes the soils {sorted(soils)}, {zones} uses {sorted(used)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("site", choices=FIRST_ZONE)
    parser.add_argument("--data", type=Path, metavar="DIR")
    args = parser.parse_args()
    site = SITES / args.site
    kept = args.data or site / "data"
    expected = sorted(RASTERS + LAYERS + MORE_LAYERS.get(args.site, []) + TABLES)
    problems = []
    if sorted(path.name for path in kept.iterdir()) != expected:
        problems.append(f"{kept.name}/: holds {sorted(path.name for path in kept.iterdir())}, expected {expected}")
    else:
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder)
            subprocess.run([sys.executable, "-B", str(site / "generate.py"), "--output", folder], check=True)
            rasters = {name: read_raster(kept / name) for name in RASTERS}
            layers = {name: read_layer(kept / name) for name in LAYERS + MORE_LAYERS.get(args.site, [])}
            for name in RASTERS:
                problems += compare_raster(name, rasters[name], read_raster(made / name))
            for name in LAYERS + MORE_LAYERS.get(args.site, []):
                problems += compare_layer(name, layers[name], read_layer(made / name))
            for name in TABLES:
                problems += compare_table(name, (kept / name).read_text(), (made / name).read_text())
        problems += check_fit(rasters, layers, FIRST_ZONE[args.site])
        for name, zones in SITE_FILES[args.site].items():
            problems += check_site_file(site, name, zones)
    for problem in problems:
        print(problem)
    print(f"{args.site}: " + (f"{len(problems)} problems" if problems else "the data follow from generate.py and fit together"))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
