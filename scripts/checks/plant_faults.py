#!/usr/bin/env python3
"""Which faults in contours does a check find, and how many false alarms does it raise?

Plants faults of known kind and place in a file of sound contours, runs the check under test on the damaged file, and
scores its findings:

    plant_faults.py score CONTOURS.gpkg --command 'tokosen check {contours} --json' [--labels 50] [--pieces 50] [--seed 1]
    plant_faults.py plant CONTOURS.gpkg DAMAGED.gpkg FAULTS.json [...]

Wrong labels: two digits swapped, one digit wrong, one interval off, several intervals off, a typo off the interval, 0, feet.
Missing pieces: cut out of lines (from 1 to 10 spacings of the contours, and a fifth of the line), and whole lines.
Lines are drawn among those of at least `--spacings` local spacings (`--uniform`: among all). A whole line is only taken
out where the two lines left and right of it are of different level, so that a level is skipped there.

The check prints JSON: {"findings": [{"code", "place": [x, y], "features": [...], "elevations": [...], "proposal"}, ...]}.
A wrong label is found by a finding about it that names its feature; a missing piece by a gap, an open end or a skipped
level that names one of the lines at it and lies near. A finding of these kinds that belongs to no planted fault is a false alarm.
"""
import argparse
import json
import math
import os
import random
import shlex
import subprocess
import sys
import tempfile

import numpy as np
import pyogrio
import shapely
import shapely.ops

LABEL_CODES = {"wrong-label", "zero-elevation", "off-interval", "mixed-units"}
PIECE_CODES = {"gap", "open-end", "skipped-level"}
JUDGED = LABEL_CODES | PIECE_CODES
FOOT = 0.3048
LABELS = ["swap", "digit", "one", "several", "typo", "zero", "feet"]
PIECES = ["cut 1", "cut 3", "cut 10", "cut 20%", "line"]


class Lines:
    """The contours of a file."""

    def __init__(self, path, field):
        meta, fids, wkb, fields = pyogrio.raw.read(path, return_fids=True)
        self.meta, self.name = meta, meta["fields"]
        geometry = shapely.force_2d(shapely.from_wkb(wkb))
        if field is None:
            candidates = [n for n in self.name if n.lower() in ("elev", "elevation", "contour", "hoyde", "height")]
            field = candidates[0] if candidates else self.name[0]
        values = fields[list(self.name).index(field)].astype(float)
        self.lines, self.levels = [], []
        for line, level in zip(geometry, values):
            for part in shapely.get_parts(line):
                self.lines.append(part)
                self.levels.append(float(level))
        self.lines, self.levels = np.array(self.lines), np.array(self.levels)
        steps = np.diff(np.unique(self.levels))
        self.step = float(np.median(steps)) if len(steps) else 1.0
        self.field = field

    def spacing(self):
        """Half the distance between a line's neighbours, and whether these are of the levels above and below."""
        tree = shapely.STRtree(self.lines)
        extent = shapely.total_bounds(self.lines)
        reach = 0.25 * math.hypot(extent[2] - extent[0], extent[3] - extent[1])
        spacing, between = np.full(len(self.lines), math.inf), np.zeros(len(self.lines), bool)
        for i, line in enumerate(self.lines):
            found = []
            for share in (0.1, 0.3, 0.5, 0.7, 0.9):
                a, b = (np.array(shapely.get_coordinates(line.interpolate(s, normalized=True))[0])
                        for s in (share, min(share + 1e-3, 1.0)))
                way = b - a
                if not np.any(way):
                    continue
                way = np.array([-way[1], way[0]]) / np.hypot(*way)
                sides = []
                for sign in (1, -1):
                    sides.append(self.first_hit(tree, i, a, a + sign * reach * way))
                found.append(sides)
            distances = [d for sides in found for d, _ in sides if math.isfinite(d)]
            if distances:
                spacing[i] = float(np.median(distances))
            for (_, left), (_, right) in found:
                if left is not None and right is not None and abs(abs(left - right) - 2 * self.step) < 1e-6 * self.step:
                    between[i] = True
        return spacing, between

    def first_hit(self, tree, own, a, b):
        """Distance and level of the first other line from a towards b."""
        reach = 1.0 / 64
        while True:
            view = shapely.linestrings([a, a + reach * (b - a)])
            best = (math.inf, None)
            for j in tree.query(view, predicate="intersects"):
                meets = shapely.intersection(view, self.lines[j])
                distance = shapely.distance(meets, shapely.points(a))
                if j == own and distance < 1e-6:
                    parts = [p for p in shapely.get_parts(meets) if shapely.distance(p, shapely.points(a)) > 1e-6]
                    distance = min((shapely.distance(p, shapely.points(a)) for p in parts), default=math.inf)
                if distance < best[0]:
                    best = (distance, float(self.levels[j]))
            if best[1] is not None or reach >= 1.0:
                return best
            reach *= 4


def wrong_label(kind, level, step, rng):
    """A wrong label for a level, or None where this kind of slip cannot be."""
    text = f"{level:g}"
    at = [i for i, c in enumerate(text) if c.isdigit()]
    if kind == "swap":
        pairs = [(i, j) for i, j in zip(at, at[1:]) if text[i] != text[j]]
        if not pairs:
            return None
        i, j = rng.choice(pairs)
        digits = list(text)
        digits[i], digits[j] = digits[j], digits[i]
        return float("".join(digits))
    if kind == "digit":
        i = rng.choice(at)
        digit = rng.choice([d for d in "0123456789" if d != text[i]])
        return float(text[:i] + digit + text[i + 1:])
    if kind == "one":
        return level + rng.choice([-step, step])
    if kind == "several":
        return level + rng.choice([-1, 1]) * rng.randint(2, 8) * step
    if kind == "typo":
        return level + rng.choice([-0.5, 0.5, 0.3, -0.7]) * step
    if kind == "zero":
        return 0.0 if level != 0 else None
    return round(level / FOOT, 1) if level != 0 else None


def plant(lines, options):
    """The damaged lines [(level, coordinates)], in order of their feature numbers, and the list of faults."""
    rng = random.Random(options.seed)
    spacing, between = lines.spacing()
    length = shapely.length(lines.lines)
    least = 0 if options.uniform else options.spacings
    able = [i for i in range(len(lines.lines)) if length[i] >= least * spacing[i] and math.isfinite(spacing[i])]
    rng.shuffle(able)
    levels, parts = lines.levels.copy(), [[line] for line in lines.lines]
    faults = []
    kinds = [LABELS[k % len(LABELS)] for k in range(options.labels)]
    pieces = [PIECES[k % len(PIECES)] for k in range(options.pieces)]
    for kind in kinds + pieces:
        for i in list(able):
            if kind in LABELS:
                label = wrong_label(kind, float(levels[i]), lines.step, rng)
                if label is None or label == levels[i]:
                    continue
                faults.append({"kind": kind, "line": i, "truth": float(levels[i]), "label": label})
                levels[i] = label
            elif kind == "line":
                if not between[i]:
                    continue
                faults.append({"kind": kind, "line": i, "truth": float(levels[i]), "reach": 3 * spacing[i]})
                parts[i] = []
            else:
                cut = 0.2 * length[i] if kind == "cut 20%" else float(kind.split()[1]) * spacing[i] * rng.uniform(0.7, 1.0)
                if cut > 0.5 * length[i]:
                    continue
                first = rng.uniform(0.2 * length[i], 0.8 * length[i] - cut)
                line = lines.lines[i]
                parts[i] = [shapely.ops.substring(line, 0, first), shapely.ops.substring(line, first + cut, length[i])]
                gone = shapely.ops.substring(line, first, first + cut)
                faults.append({"kind": kind, "line": i, "truth": float(levels[i]), "reach": 2 * spacing[i], "gone": gone})
            able.remove(i)
            break
    damaged = []
    for i, own in enumerate(parts):
        for part in own:
            if part.length > 0:
                damaged.append((i, float(levels[i]), part))
    return damaged, faults


def write(damaged, lines, path):
    if os.path.exists(path):
        os.remove(path)
    pyogrio.raw.write(path, geometry=shapely.to_wkb(np.array([p for _, _, p in damaged])),
                      field_data=[np.array([z for _, z, _ in damaged])], fields=["elev"], geometry_type="LineString",
                      crs=lines.meta["crs"], driver="GPKG", layer="contours")


def judge(findings, damaged, faults, lines):
    """For each fault whether it is found and whether its truth is proposed; and the findings that belong to none."""
    findings = [f for f in findings if f["code"] in JUDGED]
    owner = dict(enumerate((i for i, _, _ in damaged), start=1))
    named = [{owner.get(n) for n in f["features"]} for f in findings]
    explained = [False] * len(findings)
    results = []
    for fault in faults:
        line = fault["line"]
        found = proposed = False
        where = fault.get("gone", lines.lines[line])
        for k, finding in enumerate(findings):
            place = finding.get("place")
            near = place is not None and shapely.distance(where, shapely.points(place)) <= fault.get("reach", 0) + 1e-6
            if fault["kind"] in LABELS:
                if line in named[k]:
                    explained[k] = True
                    if finding["code"] in LABEL_CODES:
                        found = True
                        proposal = finding.get("proposal") or {}
                        proposed |= abs(proposal.get("to", math.inf) - fault["truth"]) < 0.03 * lines.step
            elif near or (line in named[k] and fault["kind"] != "line"):
                explained[k] = True
                found |= finding["code"] in PIECE_CODES
        results.append((found, proposed))
    return results, [f for f, known in zip(findings, explained) if not known], len(findings)


def run(command, path):
    done = subprocess.run(shlex.split(command.format(contours=path)), capture_output=True, text=True)
    if not done.stdout.strip():
        sys.exit(f"no JSON from the command: {done.stderr[-2000:]}")
    return json.loads(done.stdout)["findings"]


def table(results, faults):
    kinds = {}
    for (found, proposed), fault in zip(results, faults):
        row = kinds.setdefault(fault["kind"], [0, 0, 0])
        row[0] += 1
        row[1] += found
        row[2] += proposed
    return kinds


def report(kinds, false, told):
    for group, names in (("labels", LABELS), ("pieces", PIECES)):
        rows = [kinds[n] for n in names if n in kinds]
        if not rows:
            continue
        planted, found, proposed = (sum(r[k] for r in rows) for k in range(3))
        detail = ", ".join(f"{n} {kinds[n][1]}/{kinds[n][0]}" for n in names if n in kinds)
        truth = f", truth proposed {100 * proposed / planted:.0f} %" if group == "labels" else ""
        print(f"  {group}: found {found} of {planted} ({100 * found / planted:.0f} %){truth}   [{detail}]")
    print(f"  false alarms: {false} of {told} findings ({100 * false / max(told, 1):.1f} %)")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mode", choices=["score", "plant"])
    parser.add_argument("contours")
    parser.add_argument("out", nargs="*", help="plant: the damaged file and the list of faults")
    parser.add_argument("--command", help="the check, with {contours}")
    parser.add_argument("--labels", type=int, default=50)
    parser.add_argument("--pieces", type=int, default=50)
    parser.add_argument("--rounds", type=int, default=1, help="damaged files, each with another seed")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--spacings", type=float, default=5.0, help="least length of a line, in local spacings")
    parser.add_argument("--uniform", action="store_true", help="draw among all lines")
    parser.add_argument("--field", help="attribute of the elevation")
    parser.add_argument("--verbose", action="store_true", help="list the missed faults and the false alarms")
    options = parser.parse_args()
    lines = Lines(options.contours, options.field)
    if options.mode == "plant":
        damaged, faults = plant(lines, options)
        write(damaged, lines, options.out[0])
        with open(options.out[1], "w", encoding="utf-8") as file:
            json.dump([{k: v for k, v in f.items() if k != "gone"} for f in faults], file, indent=1)
        return
    with tempfile.TemporaryDirectory() as folder:
        untouched = [f for f in run(options.command, options.contours) if f["code"] in JUDGED]
        print(f"{os.path.basename(options.contours)}: {len(lines.lines)} lines; untouched: {len(untouched)} findings")
        if options.verbose:
            for finding in untouched[:20]:
                print("    ", finding["code"], finding["place"], finding["message"])
        kinds, false, told = {}, 0, 0
        for _ in range(options.rounds):
            damaged, faults = plant(lines, options)
            path = os.path.join(folder, "damaged.gpkg")
            write(damaged, lines, path)
            results, alarms, count = judge(run(options.command, path), damaged, faults, lines)
            false, told = false + len(alarms), told + count
            for kind, row in table(results, faults).items():
                sums = kinds.setdefault(kind, [0, 0, 0])
                for k in range(3):
                    sums[k] += row[k]
            if options.verbose:
                for fault, (found, proposed) in zip(faults, results):
                    if not found or (fault["kind"] in LABELS and not proposed):
                        state = "not proposed" if found else "MISSED"
                        middle = fault.get("gone", lines.lines[fault["line"]]).interpolate(0.5, normalized=True)
                        print("    ", state, {k: v for k, v in fault.items() if k != "gone"}, middle.wkt)
                for finding in alarms:
                    print("     false:", finding["code"], finding["place"], finding["message"])
            options.seed += 1
        report(kinds, false, told)


if __name__ == "__main__":
    main()
