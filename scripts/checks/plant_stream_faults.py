#!/usr/bin/env python3
"""Plants faults in streams and counts how many of them `tokosen check` finds, and how many it finds that are none.

    plant_stream_faults.py CONTOURS.gpkg STREAMS.gpkg [--program P] [--seed N]

STREAMS fits CONTOURS, as `score_streams.py --keep` makes it. Of the streams that cross three contours or more, one fifth
each is turned, shifted by 0.5 or by 2 to 5 tolerances across its course, or led over a ridge to a stream beside it. The rest
stays. Expected are: stream-turned; stream-moved; stream-beside or stream-cut; stream-cut. A stream that stays should get none
of them but stream-moved, since D8 courses are not exact. Streams that are told of before anything is planted do not count: the
true ground has pits that streams flow through upwards. One row per kind: planted, found with the right word, share.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import pyogrio
import shapely

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))  # the modules that scripts share
import tools

WORDS = {
    "turned": {"stream-turned"},
    "shifted 0.5": {"stream-moved"},
    "shifted 2 to 5": {"stream-beside", "stream-cut"},
    "over a ridge": {"stream-cut"},
}
FAULTS = {"stream-turned", "stream-beside", "stream-cut"}


def told(program, contours, streams, crs, tolerance):
    """The codes of the findings about each stream, by its number."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "streams.gpkg"
        pyogrio.raw.write(path, geometry=shapely.to_wkb(streams), field_data=[np.arange(len(streams))], fields=["number"],
                          geometry_type="LineString", crs=crs, driver="GPKG", layer="streams")
        command = [program, "check", contours, "--streams", path, "--stream-tolerance", str(tolerance), "--json"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
    found = {}
    for finding in json.loads(done.stdout)["findings"]:
        if finding["code"].startswith("stream-"):
            for feature in finding["features"]:
                found.setdefault(int(feature) - 1, set()).add(finding["code"])
    return found


def ridge_width(line, contours, levels, tree):
    """How far a line that starts downhill runs away from a contour, at most, between crossing it up and down again."""
    crossings = []
    for c in tree.query(line, predicate="crosses"):
        for place in shapely.get_parts(shapely.intersection(line, contours[c])):
            crossings.append((float(shapely.line_locate_point(line, shapely.get_point(place, 0) if place.geom_type != "Point" else place)), int(c)))
    crossings.sort()
    rises, widest, up = {}, 0.0, False
    for k, (at, c) in enumerate(crossings):
        before = levels[crossings[k - 1][1]] if k else np.inf
        up = levels[c] > before or (levels[c] == before and not up)
        if up:
            rises[levels[c]] = at
        elif levels[c] in rises:
            places = shapely.line_interpolate_point(line, np.linspace(rises.pop(levels[c]), at, 9))
            widest = max(widest, shapely.distance(places, contours[c]).max())
    return widest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("contours", type=pathlib.Path)
    parser.add_argument("streams", type=pathlib.Path)
    parser.add_argument("--program", default=tools.BINARY, type=pathlib.Path)
    parser.add_argument("--tolerance", type=float, help="map units (default: a quarter of the mean spacing)")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    meta, _, wkb, _ = pyogrio.raw.read(args.contours)
    contours = shapely.get_parts(shapely.from_wkb(wkb))
    levels = shapely.get_coordinates(shapely.get_point(contours, 0), include_z=True)[:, 2]
    contours = shapely.force_2d(contours)
    streams = shapely.from_wkb(pyogrio.raw.read(args.streams)[2])
    tree = shapely.STRtree(contours)
    crossed = np.bincount(tree.query(streams, predicate="crosses")[0], minlength=len(streams))
    box = shapely.box(*shapely.total_bounds(contours))
    tolerance = args.tolerance or 0.25 * shapely.area(box) / shapely.length(contours).sum()
    draw = np.random.default_rng(args.seed)
    before = told(args.program, args.contours, streams, meta["crs"], tolerance)
    sound = np.array([not before.get(k, set()) & FAULTS for k in range(len(streams))])
    candidates = draw.permutation(np.flatnonzero((crossed >= 3) & sound))
    kinds = {int(k): name for part, name in zip(np.array_split(candidates, 5), WORDS) for k in part}
    planted = []
    for k, line in enumerate(streams):
        points = shapely.get_coordinates(line)
        kind = kinds.get(k)
        if kind == "turned":
            points = points[::-1]
        elif kind and kind.startswith("shifted"):
            way = points[-1] - points[0]
            across = np.array([-way[1], way[0]]) / np.hypot(*way) * draw.choice([-1, 1])
            points = points + across * tolerance * (0.5 if kind == "shifted 0.5" else draw.uniform(2, 5))
        elif kind == "over a ridge":
            # From the middle of the stream to that of the nearest other one that does not touch it.
            others = [i for i in np.argsort(shapely.distance(streams, line)) if not streams[i].intersects(line)]
            end = shapely.get_coordinates(streams[others[0]])
            points = np.vstack([points[: len(points) // 2 + 1], end[len(end) // 2]])
            # Without a contour that it crosses up and then down again, the contours show no ridge there. Over a valley, its two
            # parts are streams that meet in it. Nearer to the contour than the tolerance, it may be moved along it.
            if ridge_width(shapely.linestrings(points), contours, levels, tree) <= tolerance:
                del kinds[k]
                points = shapely.get_coordinates(line)
        planted.append(shapely.linestrings(points))
    found = told(args.program, args.contours, planted, meta["crs"], tolerance)
    print(f"{len(streams)} streams, {len(candidates)} with three crossings or more; tolerance {tolerance:.1f}")
    for kind, words in WORDS.items():
        all_of = [k for k, name in kinds.items() if name == kind]
        right = sum(bool(found.get(k, set()) & words) for k in all_of)
        print(f"{kind:16} {len(all_of):5} {right:5} {100 * right / max(len(all_of), 1):6.1f} %")
    kept = [k for k in candidates if k not in kinds]
    wrong = sum(bool(found.get(int(k), set()) & FAULTS) for k in kept)
    print(f"{'kept, told':16} {len(kept):5} {wrong:5} {100 * wrong / max(len(kept), 1):6.1f} %")


if __name__ == "__main__":
    main()
