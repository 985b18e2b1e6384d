#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws blind cases for `scree diagnose`: a slope, a model, a field test, and something hidden in it, or nothing.

Usage: generate.py SCREE FOLDER --seed N [--first N] [--cases N] [--slopes SET] [--tiers 0,1,...] [--count N] [--threads N]

Writes FOLDER/cases/NNNN/{site.toml, blocks.csv, observed/} for the finder, FOLDER/sites/ with the slopes, FOLDER/sealed/NNNN.json with what is
hidden, and FOLDER/sealed.sha256 with the hash of each sealed file. What is hidden is drawn from sha256(seed, number of the case).
A case that is sealed is not drawn again; its field test, where it is absent, is thrown again from the truth, as it was. Of Scree it uses
the program alone, to throw the blocks of the truth (`scree run`); everything from tier 1 up comes from formulas of its own (laws.cpp, compiled
here) or is done to the measured values here.

Strength: delta, the signal-to-noise ratio that a perfect linear test of this field test would have for the hidden effect after a recalibration of the model:
sqrt(n d' P d), d the change of the means of what is measured of a block (with its squares, its products with the logarithm of the mass, and where it stops), P the inverse of their
covariance with the span of the parameters' derivatives projected out, after a recalibration. The strength is solved for the value drawn, 2 to 9, with the least of the values
at the model's parameters and along Gauss-Newton steps from there, derivatives and covariance those at the model's parameters. The value for the record comes from other blocks
(--count of them) and from a recalibration that searches all over the ranges of the parameters, in the covariance of each model that it looks at; where it is far from the value
drawn the strength is corrected. What is not seen at all, with a delta below 1.5 at any strength, is drawn anew.
"""
import argparse
import csv
import hashlib
import json
import math
import os
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import terrains  # ends here as skipped where numpy or GDAL's module is absent
import numpy as np
from hidden import BOUNCES, DRAGS, FAULTS, LOCAL, OUTSIDE, SAME_FAMILY, SAME_FORMULA, is_one_of
from seals import hash_of, seals, write_whole

HERE = Path(__file__).resolve().parent
COUNT = 1000  # simulated blocks behind a delta
EPOCH = 1e9  # of all files of a case

TIME_STEP = 16e-3           # [s] of truth and model alike: its statistics differ from those of the default by less than a case can see
DELTAS = (2.0, 3.0, 4.5, 6.0, 9.0)  # to be reached
LEAST_DELTA, ATTEMPTS = 1.5, 4  # what reaches less is drawn anew, up to so many draws
LEAVING = 30  # draws among which there must be one in which no block leaves the terrain
# chance of a tier: 5 is "nothing hidden"
TIERS = {0: 0.12, 1: 0.22, 2: 0.06, 3: 0.12, 4: 0.05, 5: 0.34, 6: 0.09}
START = {"restitution": 0.1, "friction": 0.6, "rolling": 0.05}  # of the site that the finder gets
POSITION_ERROR, SPEED_ERROR, HEIGHT_ERROR, SPIN_ERROR = 0.2, (0.05, 0.2), 0.1, 0.3
NOISE = (0.5, 2.0)          # all of these times a factor between these
# what a recalibration moves: step of the derivatives (of a logarithm for rolling), least and largest value, which are those of a diagnosis that is told nothing else
ABSORBING = {"restitution": (0.05, 0.0, 0.4), "friction": (0.08, 0.3, 0.9), "rolling": (math.log(1.3), 0.002, 0.15)}
RECALIBRATIONS = 3  # steps with the derivatives at the model's parameters
SEARCHED, ALONG, GENERATIONS, POPULATION, ELITE = 400, 6, 7, 16, 5  # blocks of a point in the search all over the ranges, points of a line; cross-entropy method
CORRECTIONS = 2  # of a strength whose settled delta is less than two thirds or more than one and a half times the value drawn
RANGE = 6.0
IMPACTS = 3  # first ones of a block that are filmed where they are; before and after each: speed and vertical speed
IMPACT_FIELDS = ("speed_before_ms", "rise_before_ms", "speed_after_ms", "rise_after_ms")
FILMED = IMPACTS * len(IMPACT_FIELDS)
LARGEST_CHANGE = 1.5  # of a mean by an effect, in standard deviations of a block: what is larger nobody would call a disagreement after calibration
SHIFTS = (-6.0, -4.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.0, 4.0, 6.0)


def whitening(rows):
    """Makes the mean of such rows a vector of independent numbers of variance 1 per row."""
    covariance = np.cov(rows.T)
    covariance += np.diag(np.maximum(1e-3, 0.5 - np.diag(covariance)))  # what does not vary here has no certainty for that
    return np.linalg.inv(np.linalg.cholesky(covariance))


def easting(point):
    """Of a point of a GeoPackage, little-endian and without envelope: 8 bytes of header, 5 of well-known binary, then x and y."""
    if point[:4] != b"GP\0\1" or point[8] != 1:
        sys.exit("results.gpkg: its points are laid out in another way than is read here")
    return struct.unpack_from("<d", point, 13)[0]


def bounded(curvature, slope, low, high):
    """The x between low and high at which x'Ax / 2 - b'x is least, one coordinate after the other."""
    x = np.zeros(len(slope))
    for _ in range(300):
        for k in range(len(x)):
            x[k] = min(max(x[k] + (slope[k] - curvature[k] @ x) / curvature[k, k], low[k]), high[k])
    return x


class Case:
    def __init__(self, args, number):
        self.args, self.number = args, number
        self.random = self.chance_of()
        r = self.random
        tiers = {t: p for t, p in TIERS.items() if t in args.tiers}
        self.tier = int(r.choice(list(tiers), p=np.array(list(tiers.values())) / sum(tiers.values())))
        self.slope = str(r.choice(terrains.SETS[args.slopes]))
        self.n = int(r.choice([30, 50, 100], p=[0.1, 0.8, 0.1]))
        self.n = args.blocks or self.n
        self.ids = bool(r.uniform() < 0.7)
        self.instruments = ["stops", "speed"] + (["height", "spin"] if self.ids and r.uniform() < 0.6 else [])
        if "height" in self.instruments and r.uniform() < 0.5:
            self.instruments.append("impacts")
        self.blocks = self.draw_blocks(self.n)
        self.noise = float(math.exp(r.uniform(*np.log(NOISE))))
        self.measured = self.ids, self.instruments  # unless what is hidden asks for more
        self.draw_hidden()

    def draw_hidden(self):
        """Soils, what is hidden, where, and the delta that it shall have."""
        r = self.random
        self.ids, self.instruments = self.measured
        self.soils = {name: {"restitution": float(0.0 if r.uniform() < 0.25 else r.uniform(0.05, 0.35)), "friction": float(r.uniform(0.45, 0.8)),
                             "rolling": float(math.exp(r.uniform(math.log(0.02), math.log(0.09))))} for name in ("slope", "floor")}
        first = terrains.SLOPES[self.slope]["screens"][0]
        start = float(r.uniform(first - 12.0, terrains.SLOPES[self.slope]["floor"] - 10.0))
        self.at = (round(start, 1), round(start + float(r.uniform(6.0, 15.0)), 1))
        self.target = float(r.choice(DELTAS))
        self.fault, self.effects = None, []
        table = {0: SAME_FORMULA, 1: SAME_FAMILY, 3: OUTSIDE, 6: FAULTS}.get(self.tier)
        names = []
        if table:
            names = [str(r.choice(list(table)))]
            if names[0] == "ids_shuffled":
                self.ids = True
            if names[0] == "height_datum":
                self.ids = True
                self.instruments = ["stops", "speed", "height", "spin"] + [i for i in self.instruments if i == "impacts"]
        elif self.tier == 2:
            table = SAME_FAMILY
            while len(names) < 2 or set(table[names[0]][0]) & set(table[names[1]][0]) or (is_one_of(names, BOUNCES) and is_one_of(names, DRAGS)):
                names = [str(name) for name in r.choice(list(table), 2, replace=False)]
        if self.tier == 6:
            self.fault = [names[0], 0.0]
        else:
            self.effects = [[name, table[name], 0.0] for name in names]
        if is_one_of(names, DRAGS):  # invisible where blocks bounce
            for soil in self.soils.values():
                soil["restitution"] = min(soil["restitution"], 0.05)
        if is_one_of(names, BOUNCES):  # invisible without a bounce
            for soil in self.soils.values():
                soil["restitution"] = max(soil["restitution"], 0.2)

    def take(self, truth):
        """What was drawn for a truth."""
        self.tier, self.slope, self.ids, self.instruments, self.noise, self.soils = (truth[key] for key in ("tier", "slope", "ids", "instruments", "noise", "soils"))
        if truth["n"] != self.n:
            self.n = truth["n"]
            self.blocks = self.draw_blocks(self.n)
        self.fault = [truth["hidden"][0]["name"], truth["hidden"][0]["strength"]] if self.tier == 6 else None

    def chance_of(self, purpose=""):
        return np.random.default_rng(list(hashlib.sha256(f"{self.args.seed}/{self.number}{purpose}".encode()).digest()))

    def speed_error(self, speed):
        return self.noise * (SPEED_ERROR[0] * speed + SPEED_ERROR[1])

    def impact_error(self, before, after):
        """Of all four values of an impact, which states one error."""
        return self.speed_error(np.maximum(before, after))

    def draw_blocks(self, count):
        r, rows = self.random, []
        for k in range(count):
            volume = math.exp(r.uniform(math.log(0.06), math.log(0.8)))
            b, c = r.uniform(0.6, 1.0), r.uniform(0.5, 0.9)  # L2/L1, L3/L2
            longest = (volume / 0.55 / (b * b * c)) ** (1.0 / 3.0)  # a hull fills about 55 % of its box
            rows.append([f"B{k + 1:03d}", round(2600.0 * volume, 1), round(longest, 3), round(longest * b, 3), round(longest * b * c, 3)])
        return rows

    # ---- site files ----

    def site(self, sites, soils, effects, blocks, count, seed, dimension=2, extra=()):
        screens = terrains.SLOPES[self.slope]["screens"]
        chainages = ", ".join(f"{name} = {x - 1.5}" for name, x in [(f"ES{k + 1}", x) for k, x in enumerate(screens)] + list(extra))
        text = f'[site]\nname = "Case {self.number:04d}"\n\n[terrain]\ndtm = "{sites}/dtm.tif"\nresolution = 1.0\n\n'
        for name, soil in soils.items():
            text += f'[[soil]]\nname = "{name}"\n' + "".join(f"{key} = {value!r}\n" for key, value in soil.items()) + "\n"
        text += f'[zones]\nfile = "{sites}/zones.gpkg"\nfield = "soil"\ndefault = "slope"\n\n'
        text += f'[blocks]\nlist = "{blocks}"\norder = "in_turn"\n\n[release]\nfile = "{sites}/release.gpkg"\ncount = {count}\nheight = 2.0\n\n'
        text += f'[profile]\nmode = "line"\nguide = "{sites}/line.gpkg"\nhead = 0.0\n\n' if dimension == 2 else ""
        text += f"[model]\ndimension = {dimension}\ntime_step = {TIME_STEP}\nseed = {seed}\n\n"
        text += f'[screens]\nchainages = "{chainages}"\n\n' if dimension == 2 else f'[screens]\nfile = "{sites}/screens.gpkg"\n\n'
        text += '[observed]\naxis = "azimuth"\nazimuth_deg = 90.0\nlateral = false\n\n'
        text += "".join(effects)
        return text + "[output]\ntrajectories = 0\n" + (f"impacts = {IMPACTS}\n" if "impacts" in self.instruments else "")

    def throw(self, work, count, seed, soils=None, effects=(), dimension=2, every=False):
        """Blocks of a truth: rows (mass, s, per screen speed, height, spin; NaN where not passed; then what films of impacts show), and the extra screens of shifts.

        With `every`, each block of the case once in its order; else the blocks of the case again and again."""
        folder = Path(tempfile.mkdtemp(dir=work))
        with open(folder / "blocks.csv", "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["block_id", "mass_kg", "L1_m", "L2_m", "L3_m"], *self.blocks])
        shutil.copy(work / "laws.so", folder)
        extra = []
        if self.fault and self.fault[0] == "screen_shift" and dimension == 2:
            extra = [(f"x{k}", terrains.SLOPES[self.slope]["screens"][1] + shift) for k, shift in enumerate(SHIFTS)]
        (folder / "site.toml").write_text(self.site(self.args.folder.resolve() / "sites" / self.slope, soils or self.soils, effects, "blocks.csv",
                                                    count, seed, dimension, extra))
        done = subprocess.run([self.args.scree, "run", str(folder / "site.toml"), "--output", str(folder / "out"), "--quiet", "--threads",
                               str(self.args.threads)], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"case {self.number}: {done.stderr}")
        # by SQL: reading the layers feature by feature is up to a third of the time of a throw
        results = sqlite3.connect(folder / "out" / "results.gpkg")
        names = [f"ES{k + 1}" for k in range(2)] + [name for name, _ in extra]
        stops = results.execute("SELECT block, block_id, mass_kg, geom FROM stopping_points ORDER BY block").fetchall()
        self.left = results.execute("SELECT count(*) FROM stopping_points WHERE stop_reason = 'left_terrain'").fetchone()[0]  # of the blocks thrown last
        values = np.full((len(stops), 2 + 3 * len(names) + FILMED), np.nan)
        at = {block: row for row, (block, *_) in enumerate(stops)}
        for block, _, mass, point in stops:
            values[at[block], :2] = mass, easting(point) - terrains.EAST
        for screen, block, *passing in results.execute("SELECT screen, block, speed_ms, height_m, spin_rads FROM screen_crossings ORDER BY fid DESC"):
            k = 2 + 3 * names.index(screen)
            values[at[block], k:k + 3] = passing  # last that of the first crossing
        if "impacts" in self.instruments:
            for impact, block, *filmed in results.execute(f"SELECT impact, block, {', '.join(IMPACT_FIELDS)} FROM impacts ORDER BY fid"):
                k = values.shape[1] - FILMED + len(IMPACT_FIELDS) * (impact - 1)
                values[at[block], k:k + len(IMPACT_FIELDS)] = filmed
        results.close()
        ids = [name for _, name, _, _ in stops]
        shutil.rmtree(folder)
        if every and sorted(ids) != sorted(row[0] for row in self.blocks):
            sys.exit(f"case {self.number}: the truth threw other blocks than the case has")
        return values, ids

    # ---- measuring ----

    def measure(self, values, random, fault=None):
        """What instruments and their faults make of it: noise added, columns of the two screens and of the impacts only."""
        v = np.concatenate([values[:, :8], values[:, -FILMED:]], axis=1)
        position_error, height_error, spin_error = (self.noise * e for e in (POSITION_ERROR, HEIGHT_ERROR, SPIN_ERROR))
        name, q = fault or (None, 0.0)
        if name == "screen_shift" and q:
            k = int(np.argmin(np.abs(np.array(SHIFTS) - q)))
            v[:, 5:8] = values[:, 8 + 3 * k:11 + 3 * k]
        for k in range(2):
            speed, height, spin = (v[:, 2 + 3 * k + i] for i in range(3))
            slow = speed < q if name == "slow_missed" else np.zeros(len(v), dtype=bool)
            speed += self.speed_error(speed) * random.standard_normal(len(v))
            if name == "speed_bias":
                speed *= 1.0 + q
            if name == "speed_noise":
                speed += q * random.standard_normal(len(v))
            np.maximum(speed, 0.0, out=speed)
            height += height_error * random.standard_normal(len(v)) + (q if name == "height_datum" else 0.0)
            spin += spin_error * random.standard_normal(len(v))
            np.maximum(spin, 0.0, out=spin)
            v[slow, 2 + 3 * k:5 + 3 * k] = np.nan
        if "impacts" in self.instruments:
            for first in range(8, 8 + FILMED, len(IMPACT_FIELDS)):
                error = self.impact_error(v[:, first], v[:, first + 2])
                for k in (first, first + 2):
                    speed, rise = v[:, k], v[:, k + 1]
                    for one in (speed, rise):
                        one += error * random.standard_normal(len(v))
                        if name == "speed_bias":
                            one *= 1.0 + q
                    if name == "speed_noise":
                        speed += q * random.standard_normal(len(v))
                    np.maximum(speed, 0.0, out=speed)
        v[:, 1] += position_error * random.standard_normal(len(v))
        if name == "ids_shuffled" and q > 0.0:
            some = np.flatnonzero(random.uniform(size=len(v)) < q)
            self.taken_for = np.arange(len(v))  # rows of the blocks that these are taken for
            self.taken_for[some] = random.permutation(some)
            v[:, 0] = v[self.taken_for, 0]
        return v

    def features(self, v, scale):
        """Per block: whether it stops before or between the screens; what is measured and its squares; products of all with log mass. An empty list of scales is
        filled from these blocks."""
        first, second = (np.isfinite(v[:, k]).astype(float) for k in (2, 5))
        shares, measured = [first, first - second], [v[:, 1]]  # one and the other screen say the same of most blocks: their difference is a share of its own
        for k in range(2):
            measured.append(np.nan_to_num(v[:, 2 + 3 * k]))
            if "height" in self.instruments:
                measured += [np.nan_to_num(v[:, 3 + 3 * k]), np.nan_to_num(v[:, 4 + 3 * k])]
        if "impacts" in self.instruments:
            measured += [np.nan_to_num(v[:, k]) for k in range(8, 8 + FILMED)]
        x = np.stack(shares + measured, axis=1)
        if not scale:  # a share of all or nothing can move by no less than one of the n blocks without its being news
            alike = np.array([len(np.unique(c)) < 2 for c in x.T])
            alike[:len(shares)] = True
            scale += [x.mean(axis=0), np.maximum(x.std(axis=0), np.where(alike, self.n ** -0.5, 1e-6))]
        x = (x - scale[0]) / scale[1]
        mass = np.log(v[:, 0])
        mass = (mass - mass.mean()) / mass.std()
        return np.concatenate([x, x[:, len(shares):] ** 2] + ([x * mass[:, None]] if self.ids else []), axis=1)

    def detectability(self, work):
        """A function from effects and fault to delta."""
        scale = []
        seed = int(self.random.integers(1, 2 ** 31))
        noise = [int(self.random.integers(1, 2 ** 31)), 1]

        def sample(soils=None, effects=(), fault=None):
            return self.features(self.measure(self.throw(work, self.args.count, seed, soils, effects)[0], np.random.default_rng(noise), fault), scale)
        base = sample()
        names = [(soil, key) for soil in self.soils for key in ABSORBING]

        def at(steps):
            """The soils so many steps away."""
            soils = json.loads(json.dumps(self.soils))
            for (soil, key), step in zip(names, steps):
                width, low, high = ABSORBING[key]
                moved = soils[soil][key] * math.exp(width * step) if key == "rolling" else soils[soil][key] + width * step
                soils[soil][key] = float(min(max(moved, low), high))
            return soils
        whiten, one = whitening(base), np.eye(len(names))
        J = whiten @ np.array([(sample(at(one[k])).mean(axis=0) - sample(at(-one[k])).mean(axis=0)) / 2.0 for k in range(len(names))]).T
        # with ranges of about RANGE steps: what the test hardly tells about is not driven far by noise
        steps_of = np.linalg.solve(self.n * J.T @ J + one / RANGE ** 2, self.n * J.T)
        remains = np.eye(base.shape[1]) - J @ steps_of

        def unexplained(difference):
            """Squared, per block, less what chance adds."""
            left = remains @ whiten @ difference.mean(axis=0)
            return left @ left - np.trace(remains @ whiten @ np.cov(difference.T) @ whiten.T @ remains.T) / self.args.count

        def delta(effects, fault=None):
            hidden, steps, least, model = sample(None, effects, fault), np.zeros(len(names)), math.inf, base
            if effects and np.abs((hidden - base).mean(axis=0)).max() > LARGEST_CHANGE:
                return math.inf
            recalibrations = 0 if self.args.search == "none" else RECALIBRATIONS
            for k in range(1 + recalibrations):  # Gauss-Newton: what a linear recalibration leaves may be less elsewhere
                difference = hidden - model
                least = min(least, unexplained(difference))
                steps = steps + np.clip(steps_of @ whiten @ difference.mean(axis=0), -4.0, 4.0)
                if k < recalibrations:
                    model = sample(at(steps))
            return math.sqrt(self.n * max(least, 0.0))
        return delta

    def settled(self, work, effects, fault=None, rough=False, start=None):
        """delta after a recalibration all over the ranges, and where that has led: along lines through the best point so far (or from a start), then by the cross-entropy method, at last by derivatives. With
        half the blocks and steps it is good enough to correct a strength by."""
        share = 2 if rough else 1
        count, along, generations = self.args.count // share, ALONG // share, GENERATIONS // (share if start is None else 2)
        keys = [(soil, key) for soil in self.soils for key in ABSORBING]
        low, high = (np.array([math.log(ABSORBING[key][k]) if key == "rolling" else ABSORBING[key][k] for _, key in keys]) for k in (1, 2))
        width = np.array([ABSORBING[key][0] for _, key in keys]) / (high - low)
        scale, seeds, chance = [], [int(s) for s in self.random.integers(1, 2 ** 31, 4)], np.random.default_rng(int(self.random.integers(1, 2 ** 31)))

        def soils_at(u):
            soils = {soil: {} for soil in self.soils}
            for (soil, key), value in zip(keys, low + np.clip(u, 0.0, 1.0) * (high - low)):
                soils[soil][key] = float(math.exp(value) if key == "rolling" else value)
            return soils

        def sample(count, seed, u=None, effects=(), fault=None):
            thrown = self.throw(work, count, seed, None if u is None else soils_at(u), effects)[0]
            return self.features(self.measure(thrown, np.random.default_rng(seed + 1), fault), scale)

        sample(count, seeds[0])  # sets the scale
        searched = min(SEARCHED // share, count)
        hidden = sample(searched, seeds[1], None, effects, fault)

        def left(u):
            model = sample(searched, seeds[1], u)
            return float(np.sum((whitening(model) @ (hidden - model).mean(axis=0)) ** 2))
        truth = np.array([math.log(self.soils[soil][key]) if key == "rolling" else self.soils[soil][key] for soil, key in keys])
        best = (truth - low) / (high - low)
        best = min([(left(u), u) for u in ([best] if start is None else [best, start])], key=lambda pair: pair[0])
        lines = [[k for k, (_, key) in enumerate(keys) if key == one] for one in ABSORBING] + [[k] for k in range(len(keys))]
        for axes in lines if start is None and self.args.search == "whole" else []:
            line = np.tile(best[1], (along, 1))
            line[:, axes] = np.linspace(0.04, 0.96, along)[:, None]
            best = min([best] + [(left(u), u) for u in line], key=lambda pair: pair[0])
        mean, deviation = best[1], np.full(len(keys), 0.06)
        for _ in range(0 if self.args.search == "none" else generations):
            elite = sorted([(left(u), u) for u in np.clip(mean + deviation * chance.standard_normal((POPULATION, len(keys))), 0.0, 1.0)],
                           key=lambda pair: pair[0])[:ELITE]
            best = min(best, elite[0], key=lambda pair: pair[0])
            chosen = np.array([u for _, u in elite] + [best[1]])
            mean, deviation = chosen.mean(axis=0), np.maximum(0.6 * chosen.std(axis=0) + 0.35 * deviation, 0.005)
        hidden = sample(2 * count, seeds[3], None, effects, fault)
        ends = [(sample(2 * count, seeds[2], u), u) for u in (mean, best[1])]  # the least of many small samples is a lucky one
        model, place = min(ends, key=lambda end: np.sum((whitening(end[0]) @ (hidden.mean(axis=0) - end[0].mean(axis=0))) ** 2))
        whiten = whitening(model)
        J = []
        for k in range(len(keys)):
            sides = [np.clip(place + sign * width * (np.arange(len(keys)) == k), 0.0, 1.0) for sign in (-1.0, 1.0)]
            J.append((sample(count, seeds[2], sides[1]) - sample(count, seeds[2], sides[0])).mean(axis=0) * width[k] / (sides[1] - sides[0])[k])
        J, difference = whiten @ np.array(J).T, whiten @ (hidden.mean(axis=0) - model.mean(axis=0))
        # parameters end where their ranges do: what a step beyond would explain is not explained
        steps = bounded(self.n * J.T @ J + np.eye(len(keys)) / RANGE ** 2, self.n * J.T @ difference, -place / width, (1.0 - place) / width)
        free = (steps > -place / width) & (steps < (1.0 - place) / width)
        inner = J[:, free]
        remains = np.eye(len(J)) - inner @ np.linalg.solve(self.n * inner.T @ inner + np.eye(inner.shape[1]) / RANGE ** 2, self.n * inner.T)
        rest = remains @ (difference - J[:, ~free] @ steps[~free])
        by_chance = sum(np.trace(remains @ whiten @ np.cov(end.T) @ whiten.T @ remains.T) / len(end) for end in (model, hidden))
        return math.sqrt(self.n * max(float(rest @ rest) - by_chance, 0.0)), np.clip(place + width * steps, 0.0, 1.0)

    def solve(self, strength_to_delta, start, largest):
        """The strength that has the target, and its delta; the nearest within its range if none has."""
        low, high, q = 0.0, None, min(start, largest)
        best = (math.inf, q, 0.0)
        for _ in range(7):
            d = strength_to_delta(q)  # infinite: too strong
            if abs(d - self.target) < best[0]:
                best = (abs(d - self.target), q, d)
            if abs(d - self.target) < 0.1 * self.target:
                break
            if d < self.target:
                low = q
                if q >= largest:
                    break
                q = min(largest, 2.0 * q if high is None else 0.5 * (low + high))
            else:
                high = q
                q = 0.5 * (low + high)
        return best[1:]

    def correct(self, settled, q, largest):
        """Of the strengths that are tried the one whose settled delta is nearest to the target, and where the recalibration has led there."""
        tried, place = [], None
        for _ in range(1 + CORRECTIONS):
            reached, place = settled(q, place)
            tried.append((abs(math.log(max(reached, 1e-3) / self.target)), q, reached, place))
            if self.target / 1.5 < reached < 1.5 * self.target:
                break
            if reached < self.target and (q >= largest or (len(tried) > 1 and q > tried[-2][1] and reached < tried[-2][2])):
                q = min(t[1] for t in tried) / 3.0  # more of it may be absorbed the better: a restitution that has fallen to nothing
            else:
                q = float(min(largest, q * min(max(self.target / max(reached, 1e-9), 1.0 / 3.0), 3.0)))
        _, q, _, place = min(tried, key=lambda t: t[0])
        return q, place

    # ---- the whole ----

    def hide(self, work):
        """The truth, with strengths that have the delta that was drawn. What cannot be seen, or makes blocks leave the terrain, is drawn anew."""
        unseen = 0
        for _ in range(LEAVING):
            truth = {"case": self.number, "tier": self.tier, "slope": self.slope, "n": self.n, "ids": self.ids, "instruments": self.instruments, "noise": self.noise,
                     "soils": self.soils, "hidden": [], "target": self.target if self.tier not in (4, 5) else None}
            if self.all_stay(work, truth):
                truth["hidden"] = self.hidden(work)
                if self.all_stay(work, truth):
                    seen = all(h["delta"] is None or h["delta"] >= LEAST_DELTA for h in truth["hidden"])
                    unseen += not seen
                    if seen or unseen == ATTEMPTS or self.args.search == "none":
                        return truth
            self.draw_hidden()
        sys.exit(f"case {self.number}: blocks leave the terrain whatever is drawn")

    def all_stay(self, work, truth):
        self.field_test(work, truth)
        return self.left == 0

    def hidden(self, work):
        """What a truth has hidden; with the delta near the parameters alone where not even that can be seen."""
        hidden, whole = [], self.args.search == "whole"
        if self.effects or self.fault:
            delta = self.detectability(work)
        for effect in self.effects:
            name, (families, start, largest, text), _ = effect
            effect[2], reached = self.solve(lambda q: delta([text(q, self.at)]), start, largest)
            place = None
            if whole and reached >= LEAST_DELTA:
                effect[2], place = self.correct(lambda q, at: self.settled(work, [text(q, self.at)], rough=True, start=at), effect[2], largest)
            if reached >= LEAST_DELTA or not whole:
                reached, _ = self.settled(work, [text(effect[2], self.at)], start=place)  # from other blocks than those that the strength was chosen with
            hidden.append({"name": name, "families": families, "strength": effect[2], "delta": reached,
                           "at": self.at if name in LOCAL else None, "entry": text(effect[2], self.at)})
        if self.fault:
            families, start, largest = FAULTS[self.fault[0]]
            place = None
            if self.fault[0] == "screen_shift":
                sign = 1.0 if self.random.uniform() < 0.5 else -1.0
                options = [(abs(delta((), ("screen_shift", s)) - self.target), s) for s in SHIFTS if s * sign > 0]
                self.fault[1] = min(options)[1]
            else:
                self.fault[1], _ = self.solve(lambda q: delta((), (self.fault[0], q)), start, largest)
                if whole:
                    self.fault[1], place = self.correct(lambda q, at: self.settled(work, (), (self.fault[0], q), rough=True, start=at), self.fault[1], largest)
            reached, _ = self.settled(work, (), tuple(self.fault), start=place)
            hidden.append({"name": self.fault[0], "families": families, "strength": self.fault[1], "delta": reached, "at": None})
        if self.tier == 4:
            hidden.append({"name": "three dimensions", "families": ["third_dimension"], "strength": None, "delta": None, "at": None})
        return hidden

    def field_test(self, work, truth):
        """What was measured of a truth, the same whenever it is thrown, and the ids of the blocks."""
        random = self.chance_of("/thrown")
        fault = (truth["hidden"][0]["name"], truth["hidden"][0]["strength"]) if self.fault and truth["hidden"] else None
        effects = [hidden["entry"] for hidden in truth["hidden"] if "entry" in hidden]
        values, ids = self.throw(work, self.n, int(random.integers(1, 2 ** 31)), None, effects, 3 if self.tier == 4 else 2, every=True)
        return self.measure(values, random, fault), ids

    def write(self, work, truth):
        measured, ids = self.field_test(work, truth)
        case = self.args.folder / "cases" / f"{self.number:04d}"
        shutil.rmtree(case, ignore_errors=True)
        self.write_tables(case, measured, ids)
        soils = {name: dict(START) for name in self.soils}
        (case / "site.toml").write_text(self.site(f"../../sites/{self.slope}", soils, (), "blocks.csv", self.n, 1))  # last: the case is whole

    def write_tables(self, case, measured, ids):
        (case / "observed").mkdir(parents=True)
        names = ids
        if self.fault and self.fault[0] == "ids_shuffled":
            names = [ids[row] for row in self.taken_for]
        rows = sorted(zip(names, measured.tolist()))
        with open(case / "blocks.csv", "w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([["block_id", "mass_kg", "L1_m", "L2_m", "L3_m"], *self.blocks])
        with open(case / "observed" / "stopping_points.csv", "w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow((["block_id"] if self.ids else []) + ["easting_m", "northing_m", "crs", "position_error_m"])
            for name, v in rows:
                table.writerow(([name] if self.ids else []) + [f"{terrains.EAST + v[1]:.2f}", f"{terrains.NORTH + terrains.width_of(self.slope) / 2:.2f}", f"EPSG:{terrains.EPSG}",
                                                              f"{self.noise * POSITION_ERROR:.3f}"])
        with open(case / "observed" / "screen_crossings.csv", "w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            more = "height" in self.instruments
            table.writerow(["screen"] + (["block_id"] if self.ids else []) + ["speed_ms", "speed_error_ms"]
                           + (["height_m", "height_error_m", "spin_rads", "spin_error_rads"] if more else []))
            for k in range(2):
                for name, v in rows:
                    speed, height, spin = v[2 + 3 * k:5 + 3 * k]
                    if math.isfinite(speed):
                        table.writerow([f"ES{k + 1}"] + ([name] if self.ids else []) + [f"{speed:.2f}", f"{self.speed_error(speed):.2f}"]
                                       + ([f"{height:.2f}", f"{self.noise * HEIGHT_ERROR:.3f}", f"{spin:.2f}", f"{self.noise * SPIN_ERROR:.3f}"] if more else []))
        if "impacts" not in self.instruments:
            return
        with open(case / "observed" / "impacts.csv", "w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["block_id", "impact", *IMPACT_FIELDS, "speed_error_ms", "rise_error_ms"])
            for name, v in rows:
                for k in range(IMPACTS):
                    pair = v[8 + len(IMPACT_FIELDS) * k:8 + len(IMPACT_FIELDS) * (k + 1)]
                    if all(math.isfinite(x) for x in pair):
                        error = self.impact_error(pair[0], pair[2])
                        table.writerow([name, k + 1, *(f"{x:.2f}" for x in pair), f"{error:.2f}", f"{error:.2f}"])


def compile_laws(folder):
    subprocess.run(["c++", "-shared", "-fPIC", "-O2", "-std=c++17", "-I", str(HERE.parents[1] / "include"), "-o", str(folder / "laws.so"),
                    str(HERE / "laws.cpp")], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scree", help="the program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", required=True, help="any text; development and test use different ones")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--cases", type=int, default=1)
    parser.add_argument("--slopes", choices=list(terrains.SETS), default="newest")
    parser.add_argument("--tiers", type=lambda text: [int(t) for t in text.split(",")], default=list(TIERS))
    parser.add_argument("--count", type=int, default=COUNT, help=f"simulated blocks behind a delta (default {COUNT})")
    parser.add_argument("--search", choices=["whole", "none"], default="whole",
                        help="where a delta on record is recalibrated: all over the ranges, or near the truth, with none at all where a strength is solved for (to try cases out)")
    parser.add_argument("--blocks", type=int, default=0, help="of every case (default: 30, 50 or 100 are drawn)")
    parser.add_argument("--threads", type=int, default=0)
    args = parser.parse_args()
    for name in terrains.SETS[args.slopes]:
        terrains.write(name, args.folder / "sites")
    sealed = args.folder / "sealed"
    sealed.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        compile_laws(work)
        for number in range(args.first, args.first + args.cases):
            target, written = sealed / f"{number:04d}.json", args.folder / "cases" / f"{number:04d}" / "site.toml"
            known = target.exists() and f"sealed/{number:04d}.json" in seals(args.folder)
            if known and written.exists():
                continue
            case = Case(args, number)
            if known:
                truth = json.loads(target.read_text())
                case.take(truth)
            else:
                truth = case.hide(work)
            case.write(work, truth)
            thrown = hash_of(written.parent)
            if known and truth.get("field_test_sha256") != thrown:
                shutil.rmtree(written.parent)
                sys.exit(f"case {number:04d} is sealed, and its field test cannot be thrown again as it was: go on with the program and the generate.py that drew it, or from another --first")
            truth["field_test_sha256"] = thrown
            for path in [args.folder / "cases", *(args.folder / "cases").rglob("*")]:  # how long a case took to make tells what is in it
                os.utime(path, (EPOCH, EPOCH))
            if known:
                print(f"case {number:04d} is thrown again", flush=True)
                continue
            text = json.dumps(truth, indent=1) + "\n"
            write_whole(target, text)
            with open(args.folder / "sealed.sha256", "a", encoding="utf-8") as list_of_hashes:
                list_of_hashes.write(f"{hashlib.sha256(text.encode()).hexdigest()}  sealed/{number:04d}.json\n")
            print(f"case {number:04d} is sealed", flush=True)


if __name__ == "__main__":
    main()
