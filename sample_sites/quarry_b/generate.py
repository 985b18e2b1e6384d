#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the data of the synthetic site quarry_b: terrain, soils, release area, screens, deposit zones, blocks.

Usage: generate.py [--output DIR]     (default: data/ beside this file; existing files of the site are replaced)

The terrain is a few smooth surfaces (slopes of waste, rock cut, talus, tracks, deposit area) joined by rounded edges, plus
roughness that is correlated over a metre or two. Frames (local, path) and helpers: ../synthetic_site.py.
"""
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from synthetic_site import (Model, debris, draw_roughness, generate, np, ogr, rounded_heights, rounded_max,  # noqa: E402
                            rounded_min, wave, write_layer)

SEED = 20220591        # any number would do; RandomState's stream is frozen by numpy's compatibility promise
MODEL = Model(east=890200.0, north=6670000.0,   # [m] beside quarry_a, in the same invented quarry
              length=160.0, width=80.0, release_x=20.0, release_y=27.0,
              bearing_south_of_east=math.radians(-9.0))  # the path is not aligned with the grid, as in nature

RELEASE_SIDE = 4.0                  # [m]


def tan_deg(angle):
    return math.tan(math.radians(angle))


RELEASE_HEIGHT = 265.0              # ground at the release centre [m]
DUMP_EDGE = -5.0                    # s of the edge of the tipping plateau [m]
SLOPE_TOP, SLOPE_END = tan_deg(38.0), tan_deg(36.0)   # upper slope at s = 0, at its end
UPPER_LENGTH = 27.0                 # s of its end on the axis [m]

CORRIDOR_BEGIN, CORRIDOR_END = 8.0, 27.0     # s where the ground beside it begins to stand above the slope, and ends [m]
HALF_WIDTH_BEGIN, HALF_WIDTH_END = 6.0, 4.2  # of its floor [m]
CORRIDOR_BEND = 1.2                          # its end lies so far to the right [m]
ROCK_DIP, ROCK_SHOULDER = tan_deg(74.0), tan_deg(20.0)    # faces and top of the rock on the left [-]
TALUS_DIP, TALUS_SHOULDER = tan_deg(37.0), tan_deg(25.0)  # likewise of the talus on the right
TALUS_OVER_TRACK = 3.5                       # its foot covers so much of the first track [m]

TRACK_1_HEIGHT, TRACK_1_ALONG = 245.2, 0.06  # at the axis [m]; falls to the right along itself [-]: the paper's sloping track
TRACK_1_CREST = 34.0                # s of its outer edge [m]
SHORT_DIP = tan_deg(35.0)           # short slope between the tracks [-]
TRACK_2_HEIGHT, TRACK_2_ALONG = 241.6, 0.03  # falls to the right, too
TRACK_2_CREST = 46.0
LOWER_TOP, LOWER_END = tan_deg(36.0), tan_deg(33.0)  # lower slope at its crest, at its foot [-]
LOWER_LENGTH = 33.0                 # [m]
FLOOR_HEIGHT = 219.6                # deposit area at the foot of the lower slope [m]
FLOOR_FALL = 0.01                   # falls outwards so that it drains [-]
TRACK_FALL = 0.02                   # of both tracks, outwards [-]

MARGIN_WITHOUT_SOIL = 2.0           # western strip that no soil polygon covers: it takes the default soil [m]


# ---- shapes ----------------------------------------------------------------------------------------------------------

def slope_surface(r, height, top, end, length):
    """Falls from `height` at r = 0 with slope `top`, changing evenly to `end` at r = length."""
    return height - top * r + (top - end) / (2.0 * length) * np.clip(r, 0.0, length) ** 2


def upper_slope(s, t):
    """Tipped waste, a little hollow in plan."""
    r = s - 0.0015 * t * t + 0.30 * wave(t, 29.0, 1.1) + 0.12 * wave(t, 13.0, 0.5)
    return slope_surface(r, RELEASE_HEIGHT, SLOPE_TOP, SLOPE_END, UPPER_LENGTH)


def plateau(s, t):
    edge = RELEASE_HEIGHT - SLOPE_TOP * DUMP_EDGE
    return edge - 0.01 * (DUMP_EDGE - s) + 0.10 * wave(t, 37.0, 0.8)


def corridor_share(s):
    """0 at the beginning of the corridor, 1 at its end."""
    x = np.clip((s - CORRIDOR_BEGIN) / (CORRIDOR_END - CORRIDOR_BEGIN), 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def half_width(s):
    return HALF_WIDTH_BEGIN + (HALF_WIDTH_END - HALF_WIDTH_BEGIN) * corridor_share(s)


def rock_foot(s):
    """t of the left edge of the corridor's floor."""
    return half_width(s) - CORRIDOR_BEND * corridor_share(s) + 0.25 * wave(s, 9.0, 0.6)


def talus_foot(s):
    """t of its right edge."""
    return -half_width(s) - CORRIDOR_BEND * corridor_share(s) + 0.35 * wave(s, 11.0, 2.2)


def front(t):
    """s where rock and talus end, above the first track."""
    return toe_1(t) + 0.3 * wave(t, 21.0, 0.7)


def corridor_level():
    return float(upper_slope(CORRIDOR_BEGIN, 0.0))


def rock(s, t, bulge):
    """The spur of rock that was left standing: its top falls gently, the cuts towards corridor and track are steep."""
    top = corridor_level() - ROCK_SHOULDER * (s - CORRIDOR_BEGIN) + 0.10 * wave(t, 17.0, 1.5)
    side = upper_slope(s, t) + ROCK_DIP * (t + bulge - rock_foot(s))
    end = track_1(front(t), t) + ROCK_DIP * (front(t) - s - bulge)
    return rounded_min(rounded_min(top, side, 0.8), end, 0.8)


def talus(s, t):
    """A heap of tipped waste."""
    top = corridor_level() - TALUS_SHOULDER * (s - CORRIDOR_BEGIN)
    side = upper_slope(s, t) + TALUS_DIP * (talus_foot(s) - t)
    foot = front(t) + TALUS_OVER_TRACK
    end = track_1(foot, t) + TALUS_DIP * (foot - s)
    return rounded_min(rounded_min(top, side, 1.2), end, 1.2)


def toe_1(t):
    """s of the inner edge of the first track: where the slope above meets it."""
    return UPPER_LENGTH + 0.1 + TRACK_1_ALONG / SLOPE_END * -t + 0.0020 * t * t + 0.3 * wave(t, 29.0, 1.1 + math.pi)


def crest_1(t):
    return TRACK_1_CREST + 0.0025 * t * t + 0.45 * wave(t, 33.0, 2.0) + 0.20 * wave(t, 12.0, 0.9)


def crest_2(t):
    return TRACK_2_CREST + 0.0030 * t * t + 0.50 * wave(t, 39.0, 0.3) + 0.20 * wave(t, 12.5, 2.4)


def track_1(s, t):
    return TRACK_1_HEIGHT - TRACK_FALL * (s - UPPER_LENGTH) + TRACK_1_ALONG * t


def track_2(s, t):
    return TRACK_2_HEIGHT - TRACK_FALL * (s - 39.0) + TRACK_2_ALONG * t


def short_slope(s, t):
    return track_1(crest_1(t), t) - SHORT_DIP * (s - crest_1(t))


def lower_slope(s, t):
    return slope_surface(s - crest_2(t), track_2(crest_2(t), t), LOWER_TOP, LOWER_END, LOWER_LENGTH)


def deposit_area(s, t):
    return FLOOR_HEIGHT - FLOOR_FALL * (s - 78.0) + 0.06 * wave(t, 43.0, 1.7) * wave(s, 35.0, 0.9)


# ---- terrain ---------------------------------------------------------------------------------------------------------

def make_heights(random):
    s, t = MODEL.cell_centres()
    rough = draw_roughness(random, MODEL)
    fine, middle, broad, rills = rough.fine, rough.middle, rough.broad, rough.rills

    rough_waste = 0.025 * fine + 0.030 * middle + 0.050 * broad + 0.035 * rills
    rough_floor = 0.007 * fine + 0.012 * middle + 0.030 * broad

    waste = rounded_max(upper_slope(s, t), talus(s, t), 1.0) + rough_waste
    heap = np.clip(0.35 + 0.25 * rough.apron, 0.0, 0.9)                     # height of the fragments at the foot of the rock [m]
    fragments = debris(rock_foot(s) - t, waste, 0.0, heap)
    beside_rock = (s > CORRIDOR_BEGIN + 3.0) & (s < CORRIDOR_END - 1.0) & (t < rock_foot(s) + 0.5)
    waste = np.where(beside_rock, rounded_max(waste, fragments + 0.03 * fine, 0.25), waste)
    z = rounded_max(waste, rock(s, t, rough.bulge) + 0.02 * middle, 0.4)
    z = rounded_min(z, plateau(s, t) + rough_waste, 1.2)
    z = rounded_max(z, track_1(s, t) + rough_floor, 0.8)
    z = rounded_min(z, short_slope(s, t) + rough_waste, 0.8)
    z = rounded_max(z, track_2(s, t) + rough_floor, 0.8)
    z = rounded_min(z, lower_slope(s, t) + rough_waste, 0.8)
    z = rounded_max(z, deposit_area(s, t) + rough_floor, 0.8)
    return rounded_heights(z)


# ---- lines, polygons, blocks -----------------------------------------------------------------------------------------

def rock_polygon():
    """The cut beside the corridor in plan, from its foot to behind its crest."""
    along = np.arange(CORRIDOR_BEGIN + 2.0, CORRIDOR_END - 1.0, 1.0)
    crest = [rock_foot(s) + 0.6 + max(corridor_level() - ROCK_SHOULDER * (s - CORRIDOR_BEGIN) - upper_slope(s, 0.0), 0.0) /
             ROCK_DIP for s in along]
    return MODEL.path_polygon([(s, rock_foot(s) - 0.2) for s in along] + list(zip(along[::-1], crest[::-1])))


def write_vectors(folder):
    dump_edge = MODEL.line_across(lambda s, t: plateau(s, t) - upper_slope(s, t), 2.0, 40.0)
    contour = MODEL.line_across(lambda s, t: corridor_level() - upper_slope(s, t), 10.0, 55.0)
    track_1_inner = MODEL.line_across(lambda s, t: s - toe_1(t), 15.0, 80.0)
    track_1_outer = MODEL.line_across(lambda s, t: s - crest_1(t), 25.0, 85.0)
    track_2_inner = MODEL.line_across(lambda s, t: track_2(s, t) - short_slope(s, t), 25.0, 90.0)
    track_2_outer = MODEL.line_across(lambda s, t: s - crest_2(t), 35.0, 100.0)
    lower_foot = MODEL.line_across(lambda s, t: deposit_area(s, t) - lower_slope(s, t), 60.0, 140.0)
    cut = rock_polygon()

    write_layer(folder / "zones.gpkg", ogr.wkbPolygon, ["soil", "part"], [
        (MODEL.between(MODEL.straight(MARGIN_WITHOUT_SOIL), track_1_inner).Difference(cut), "loose waste",
         "plateau and upper slope"),
        (cut, "compact waste", "rock cut beside the corridor"),
        (MODEL.between(track_1_inner, track_1_outer), "compact waste", "first track"),
        (MODEL.between(track_1_outer, track_2_inner), "loose waste", "short slope"),
        (MODEL.between(track_2_inner, track_2_outer), "compact waste", "second track"),
        (MODEL.between(track_2_outer, lower_foot), "loose waste", "lower slope"),
        (MODEL.between(lower_foot, MODEL.straight(MODEL.length)), "compact waste", "deposit area")])

    write_layer(folder / "release.gpkg", ogr.wkbPolygon, ["name"],
                [(MODEL.release_square(RELEASE_SIDE / 2.0), "release B")])

    write_layer(folder / "screens.gpkg", ogr.wkbLineString, ["name"],
                [(MODEL.linestring(contour), "ES1-B"), (MODEL.linestring(track_1_outer), "ES2-B")])

    write_layer(folder / "deposit_zones.gpkg", ogr.wkbPolygon, ["name"], [
        (MODEL.between(dump_edge, track_1_inner), "1B"), (MODEL.between(track_1_inner, track_2_inner), "2B"),
        (MODEL.between(track_2_inner, track_2_outer), "3B"),
        (MODEL.between(track_2_outer, MODEL.straight(MODEL.length)), "4B")])


if __name__ == "__main__":
    generate(__file__, __doc__.splitlines()[0], MODEL, SEED, "B", make_heights, write_vectors)
