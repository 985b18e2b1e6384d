#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the measurements of the real sites to tables that `scree compare --observed` reads (gis/README.md).

Usage: observations.py SITE FOLDER      (SITE: authume_P1, tschamut or chant_sura; the data are found by SCREE_SHARED_DATA)

Writes the tables into FOLDER and nothing anywhere else: the data are not part of the project. What is taken from where, and what is assumed:

authume_P1   stopping_points from stops.csv: easting, northing, mass, lengths, and the survey's own height, whose datum is not the DTM's (scree says so).
             Error 0.1 m: Bourrier & Acary (2022), section 2, for the same quarry.
tschamut     stopping_points from runs.csv, one throw per run_id; runs that the source flags as short are marked censored, because nobody knows whether
             the block stopped or its track was lost. release_points from the first sample of each run. No error is stated in the source.
chant_sura   screen_crossings: where the reconstructed flights cross two lines that are drawn HERE, across the way of the blocks (screens.gpkg in FOLDER holds
             them for the site): speed, spin where it is known, height over the DTM; blocks.csv for the site. Flights are
             parabolas between marked positions, so the speeds are those that the source fitted; first flights, which the source flags as
             too fast for the fall, and contacts between flights count as passages without values. The DTM ends half a metre behind the true release, so there is no room for a block there:
             release.gpkg is a point 1 m inside, chosen HERE; speeds from it can be read and compared, and mean nothing.
"""
import csv
import sys
from pathlib import Path

from sites import SKIPPED, gdal, np, ogr, shared_folder

BODY = ("mass_kg", "L1_m", "L2_m", "L3_m")


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as table:
        return list(csv.DictReader(table))


def write(folder, name, rows):
    with open(Path(folder) / f"{name}.csv", "w", newline="", encoding="utf-8") as table:
        writer = csv.DictWriter(table, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def authume_P1(data, folder):
    write(folder, "stopping_points", [
        {"block_id": r["block_id"], "easting_m": r["E"], "northing_m": r["N"], "z_m": r["z_survey_m"], "crs": "EPSG:2154",
         **{k: r[k] for k in BODY}, "position_error_m": 0.1} for r in rows_of(data / "authume_P1" / "stops.csv")])


def tschamut(data, folder):
    runs = rows_of(data / "tschamut2014_visible" / "runs.csv")
    write(folder, "stopping_points", [
        {"block_id": r["run_id"], "easting_m": r["E_stop"], "northing_m": r["N_stop"], "z_m": r["z_stop_dtm"], "crs": "EPSG:2056",
         **{k: r[k] for k in BODY}, "censored": r["qc_short"]} for r in runs])
    write(folder, "release_points", [
        {"block_id": r["run_id"], "easting_m": r["E_release"], "northing_m": r["N_release"], "crs": "EPSG:2056"} for r in runs])


# Lines across the way of the blocks, from west to east in EPSG:2056 [m]: above and below the last contacts.
CHANT_SURA_SCREENS = {"upper": 1180274.0, "lower": 1180271.5}
CHANT_SURA_RELEASE = (2793261.4, 1180275.0)


def chant_sura(data, folder):
    source = data / "chant_sura_visible"
    flagged = {(r["run_id"], int(r["impact_index"])) for r in rows_of(source / "contact_events.csv")
               if r["qc_pre_speed_exceeds_free_fall_from_release"] == "1"}
    dtm = gdal.Open(str(source / "dtm.tif"))
    x0, cell, _, y1, _, step = dtm.GetGeoTransform()
    heights = dtm.ReadAsArray()
    flights = {}
    for r in rows_of(source / "flight_segments.csv"):
        flights.setdefault((r["source_trajectory_id"], int(r["segment_index"])), []).append(r)
    crossings = []
    for (run, segment), samples in sorted(flights.items()):
        for name, line in CHANT_SURA_SCREENS.items():
            for a, b in zip(samples, samples[1:]):
                before, after = float(a["y_m"]) - line, float(b["y_m"]) - line
                if before <= 0 or after > 0:  # southwards
                    continue
                s = before / (before - after)
                value = {k: (1 - s) * float(a[k]) + s * float(b[k]) for k in ("x_m", "raw_z_m", "speed_mps")}
                column, row = int((value["x_m"] - x0) / cell), int((line - y1) / step)
                if not (0 <= column < heights.shape[1] and 0 <= row < heights.shape[0]):
                    continue
                spin = float(np.linalg.norm([float(a[f"omega_{k}_radps"] or "nan") for k in "xyz"]))
                usable = (run, segment) not in flagged  # segment k ends in impact k
                crossings.append({"screen": name, "block_id": run, "easting_m": value["x_m"], "northing_m": line, "crs": "EPSG:2056",
                                  "speed_ms": round(value["speed_mps"], 3) if usable else "",
                                  "height_m": round(value["raw_z_m"] - float(heights[row, column]), 3) if usable else "",
                                  "spin_rads": round(spin, 3) if usable and spin > 0 else ""})
    first = {}
    for c in crossings:
        first.setdefault((c["screen"], c["block_id"]), c)
    for run in {run for run, _ in flights}:  # between two flights a block crossed, too, but nothing says how
        lowest = min(float(s["y_m"]) for (r, _), samples in flights.items() if r == run for s in samples)
        for name, line in CHANT_SURA_SCREENS.items():
            if lowest < line:
                first.setdefault((name, run), dict.fromkeys(crossings[0], "") | {"screen": name, "block_id": run, "crs": "EPSG:2056"})
    write(folder, "screen_crossings", [first[key] for key in sorted(first)])
    write(folder, "blocks", [{"block_id": r["run_id"], **{k: r[k] for k in BODY}} for r in rows_of(source / "blocks.csv")])
    start = ogr.GetDriverByName("GPKG").CreateDataSource(str(Path(folder) / "release.gpkg"))
    layer = start.CreateLayer("release", dtm.GetSpatialRef(), ogr.wkbPoint)
    feature = ogr.Feature(layer.GetLayerDefn())
    feature.SetGeometry(ogr.CreateGeometryFromWkt("POINT ({} {})".format(*CHANT_SURA_RELEASE)))
    layer.CreateFeature(feature)
    lines = ogr.GetDriverByName("GPKG").CreateDataSource(str(Path(folder) / "screens.gpkg"))
    layer = lines.CreateLayer("screens", dtm.GetSpatialRef(), ogr.wkbLineString)
    layer.CreateField(ogr.FieldDefn("name", ogr.OFTString))
    for name, y in CHANT_SURA_SCREENS.items():
        feature = ogr.Feature(layer.GetLayerDefn())
        feature["name"] = name
        line = ogr.Geometry(ogr.wkbLineString)
        line.AddPoint_2D(x0, y)
        line.AddPoint_2D(x0 + cell * heights.shape[1], y)
        feature.SetGeometry(line)
        layer.CreateFeature(feature)


SITES = {"authume_P1": authume_P1, "tschamut": tschamut, "chant_sura": chant_sura}


def convert(site, folder):
    """Writes the tables of a site; ends the script as skipped where the data are absent."""
    data = shared_folder() / "data"
    if not data.exists():
        print("skipped: shared data not found: data")
        sys.exit(SKIPPED)
    Path(folder).mkdir(parents=True, exist_ok=True)
    SITES[site](data, folder)


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in SITES:
        print(__doc__)
        sys.exit(2)
    convert(*sys.argv[1:])
