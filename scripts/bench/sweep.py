#!/usr/bin/env python3
"""The effect of tuned numbers on the error of height maps of known ground.

    sweep.py NAME=VALUE,VALUE,... [NAME=VALUE,...] [MAP.gpkg:TRUTH.tif ...] [--keep FILE]
    sweep.py --all [MAP.gpkg:TRUTH.tif ...] [--keep FILE]

NAME is a number of src/core/tuning, such as spline.crease_weight, or spline.steps.1 for an element of an array; an unknown
name lists all names. Two names are varied together: every value of the first with every value of the second. TRUTH holds
the heights that the contours of MAP were cut from; the height map is made on its grid. Without maps the sample is used.

A row per value and map, and the geometric mean over the maps where there are several:

    rmse   root mean square error, divided by the contour interval, and its change against the default values
    slope  root mean square error of the slope angle, degrees (Horn), and its change
    in 1   per cent of the errors within one standard error, in 2 within two; only for numbers of the standard error

Cells count where both height maps have data. --all runs each number at half and at twice its value, one at a time, and sorts
the numbers by their effect: by the change of the mean RMSE, and those of the standard error by the change of the share
within one. --keep stores results in a file, by program, map and values, and reuses those that it holds. --with passes more
arguments on to tokosen, in one word: --with "--noise 1".
"""
import argparse
import concurrent.futures
import hashlib
import itertools
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import calibration
import score_dem
import terrain
import tools

SAMPLE = f"{tools.SAMPLE}:{tools.SAMPLE_TRUTH}"
LIMIT = 1800  # seconds of one run
# Numbers that standard errors depend on beside the heights, and those that height maps do not depend on.
WITH_ERRORS = ("errors.", "roughness.", "spline.gain.", "trials.min_places")
NOT_IN_HEIGHT_MAPS = ("nodes.", "errors.inferred_spacings")


# ---- values


def numbers(program):
    """The names of all tuned numbers and their values: text, without a point where it is a count."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "dem", tools.SAMPLE, "--cell", "100", "-o", os.path.join(folder, "a.tif"), "--tune", "?"]
        said = subprocess.run(command, capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL).stderr
    pairs = [line.split(" = ") for line in said.splitlines() if " = " in line]
    if not pairs:
        raise SystemExit(f"{program} lists no tuned numbers: {said.strip()}")
    return {name.strip(): value.strip() for name, value in pairs}


def halved_and_doubled(value):
    """Half a value and twice it; of a count, whole numbers that differ from it."""
    if "." in value or "e" in value:
        return [repr(float(value) / 2), repr(float(value) * 2)]
    count = int(value)
    return ["1"] if count == 0 else [str(count // 2), str(2 * count)]


def asked(text, known):
    """The name and the values of one argument."""
    name, _, values = text.partition("=")
    if name not in known:
        listed = "\n".join(f"{n} = {v}" for n, v in known.items())
        raise SystemExit(f"no tuned number is called {name!r}; there are:\n{listed}")
    return name, values.split(",")


def plan(arguments, known, everything):
    """The settings to be tried: names and values, as tuples of pairs."""
    if everything:
        return [((name, value),) for name, today in known.items() if not name.startswith(NOT_IN_HEIGHT_MAPS)
                for value in halved_and_doubled(today)]
    names = [asked(text, known) for text in arguments]
    return [tuple(zip([n for n, _ in names], values)) for values in itertools.product(*(v for _, v in names))]


# ---- runs


def interval(lines):
    """The contour interval of a map: the most frequent step from one level to the next."""
    steps = np.diff(np.unique(terrain.read_lines(lines)[1]))
    values, counts = np.unique(steps.round(6), return_counts=True)
    if not len(values):
        raise SystemExit(f"{lines}: it has one level")
    return float(values[counts.argmax()])


def run(program, lines, truth, setting, with_errors, dem, more):
    """Makes the height map of a map; what went wrong, if it did."""
    command = [program, "dem", lines, "--like", truth, "-o", dem, "--threads", "1", *more]
    command += ["--uncertainty"] if with_errors else []
    command += [part for name, value in setting for part in ("--tune", f"{name}={value}")]
    told = tools.run(list(map(str, command)), None, LIMIT)
    return None if "seconds" in told else told.get("failed", f"more than {LIMIT} s")


class Ground:
    """A map with known ground: its interval, and what its height maps are compared with."""

    def __init__(self, lines, truth):
        self.lines, self.truth, self.interval = lines, truth, interval(lines)
        self.heights, transform = terrain.read_dem(truth)
        self.size = transform.a, -transform.e
        self.slope = score_dem.slope(self.heights, *self.size)
        self.use = np.isfinite(self.slope)

    def read(self, dem):
        """Heights and slopes of a height map."""
        heights = terrain.read_dem(dem)[0]
        if heights.shape != self.heights.shape:
            raise SystemExit(f"{dem}: not on the grid of {self.truth}")
        return heights, score_dem.slope(heights, *self.size)

    def figures(self, dem, with_errors):
        """Errors of a height map, where the one with default values has data too."""
        heights, slope = self.read(dem)
        use = self.use & np.isfinite(slope)
        if not use.any():
            return {"failed": "it has no data where the ground is known"}
        off = np.abs(heights - self.heights)[use]
        rms = lambda values: float(np.sqrt((values**2).mean()))
        out = {"rmse": rms(off) / self.interval, "slope": rms((slope - self.slope)[use])}
        if with_errors:
            errors = calibration.band(dem, 2)[0][use]
            within = lambda times: float(100 * (off <= times * errors).mean())
            out |= {"in 1": within(1), "in 2": within(2)}
        return out


def key(program, *parts):
    """What a result is kept by."""
    stat = os.stat(program)
    return hashlib.sha256(repr((str(program), stat.st_size, stat.st_mtime_ns, parts)).encode()).hexdigest()[:16]


def measure(program, maps, settings, keep, jobs, more):
    """Figures by setting and map; those of the default values are under the empty setting."""
    found, held = {}, json.loads(keep.read_text()) if keep and keep.exists() else {}
    grounds = {lines: Ground(lines, truth) for lines, truth in maps}
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:

        def one(task):
            setting, (lines, truth) = task
            name = key(program, lines, truth, setting, *more)
            # The default height map is needed itself: others count where it has data.
            if name in held and setting:
                return name, task, held[name]
            with_errors = not setting or any(number.startswith(WITH_ERRORS) for number, _ in setting)
            dem = os.path.join(folder, f"{name}.tif")
            wrong = run(program, lines, truth, setting, with_errors, dem, more)
            if not wrong and not setting:
                grounds[lines].use &= np.isfinite(grounds[lines].read(dem)[1])
            out = {"failed": wrong} if wrong else grounds[lines].figures(dem, with_errors)
            pathlib.Path(dem).unlink(missing_ok=True)
            return name, task, out

        for group in ([()], settings):
            tasks = list(itertools.product(group, maps))
            for count, (name, (setting, (lines, _)), out) in enumerate(pool.map(one, tasks), 1):
                tools.say(f"{count} of {len(tasks)}")
                if "failed" in out and not setting:
                    raise SystemExit(f"{lines}: {out['failed']}")
                found[setting, lines] = held[name] = out
                if keep:
                    keep.write_text(json.dumps(held))
    tools.say("")
    return found


# ---- tables


def change(found, setting, lines, name):
    """The change of a figure against the default values: a ratio, of shares a difference; NaN where there is none."""
    now, before = found[setting, lines].get(name), found[(), lines].get(name)
    if now is None or before is None:
        return float("nan")
    if name.startswith("in "):
        return now - before
    return now / before if before else float("nan")


def mean(found, setting, maps, name):
    """The mean change over the maps: geometric, of shares arithmetic."""
    each = [change(found, setting, lines, name) for lines, _ in maps]
    return float(np.mean(each)) if name.startswith("in ") else float(np.exp(np.mean(np.log(each))))


def percent(ratio):
    return "-" if np.isnan(ratio) else f"{100 * (ratio - 1):+.2f} %"


def points(difference):
    return "-" if np.isnan(difference) else f"{difference:+.1f}"


def called(setting):
    return " ".join(f"{name}={value}" for name, value in setting) or "default"


def rows(found, maps, settings):
    """A row per setting and map."""
    head = ["value", "map", "rmse", "", "slope", "", "in 1", "in 2"]
    out = []
    for setting in [(), *settings]:
        for lines, _ in maps:
            f = found[setting, lines]
            name = [called(setting), pathlib.Path(lines).stem]
            if "failed" in f:
                out.append([*name, "failed", f["failed"], "", "", "", ""])
                continue
            of = lambda figure: percent(change(found, setting, lines, figure)) if setting else ""
            share = lambda figure: f"{f[figure]:.1f}" if figure in f else "-"
            out.append([*name, f"{f['rmse']:.4f}", of("rmse"), f"{f['slope']:.3f}", of("slope"), share("in 1"), share("in 2")])
        if setting and len(maps) > 1:
            of = lambda figure: mean(found, setting, maps, figure)
            out.append([called(setting), "mean", "", percent(of("rmse")), "", percent(of("slope")), points(of("in 1")),
                        points(of("in 2"))])
    return tools.table(head, out)


def by_effect(found, maps, settings):
    """A row per number, the largest effect first: mean changes at half and at twice its value."""
    figure = lambda name: "in 1" if name.startswith("errors.") else "rmse"
    effects = {}
    for setting in settings:
        (name, value), = setting
        effects.setdefault(name, []).append((value, {f: mean(found, setting, maps, f) for f in ("rmse", "slope", "in 1", "in 2")}))
    size = lambda name, f: max(abs(e[f]) if f == "in 1" else abs(np.log(e[f])) for _, e in effects[name]) if effects[name] else 0

    def table(names, head, cells):
        order = sorted(names, key=lambda n: -np.nan_to_num(size(n, figure(n)), nan=np.inf))
        return tools.table(["number", *head], [[n, *(c for value, e in effects[n] for c in (value, *cells(e)))] +
                                               [""] * (len(head) - len(effects[n]) * len(head) // 2) for n in order])

    heights = [n for n in effects if figure(n) == "rmse"]
    errors = [n for n in effects if figure(n) == "in 1"]
    out = []
    if heights:
        out.append(table(heights, ["half", "rmse", "slope", "twice", "rmse", "slope"],
                         lambda e: (percent(e["rmse"]), percent(e["slope"]))))
    if errors:
        out.append(table(errors, ["half", "in 1", "in 2", "twice", "in 1", "in 2"],
                         lambda e: (points(e["in 1"]), points(e["in 2"]))))
    return "\n\n".join(out)


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("what", nargs="*", metavar="NAME=VALUES | MAP:TRUTH")
    a.add_argument("--all", action="store_true", help="every number at half and at twice its value")
    a.add_argument("--program", default=str(tools.BINARY), help="tokosen (default: target/release/tokosen)")
    a.add_argument("--keep", type=pathlib.Path, help="file that holds results")
    a.add_argument("--with", dest="more", type=shlex.split, default=[], help="more arguments for tokosen")
    a.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time, one thread each")
    o = a.parse_args()
    # A path may hold an equals sign, a name of a number no colon.
    maps = [tuple(text.rsplit(":", 1)) for text in o.what if ":" in text] or [tuple(SAMPLE.rsplit(":", 1))]
    wanted = [text for text in o.what if ":" not in text]
    if o.all == bool(wanted) or len(wanted) > 2:
        a.error("name one or two numbers with their values, or --all")
    program = tools.find(o.program)
    known = numbers(program)
    settings = plan(wanted, known, o.all)
    found = measure(program, maps, settings, o.keep, o.jobs, o.more)
    print(by_effect(found, maps, settings) if o.all else rows(found, maps, settings))


if __name__ == "__main__":
    main()
