#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Chant Sura: what is left of a block's energy by one impact, measured and simulated.

Usage: contacts.py SCREE [--blocks N] [--output DIR] [--threads N]

Every impact whose velocities are usable (its README says which), and every impact with a published scar, is repeated N times: a block of its mass and form arrives on
an even slope of pasture with the measured speed, angle and spin (of a scar: none is known), turned at random. What is compared is the share of the translational energy that it
has when it flies again, for pasture as the site file has it, with e = 0.3, with mu = 0.9, with scars (scar_drag), and with both of the latter. The flights were reconstructed from marked positions, so that
this tells what is plausible and nothing finer. The data are found by SCREE_SHARED_DATA; without them: exit code 77.
"""
import argparse
import math
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from osgeo import osr  # noqa: E402

import observations  # noqa: E402
from sites import SKIPPED, gdal, np, ogr, shared_folder  # noqa: E402

G = 9.81  # [m/s2]
FLIGHT = 0.15  # before the impact; the films of scree run take less than 0.1 s for a hop [s]
DENSITY = 2670.0  # assumed by the source [kg/m3]
MODELS = {  # effect, e, mu
    "pasture": ("", 0.0, 0.5),
    "e = 0.3": ("", 0.3, 0.5),
    "mu = 0.9": ("", 0.0, 0.9),
    "scars": ('[[effect]]\nkind = "scar_drag"\n', 0.0, 0.5),
    "both": ('[[effect]]\nkind = "scar_drag"\n', 0.0, 0.9),
}


def events(data):
    """(name, mass [kg], L2/L3, v_n before [m/s], v_t before [m/s], slope [rad], spin [rad/s], share of the energy after [-])."""
    for row in observations.rows_of(data / "contact_events.csv"):
        if row["usable_velocity"] != "1":
            continue
        normal, along = float(row["vn_pre"]), float(row["vt_pre"])
        flat = 2.0 if "221" in row["shape"] else 1.0
        yield (row["event_id"], float(row["mass_kg"]), flat, normal, along, math.acos(float(row["terrain_normal_z"])), float(row["pre_spin"] or 0.0),
               float(row["energy_ratio_trans"]))
    for row in observations.rows_of(data / "scar_impacts_esurf2019.csv"):  # its normal part is that of a flat plane
        yield (row["impact_id"], float(row["mass_kg"]), 2.0, -float(row["incoming_normal_speed_mps"]), float(row["incoming_tangent_speed_mps"]), 0.0, 0.0,
               float(row["published_energy_transition_ratio"]))


def write_slope(folder, slope):
    """120 x 40 m that fall to the east, and a place to start from."""
    folder.mkdir(parents=True, exist_ok=True)
    heights = 200.0 - math.tan(slope) * np.tile(np.arange(240) * 0.5 + 0.25, (80, 1))
    grid = gdal.GetDriverByName("GTiff").Create(str(folder / "dtm.tif"), 240, 80, 1, gdal.GDT_Float64)
    grid.SetGeoTransform((2_793_200.0, 0.5, 0.0, 1_180_040.0, 0.0, -0.5))
    reference = osr.SpatialReference()
    reference.ImportFromEPSG(2056)
    grid.SetProjection(reference.ExportToWkt())
    grid.GetRasterBand(1).WriteArray(heights)
    grid.FlushCache()
    file = ogr.GetDriverByName("GPKG").CreateDataSource(str(folder / "release.gpkg"))
    layer = file.CreateLayer("release", reference, ogr.wkbPoint)
    feature = ogr.Feature(layer.GetLayerDefn())
    feature.SetGeometry(ogr.CreateGeometryFromWkt("POINT (2793210 1180020)"))
    layer.CreateFeature(feature)
    del layer, file  # closed


def site_text(event, effect, restitution, friction, blocks):
    _, mass, flat, normal, along, slope, spin, _ = event
    side = (mass / DENSITY * flat) ** (1.0 / 3.0)
    normal_at_start = normal + G * math.cos(slope) * FLIGHT
    along_at_start = along - G * math.sin(slope) * FLIGHT
    fallen = -(normal_at_start * FLIGHT - 0.5 * G * math.cos(slope) * FLIGHT**2)  # along the normal [m]
    height = max(0.0, (fallen + 0.45 * side) / math.cos(slope))
    east = along_at_start * math.cos(slope) + normal_at_start * math.sin(slope)
    up = -along_at_start * math.sin(slope) + normal_at_start * math.cos(slope)
    return f"""[site]
name = "impact"
[terrain]
dtm = "dtm.tif"
[[soil]]
name = "pasture"
restitution = {restitution}
friction = {friction}
rolling = 0.04
{effect}[blocks]
shape = "eota"
volume_law = "uniform"
volume_min = {mass / DENSITY}
volume_max = {mass / DENSITY}
density = {DENSITY}
ratio_21_min = 1.0
ratio_21_max = 1.0
ratio_32_min = {1.0 / flat}
ratio_32_max = {1.0 / flat}
[release]
file = "release.gpkg"
count = {blocks}
height = {height}
speed = {math.hypot(east, up)}
azimuth_deg = 90.0
elevation_deg = {math.degrees(math.atan2(up, east))}
spin = {spin}
[model]
dimension = 3
mode = "event"
seed = 1
[output]
directory = "out"
impacts = 1
trajectories = 0
"""


def energy_left(folder):
    """Of every block that flew again: the share of its translational energy [-]."""
    results = ogr.Open(str(folder / "out" / "results.gpkg"))
    return np.array([(f["speed_after_ms"] / f["speed_before_ms"]) ** 2 for f in results.GetLayer("impacts")])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("--blocks", type=int, default=400, metavar="N")
    parser.add_argument("--output", type=Path, default=HERE / "out", metavar="DIR")
    parser.add_argument("--threads", type=int, default=0, metavar="N")
    options = parser.parse_args()
    data = shared_folder() / "data" / "chant_sura_visible"
    if not data.exists():
        print("skipped: shared data not found: data/chant_sura_visible")
        sys.exit(SKIPPED)
    inside = {name: 0 for name in MODELS}
    ranks = {name: [] for name in MODELS}
    print("share of the translational energy left: measured; simulated median (2.5 to 97.5 %), share of the simulated below the measured")
    for event in events(data):
        if event[3] >= 0.0:
            print(f"{event[0]:24} leaves the ground before it meets it: not simulated")
            continue
        folder = options.output / event[0]
        write_slope(folder, event[5])
        text = f"{event[0]:24} {event[7]:.2f}"
        for name, model in MODELS.items():
            (folder / "site.toml").write_text(site_text(event, *model, options.blocks))
            subprocess.run([options.scree, "run", str(folder / "site.toml"), "--overwrite", "--quiet", "--threads", str(options.threads)], check=True)
            left = energy_left(folder)
            low, middle, high = np.quantile(left, [0.025, 0.5, 0.975])
            below = float(np.mean(left < event[7]))
            inside[name] += low <= event[7] <= high
            ranks[name].append(below)
            text += f" | {name}: {middle:.2f} ({low:.2f} to {high:.2f}) {below:.2f} of {len(left)}"
        print(text, flush=True)
    for name, of_model in ranks.items():
        print(f"{name}: {inside[name]} of {len(of_model)} within 95 %, mean share below {np.mean(of_model):.2f} (0.50 +- {1.0 / math.sqrt(12.0 * len(of_model)):.2f})")


if __name__ == "__main__":
    main()
