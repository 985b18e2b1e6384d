#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a DTM at 1 m with independent uniform noise on every cell: the roughest ground a model of 1 m can hold.

Usage: make_rough.py DTM OUT.tif [--cell 1.0] [--noise 0.05] [--seed 1]

The DTM is averaged by area to the cell first. Terrain that is rough from node to node makes crests and tips meet the faces of a block in
15-20 % of contacts, against 0.5 % on a smooth one: this is where contact detection shows what it cannot do.
"""
import argparse
import sys

try:
    import numpy as np
    from osgeo import gdal, gdal_array  # noqa: F401  (gdal_array: reading rasters needs it)
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dtm")
    parser.add_argument("out")
    parser.add_argument("--cell", type=float, default=1.0, help="cell of the result [m]")
    parser.add_argument("--noise", type=float, default=0.05, help="half width of the noise [m]")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    gdal.UseExceptions()
    averaged = gdal.Warp("", arguments.dtm, format="MEM", xRes=arguments.cell, yRes=arguments.cell, resampleAlg="average")
    heights = averaged.ReadAsArray().astype(np.float64)
    nodata = averaged.GetRasterBand(1).GetNoDataValue()
    valid = np.isfinite(heights) if nodata is None else heights != nodata
    noise = np.random.Generator(np.random.PCG64(arguments.seed)).uniform(-arguments.noise, arguments.noise, heights.shape)
    heights[valid] += noise[valid]
    rows, columns = heights.shape
    result = gdal.GetDriverByName("GTiff").Create(arguments.out, columns, rows, 1, gdal.GDT_Float32, ["COMPRESS=DEFLATE", "PREDICTOR=3"])
    result.SetGeoTransform(averaged.GetGeoTransform())
    result.SetProjection(averaged.GetProjection())
    if nodata is not None:
        result.GetRasterBand(1).SetNoDataValue(nodata)
    result.GetRasterBand(1).WriteArray(heights.astype(np.float32))


main()
