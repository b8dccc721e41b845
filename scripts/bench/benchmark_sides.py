#!/usr/bin/env python3
"""Time and memory of side inputs of many vertices: a lake, a frame, a part to leave out and so on, each one polygon or line.

    benchmark_sides.py                                     # up to 100,000 vertices
    benchmark_sides.py --vertices 1000000 --only ring      # 1,000,000 vertices; every role with "ring" in its name
    benchmark_sides.py --only lake --threads 1 --limit 300

The contours are those of the sample. The shapes:

    ring     a circle of 1 km radius, which crosses contours
    pond     a circle of 400 m radius on ground without contours
    shore    a ring with bays on bays, as a real lake or coast has; it crosses contours
    star     every second vertex lies half as far from the centre: long thin spikes, whose boxes all overlap
    zigzag   a line that goes to and fro between two edges of a square

`contour star` is a map of three contours, of which the middle one is the star. `exclude 1,000` leaves out so many nearly
equal polygons of 100 vertices each. A row has the CPU seconds of all threads and the peak memory for each number of vertices. x is the ratio of
the last two times; up to 15 is near-linear. A star of 100,000 vertices crosses contours about a million times.

CPU seconds hardly depend on what else the machine does; a run that takes longer than --limit, by the clock, is stopped.
"""
import argparse
import pathlib
import sys
import tempfile

import numpy as np
import pyogrio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import tools

CENTRE = np.array([749250.0, 4019250.0])
BARE = np.array([750677.0, 4023060.0])  # no contour within 460 m
COUNTS = (10_000, 100_000, 1_000_000)


def ring(n, radius=1000.0, centre=CENTRE):
    angle = np.arange(n) * (2 * np.pi / n)
    radius = np.broadcast_to(radius, n)[:, None]
    return centre + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def star(n, radius=1000.0, centre=CENTRE):
    return ring(n, np.where(np.arange(n) % 2, radius / 2, radius), centre)


def shore(n, radius=1000.0, centre=CENTRE):
    """Waves of all lengths, each half as high as those of double its length."""
    random, angle, off = np.random.default_rng(1), np.arange(n) * (2 * np.pi / n), np.zeros(n)
    waves = 2
    while waves < n / 4:
        off += np.sin(waves * angle + random.uniform(0, 2 * np.pi)) * 0.15 / waves
        waves *= 2
    return ring(n, radius * (1 + off), centre)


def zigzag(n, half=1000.0, centre=CENTRE):
    return centre + np.column_stack([np.where(np.arange(n) % 2, half, -half), np.linspace(-half, half, n)])


def roles():
    """Name, shape and option of each role; the shape gives the vertices of a polygon, or of a line for a zigzag."""
    pond = lambda n: ring(n, 400.0, BARE)
    bare_star = lambda n: star(n, 400.0, BARE)
    yield from (("lake pond", pond, "--water"), ("lake ring", ring, "--water"), ("lake shore", shore, "--water"))
    yield from (("lake star on bare ground", bare_star, "--water"), ("lake star", star, "--water"))
    for name, option in (("frame", "--frame"), ("exclude", "--exclude"), ("clip", "--clip"), ("coast", "--coast")):
        yield from ((f"{name} ring", ring, option), (f"{name} shore", shore, option), (f"{name} star", star, option))
    yield from (("sink area ring", ring, "--sinks"), ("sink area star", star, "--sinks"))
    yield from (("break line zigzag", zigzag, "--breaklines"), ("stream zigzag", zigzag, "--streams"))
    yield "contour star", star, None
    yield "exclude 1,000", None, "--exclude"


def write(path, shapes, crs, **fields):
    kind = "Polygon" if shapes[0].geom_type == "Polygon" else "LineString"
    pyogrio.raw.write(path, geometry=shapely.to_wkb(shapes), field_data=[np.array(v) for v in fields.values()],
                      fields=list(fields), crs=crs, geometry_type=kind, driver="GPKG")


def command(binary, folder, name, shape, option, n, crs):
    """The command for a role, after its input is written to the folder."""
    path, out = str(folder / f"{name.replace(' ', '_')}_{n}.gpkg"), str(folder / "out.tif")
    start = [binary, "dem", "-q", "--cell", "30", "--overwrite", "-o", out]
    if shape is None:
        random = np.random.default_rng(1)
        near = [shapely.Polygon(ring(100) + random.normal(0, 1.0, 2)) for _ in range(n // 100)]
        write(path, near, crs)
    elif option is None:
        closed = lambda points: shapely.LineString(np.vstack([points, points[:1]]))
        lines = [closed(ring(400, 1500.0)), closed(shape(n)), closed(ring(200, 200.0))]
        write(path, lines, crs, elev=[20.0, 40.0, 60.0])
        return [*start, path]
    else:
        write(path, [(shapely.LineString if shape is zigzag else shapely.Polygon)(shape(n))], crs)
    return [*start, str(tools.SAMPLE), option, path]


def row(name, figures):
    cells, known = [name], [f for f in figures if "seconds" in f]
    for figure in figures:
        if "seconds" in figure:
            cells += [f"{figure['cpu_seconds']:.1f} s", f"{figure['peak_bytes'] / 1e6:.0f} MB"]
        else:
            cells += [f"> {figure['over']:.0f} s" if "over" in figure else "failed" if figure else "-", ""]
    ratio = known[-1]["cpu_seconds"] / known[-2]["cpu_seconds"] if len(known) > 1 else None
    return [*cells, f"{ratio:.1f}" if ratio else ""]


def line(cells):
    """A line of the table. A row is printed as soon as it is known, so the columns have fixed widths."""
    return "| " + " | ".join(c.ljust(24) if i == 0 else c.rjust(9) for i, c in enumerate(cells)) + " |"


def rule(cells):
    return "|" + "|".join("-" * 26 if i == 0 else "-" * 10 + ":" for i in range(len(cells))) + "|"


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("--vertices", type=int, default=COUNTS[1], help="the largest number of vertices (100000)")
    a.add_argument("--only", action="append", metavar="NAME", help="roles with NAME in their name; may be repeated")
    a.add_argument("--threads", type=int, help="number of threads (all cores)")
    a.add_argument("--tokosen", default=str(tools.BINARY), help="the program (target/release/tokosen)")
    a.add_argument("--limit", type=float, default=120, metavar="SECONDS", help="for each run (120)")
    o = a.parse_args()
    binary, counts = tools.find(o.tokosen), [n for n in COUNTS if n <= o.vertices]
    if not counts:
        a.error(f"--vertices is {COUNTS[0]} or more")
    crs = pyogrio.read_info(tools.SAMPLE)["crs"]
    head = ["side input", *(cell for n in counts for cell in (f"{n:,}", "memory")), "x"]
    print(line(head), rule(head), sep="\n", flush=True)
    failed = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name, shape, option in roles():
            if o.only and not any(only in name for only in o.only):
                continue
            figures = []
            for n in counts:
                tools.say(f"{name}, {n}")
                run = command(binary, folder, name, shape, option, n, crs)
                figures.append(tools.run(run + (["--threads", str(o.threads)] if o.threads else []), folder, o.limit))
                if "failed" in figures[-1]:
                    failed.append(f"{name}, {n}: {figures[-1]['failed']}")
                if "over" in figures[-1]:
                    break
            figures += [{}] * (len(counts) - len(figures))
            tools.say("")
            print(line(row(name, figures)), flush=True)
    print(*failed, sep="\n", end="\n" if failed else "")
    return 0


if __name__ == "__main__":
    sys.exit(main())
