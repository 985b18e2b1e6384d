#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Throws the blocks of a folder with Siconos' standard runner: what a user of Debian's packages does. Called by compare_siconos.sh.

Usage: siconos_runner.py FOLDER TERRAIN OUT.csv NAME --clock PROGRAM [--blocks N] [--every K] [--step H] [--time T] [-e E] [--mu MU] [--mu-r MU_R]

MechanicsHdf5Runner with its Bullet collision: a height map, a convex shape, the rolling-friction law, the runner's own defaults for solver and Newton loop.
Margins: none for the ground, 2 cm inside the block. With the defaults (2 % of the sides) the ground would lie most of a metre too low, without any
the normals are poor. The runner itself never stops at rest: it is stopped by the rule of siconos_blocks.cpp, looked at every tenth step.
"""
import argparse
import csv
import os
import subprocess
import tempfile
import time

import numpy as np
from siconos.io.mechanics_run import MechanicsHdf5Runner
from siconos.mechanics.collision.tools import Contactor

GRAVITY = 9.80665  # [m/s^2]
START = -80.0  # easting of s = 0 [m]
LINES = (39.5, 48.5)  # s where speed is taken [m]
REST_HEAD = 1e-6  # [m]
REST_TIME = 0.05  # [s]
BLOCK_MARGIN = 0.02  # inside the block's surface [m]


class AtRest(Exception):
    """Ends a run."""


class RestHook:
    """Raises AtRest when kinetic energy per weight has been small for a while."""

    def __init__(self, mass, inertia, step):
        self.mass, self.inertia, self.step = mass, max(inertia), step
        self.count = self.still = 0

    def __call__(self, runner):
        self.count += 1
        if self.count % 10:
            return
        twist = runner._io.velocities(runner._nsds)[0, 1:7]
        energy = 0.5 * self.mass * twist[:3] @ twist[:3] + 0.5 * self.inertia * twist[3:] @ twist[3:]
        slow = energy < REST_HEAD * self.mass * GRAVITY and self.count * self.step > 0.5
        self.still = self.still + 10 * self.step if slow else 0.0
        if self.still > REST_TIME:
            raise AtRest


def read_terrain(path):
    """Heights as [column][row from the south], lower left node, cell."""
    with open(path) as file:
        head = {key.lower(): float(value) for key, value in (file.readline().split() for _ in range(6))}
        heights = np.loadtxt(file)
    return heights[::-1].T.copy(), head["xllcorner"], head["yllcorner"], head["cellsize"]


def throw(file, row, points, terrain, options):
    heights, x, y, cell = terrain
    extent = [(n - 1) * cell for n in heights.shape]
    mass, inertia = float(row["mass"]), [float(row[k]) for k in ("I1", "I2", "I3")]
    with MechanicsHdf5Runner(io_filename=file, verbose=False) as io:
        io.add_height_map("terrain", heights, extent, insideMargin=0.0, outsideMargin=0.0)
        io.add_convex_shape("hull", points, insideMargin=BLOCK_MARGIN, outsideMargin=0.0)
        io.add_Newton_impact_rolling_friction_nsl("law", e=options.e, mu=options.mu, mu_r=options.mu_r)
        io.add_object("ground", [Contactor("terrain")], translation=[x + 0.5 * extent[0], y + 0.5 * extent[1], 0.0])
        io.add_object("block", [Contactor("hull")], translation=[float(row[k]) for k in "xyz"],
                      orientation=[float(row[k]) for k in ("qw", "qx", "qy", "qz")], mass=mass, inertia=inertia)
        try:
            io.run(T=options.time, h=options.step, theta=0.5, verbose=False, verbose_progress=False,
                   output_frequency=options.every, end_run_iteration_hook=RestHook(mass, inertia, options.step))
        except AtRest:
            pass
        return io.dynamic_data()[:], io.velocities_data()[:]


def outcome(positions, velocities):
    """Columns of outcomes.csv from the runner's own output."""
    velocities = velocities[velocities[:, 0] > 0.0]
    s, speed = np.interp(velocities[:, 0], positions[:, 0], positions[:, 2]) - START, np.linalg.norm(velocities[:, 2:5], axis=1)
    at_lines = []
    for line in LINES:
        after = int(np.argmax(s >= line))
        if s[after] < line or after == 0:
            at_lines.append(float("nan"))
            continue
        share = (line - s[after - 1]) / (s[after] - s[after - 1])
        at_lines.append(speed[after - 1] + share * (speed[after] - speed[after - 1]))
    return [s[-1], abs(positions[-1, 3]), speed.max(), *at_lines, positions[-1, 0]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("folder", "terrain", "out", "name"):
        parser.add_argument(name)
    parser.add_argument("--clock", required=True, help="program that prints the dependent additions per second of this core")
    parser.add_argument("--blocks", type=int, default=10**6)
    parser.add_argument("--every", type=int, default=1, help="output every so many steps; 1 is the runner's own default")
    parser.add_argument("--step", type=float, default=1e-3)
    parser.add_argument("--time", type=float, default=15.0)
    parser.add_argument("-e", type=float, default=0.0)
    parser.add_argument("--mu", type=float, default=0.5)
    parser.add_argument("--mu-r", type=float, default=0.04)
    options = parser.parse_args()
    clock = lambda: float(subprocess.run([options.clock, "clock"], check=True, capture_output=True, text=True).stdout)
    terrain = read_terrain(options.terrain)
    with open(os.path.join(options.folder, "blocks.csv")) as file:
        rows = list(csv.DictReader(file))[:options.blocks]
    seconds = additions = steps = 0.0
    with open(options.out, "w") as out, tempfile.TemporaryDirectory() as work:
        out.write("model,block,stop_s,abs_y,v_max,v_at_s39_5,v_at_s48_5,t_end\n")
        for row in rows:
            points = np.loadtxt(os.path.join(options.folder, f"hull_{int(row['block']):02d}.csv"), delimiter=",", skiprows=1)
            before, start = clock(), time.process_time()
            positions, velocities = throw(os.path.join(work, f"{row['block']}.hdf5"), row, points, terrain, options)
            taken = time.process_time() - start
            seconds += taken
            additions += taken * 0.5 * (before + clock())
            values = outcome(positions, velocities)
            steps += values[-1] / options.step
            out.write(",".join([options.name, row["block"], *(f"{v:.6f}" for v in values)]) + "\n")
            out.flush()
    n = len(rows)
    print(f"blocks {n}\ncpu_s_per_block {seconds / n:.6g}\nadditions_per_block {additions / n:.6g}\nsteps_per_block {steps / n:.1f}")


main()
