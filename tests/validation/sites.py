# SPDX-License-Identifier: GPL-3.0-or-later
"""What the validation scripts share: the sites, where their data are, running scree, reading results."""
import math
import os
import subprocess
import sys
import tomllib
from pathlib import Path

SKIPPED = 77  # exit code that CTest takes for a skipped test

try:
    import numpy as np
    from osgeo import gdal, gdal_array, ogr  # noqa: F401  (gdal_array: reading rasters needs it)
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(SKIPPED)

gdal.UseExceptions()
ogr.UseExceptions()

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parents[1]
SITES = HERE / "sites"
PREFIX = "../../../../../shared/"  # how the site files name the folder of shared data


def shared_folder():
    """SCREE_SHARED_DATA, or the folder `shared` beside the checkout."""
    return Path(os.environ.get("SCREE_SHARED_DATA", PROJECT.parent / "shared"))


def site_file(site):
    return SITES / site / "site.toml"


def path_changes(site):
    """--set for every path of the site file that lies in the shared data. Ends the script as skipped where a file is absent."""
    changes = []
    for section, keys in tomllib.loads(site_file(site).read_text()).items():
        if not isinstance(keys, dict):
            continue
        for key, value in keys.items():
            if not (isinstance(value, str) and value.startswith(PREFIX)):
                continue
            path = shared_folder() / value[len(PREFIX):]
            if not path.exists():
                print(f"skipped: shared data not found: {value[len(PREFIX):]}")
                sys.exit(SKIPPED)
            changes += ["--set", f"{section}.{key}={path}"]
    return changes


def run_site(scree, site, output, count, threads, changes=()):
    """Runs scree quietly; returns its exit code and what it said."""
    command = [scree, "run", str(site_file(site)), *path_changes(site), "--set", f"release.count={count}", *changes,
               "--threads", str(threads), "--output", str(output), "--overwrite", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, (done.stdout + done.stderr).strip()


def run_table(results):
    """The provenance of a run as a dictionary."""
    source = ogr.Open(str(Path(results) / "results.gpkg"))
    return {row["key"]: row["value"] for row in source.GetLayerByName("run")}


def features(results, layer):
    """The features of a layer as dictionaries, with the corners of a geometry as `xyz`; none if there is no such layer."""
    source = ogr.Open(str(Path(results) / "results.gpkg"))
    rows = []
    if layer not in [source.GetLayer(k).GetName() for k in range(source.GetLayerCount())]:
        return rows
    for feature in source.GetLayerByName(layer):
        row = feature.items()
        geometry = feature.GetGeometryRef()
        row["xyz"] = np.array(geometry.GetPoints()) if geometry is not None and geometry.GetGeometryCount() == 0 else None
        rows.append(row)
    return rows


class Heights:
    """The surface of the model: the DTM averaged to the result's cells, two facets between four centres, parted alike everywhere. Ends the script where a run had others."""

    def __init__(self, dtm, results):
        terrain = tomllib.loads((Path(results) / "run.toml").read_text())["terrain"]
        if (terrain["surface"], terrain["diagonals"]) != ("grid", "alike"):
            sys.exit(f"{results}: its terrain is surface = {terrain['surface']!r} with diagonals = {terrain['diagonals']!r}; heights are known here of "
                     "'grid' with 'alike' only: set these, or add the others to Heights in sites.py")
        like = gdal.Open(str(Path(results) / "rasters" / "passages.tif"))
        x0, cell, _, y1, _, _ = like.GetGeoTransform()
        columns, rows = like.RasterXSize, like.RasterYSize
        warped = gdal.Warp("", str(dtm), format="MEM", outputBounds=(x0, y1 - rows * cell, x0 + columns * cell, y1), width=columns, height=rows,
                           resampleAlg="average", outputType=gdal.GDT_Float64, dstNodata=math.nan)
        self.z = warped.ReadAsArray()
        self.x0, self.y1, self.cell = x0 + 0.5 * cell, y1 - 0.5 * cell, cell

    def at(self, x, y):
        u, v = (x - self.x0) / self.cell, (self.y1 - y) / self.cell
        i, j = math.floor(u), math.floor(v)
        if not (0 <= i < self.z.shape[1] - 1 and 0 <= j < self.z.shape[0] - 1):
            return math.nan
        u, v = u - i, v - j  # v counts southwards
        nw, ne, sw, se = self.z[j, i], self.z[j, i + 1], self.z[j + 1, i], self.z[j + 1, i + 1]
        if u >= v:  # the diagonal goes from the north-west to the south-east
            return nw + u * (ne - nw) + v * (se - ne)
        return nw + v * (sw - nw) + u * (se - sw)
