#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the data of the synthetic site quarry_a: terrain, soils, release area, screens, deposit zones, blocks.

Usage: generate.py [--output DIR]     (default: data/ beside this file; existing files of the site are replaced)

The terrain is a few smooth surfaces (slope of waste, rock cuts, track, platform) joined by rounded edges, plus
roughness that is correlated over a metre or two. Frames (local, path) and helpers: ../synthetic_site.py.
"""
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from synthetic_site import (Model, debris, draw_roughness, generate, np, ogr, rounded_heights, rounded_max,  # noqa: E402
                            rounded_min, wave, write_layer)

SEED = 20220155        # any number would do; RandomState's stream is frozen by numpy's compatibility promise
MODEL = Model(east=890000.0, north=6670000.0,   # [m] round numbers, no quarry looks like this there
              length=160.0, width=80.0, release_x=22.0, release_y=45.0,
              bearing_south_of_east=math.radians(7.0))  # the path is not aligned with the grid, as in nature

RELEASE_SIDE = 4.0                  # [m]
AROUND_RELEASE = 3.0                # strip around it that belongs to the third soil of three_zones.toml [m]

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


# ---- shapes ----------------------------------------------------------------------------------------------------------

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


# ---- terrain ---------------------------------------------------------------------------------------------------------

def make_heights(random):
    s, t = MODEL.cell_centres()
    rough = draw_roughness(random, MODEL)
    fine, middle, broad, rills = rough.fine, rough.middle, rough.broad, rough.rills

    waste = rounded_min(waste_slope(s, t), plateau(s, t), 1.2)
    waste = waste + 0.025 * fine + 0.030 * middle + 0.060 * broad + 0.040 * rills
    floor_1 = track(s, t) + 0.007 * fine + 0.012 * middle + 0.030 * broad
    floor_2 = platform(s, t) + 0.007 * fine + 0.012 * middle + 0.050 * broad

    heap_1 = np.clip(0.30 + 0.25 * rough.apron, 0.0, 0.9)                   # height of the debris at the foot [m]
    heap_2 = np.clip(0.30 - 0.25 * rough.apron, 0.0, 0.9)
    floor_1 = rounded_max(floor_1, debris(s, track(toe_1(t), t), toe_1(t), heap_1) + 0.03 * fine, 0.25)
    floor_2 = rounded_max(floor_2, debris(s, platform(toe_2(t), t), toe_2(t), heap_2) + 0.03 * fine, 0.25)

    z = rounded_max(rounded_min(waste, cut_1(s + rough.bulge, t), 1.0), floor_1, 0.6)
    z = rounded_max(rounded_min(z, cut_2(s + rough.bulge, t), 0.8), floor_2, 0.6)
    return rounded_heights(z)


def write_vectors(folder):
    dump_edge = MODEL.line_across(lambda s, t: plateau(s, t) - waste_slope(s, t), 5.0, 40.0)
    crest_1 = MODEL.line_across(lambda s, t: waste_slope(s, t) - cut_1(s, t), 45.0, 75.0)
    before_crest_1 = MODEL.line_across(lambda s, t: waste_slope(s + 1.0, t) - cut_1(s + 1.0, t), 45.0, 75.0)
    crest_2 = MODEL.line_across(lambda s, t: track(s, t) - cut_2(s, t), 55.0, 85.0)
    half_way = [(round((a[0] + b[0]) / 2.0, 2), a[1]) for a, b in zip(dump_edge, crest_1)]

    write_layer(folder / "zones.gpkg", ogr.wkbPolygon, ["soil", "part"], [
        (MODEL.between(MODEL.straight(MARGIN_WITHOUT_SOIL), crest_1), "loose waste", "plateau and upper slope"),
        (MODEL.between(crest_1, crest_2), "compact waste", "first cut and track"),
        (MODEL.between(crest_2, MODEL.straight(MODEL.length)), "compact waste", "second cut and platform")])

    around = MODEL.release_square(RELEASE_SIDE / 2.0 + AROUND_RELEASE)
    write_layer(folder / "zones_release.gpkg", ogr.wkbPolygon, ["soil", "part"], [
        (MODEL.between(MODEL.straight(MARGIN_WITHOUT_SOIL), crest_1).Difference(around), "loose waste", "plateau and upper slope"),
        (around, "release ground", "release area"),
        (MODEL.between(crest_1, MODEL.straight(MODEL.length)), "compact waste", "cuts, track and platform")])

    write_layer(folder / "release.gpkg", ogr.wkbPolygon, ["name"],
                [(MODEL.release_square(RELEASE_SIDE / 2.0), "release A")])

    write_layer(folder / "screens.gpkg", ogr.wkbLineString, ["name"],
                [(MODEL.linestring(before_crest_1), "ES1-A"), (MODEL.linestring(crest_2), "ES2-A")])

    write_layer(folder / "deposit_zones.gpkg", ogr.wkbPolygon, ["name"], [
        (MODEL.between(dump_edge, half_way), "1A"), (MODEL.between(half_way, crest_1), "2A"),
        (MODEL.between(crest_1, crest_2), "3A"), (MODEL.between(crest_2, MODEL.straight(MODEL.length)), "4A")])


if __name__ == "__main__":
    generate(__file__, __doc__.splitlines()[0], MODEL, SEED, "A", make_heights, write_vectors)
