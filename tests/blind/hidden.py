# SPDX-License-Identifier: GPL-3.0-or-later
"""What blind cases can have hidden: effects by the formulas of the catalogue, by others of the same family (laws.cpp), outside the catalogue, and faults of measurement."""
import json


def entry(kind, **values):
    return f'[[effect]]\nkind = "{kind}"\n' + "".join(f"{k} = {json.dumps(v)}\n" for k, v in values.items()) + "\n"


# name -> (families that are right answers, strength at which a search begins, largest strength, text of the site for a strength);
# the formulas of the catalogue up to about 80 % of what a diagnosis searches, beyond which it can give no name
SAME_FORMULA = {
    "ground_drag": (["ground_drag"], 0.2, 5.0, lambda q, at: entry("ground_drag", coefficient=q)),
    "ground_drag_quadratic": (["ground_drag"], 0.02, 0.7, lambda q, at: entry("ground_drag_quadratic", coefficient=q)),
    "scar_drag_reduced": (["ground_drag"], 0.02, 0.7, lambda q, at: entry("scar_drag_reduced", coefficient=q)),
    "rolling_speed": (["rolling_speed"], 0.2, 0.8, lambda q, at: entry("rolling_speed", speed=1.0 / q)),
    "rolling_size": (["rolling_size"], 0.5, 2.4, lambda q, at: entry("rolling_size", exponent=q)),
    "restitution_pfeiffer_bowen": (["restitution_half_speed"], 0.2, 0.5, lambda q, at: entry("restitution_pfeiffer_bowen", half_speed=1.0 / q)),
    "restitution_mass": (["restitution_mass"], 0.15, 0.7, lambda q, at: entry("restitution_mass", exponent=-q)),
    "slip_friction": (["slip_friction"], 1.0, 8.0, lambda q, at: entry("slip_friction", ratio=1.0 + q)),
    "low_friction": (["low_friction"], 0.3, 0.45, lambda q, at: entry("low_friction", friction=max(0.65 - q, 0.02), **{"from": at[0], "to": at[1]})),
    "roughness": (["roughness"], 0.05, 0.32, lambda q, at: entry("roughness", amplitude=q)),
    "soil_patch": (["soil_patch"], 0.1, 1.0, lambda q, at: entry("soil_patch", rolling=0.05 + q, **{"from": at[0], "to": at[1]})),
    "forest_drag": (["forest_drag"], 200.0, 2400.0, lambda q, at: entry("forest_drag", coefficient=q, **{"from": at[0], "to": at[1]})),
    "block_shape longer": (["block_shape"], 0.15, 1.1, lambda q, at: entry("block_shape", elongation=1.0 + q)),
    "block_shape sharper": (["block_shape"], 0.2, 0.6, lambda q, at: entry("block_shape", corners=1.0 - q)),
    "block_shape rounder": (["block_shape"], 0.3, 3.0, lambda q, at: entry("block_shape", corners=1.0 + q)),
    "trees": (["forest_drag"], 200.0, 1900.0, lambda q, at: entry("trees", density=q)),
    "release_motion": (["release_motion"], 2.0, 6.4, lambda q, at: entry("release_motion", speed=q)),
    "fragmentation": (["fragmentation"], 0.1, 0.3, lambda q, at: entry("fragmentation", speed=1.0 / q)),
    "friction_speed": (["friction_speed"], 0.3, 0.9, lambda q, at: entry("friction_speed", limit=1.0 - q, speed=4.0)),
    "soil_scatter": (["soil_scatter"], 0.3, 1.6, lambda q, at: entry("soil_scatter", rolling=q)),
}


def law(number, q, at=(0.0, 0.0)):
    return entry("own_law", library="laws.so", a=number, b=q, c=at[0], d=at[1])


SAME_FAMILY = {
    "drag as v^1.5": (["ground_drag"], 0.5, 20.0, lambda q, at: law(1, q)),
    "drag of a plough": (["ground_drag"], 0.5, 50.0, lambda q, at: law(2, q)),
    "bounce falls exponentially with speed": (["restitution_half_speed"], 1.0, 30.0, lambda q, at: law(3, q)),
    "bounce falls with momentum": (["restitution_half_speed", "restitution_mass"], 1.0, 50.0, lambda q, at: law(4, q)),
    "rolling resistance saturates with speed": (["rolling_speed"], 0.2, 10.0, lambda q, at: law(5, q)),
    "rolling resistance linear in size": (["rolling_size"], 0.5, 2.4, lambda q, at: law(6, q)),
    "shrubs on a reach": (["forest_drag", "ground_drag"], 0.5, 30.0, lambda q, at: law(7, q, at)),
    "patch with soft borders": (["soil_patch"], 1.0, 30.0, lambda q, at: law(8, q, at)),
    "friction weakens with speed": (["friction_speed"], 0.3, 20.0, lambda q, at: law(21, q)),
    "every block has its own rolling resistance": (["soil_scatter"], 0.5, 4.0, lambda q, at: law(22, q)),
}
OUTSIDE = {
    "bounce grows with speed": ([], 0.3, 5.0, lambda q, at: law(23, q)),
    "rolling resistance weakens with spin": ([], 0.3, 30.0, lambda q, at: law(24, q)),
    "stripes of friction": ([], 0.3, 0.95, lambda q, at: law(25, q)),
    "drag that fades with speed": ([], 0.3, 20.0, lambda q, at: law(26, q)),
    "friction falls with mass": ([], 0.1, 0.8, lambda q, at: law(27, q)),
    "soil shears off under hard impacts": ([], 0.3, 20.0, lambda q, at: law(28, q)),
    "bounce grows where impacts graze": ([], 0.5, 8.0, lambda q, at: law(29, q)),
    "bounce on stones in the soil": ([], 0.2, 1.0, lambda q, at: law(30, q)),
    "rolling resistance of gentle ground": ([], 0.5, 20.0, lambda q, at: law(31, q)),
    "rolling resistance grows down the slope": ([], 0.5, 4.0, lambda q, at: law(32, q)),
    "drag that spares what rolls": ([], 0.3, 20.0, lambda q, at: law(33, q)),
    "hollows catch what rolls": ([], 0.5, 10.0, lambda q, at: law(34, q)),
}
FAULTS = {  # done to what was measured; the strength in the unit of the fault
    "speed_bias": (["speed_error"], 0.1, 0.32),
    "speed_noise": (["speed_error"], 1.0, 8.0),
    "screen_shift": (["screen_shift"], 3.0, 6.0),
    "slow_missed": (["slow_missed"], 2.0, 6.4),
    "ids_shuffled": (["ids_shuffled"], 1.0, 1.0),
    "height_datum": (["height_datum"], 0.3, 2.4),
}
BOUNCES, DRAGS = ("restitution", "bounce"), ("ground_drag", "scar_drag", "drag as", "drag of", "drag that", "shrubs")
LOCAL = ("low_friction", "soil_patch", "forest_drag", "shrubs on a reach", "patch with soft borders")


def is_one_of(names, beginnings):
    return any(name.startswith(beginnings) for name in names)
