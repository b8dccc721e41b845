#!/usr/bin/env python3
"""Does damage in one place of a map change the surface elsewhere?

    damage.py make KIND CONTOURS.gpkg DAMAGED.gpkg PLACES.npy [--share S] [--seed N]
    damage.py score TRUTH.tif CONTOURS.gpkg PLACES.npy WHOLE.tif DAMAGED.tif

`make` damages contours (a layer of lines with the attribute `elev`) in one of these ways:
  displace   a share of all vertices, anywhere, moved at random by up to the mean distance between contours
  patches    the same, but all of them within a few small patches
  remove     a share of the lines is left out
  relabel    a share of the lines gets the elevation of one to three intervals more or less
and records the places of the damage. `score` compares the heights from the sound and from the damaged contours with the
truth, at cells further than five mean distances between contours from any damage. It prints both values of RMSE, divided by
the contour interval, for those cells and for all.
"""
import argparse

import numpy as np
import pyogrio
import rasterio
import shapely
from scipy.ndimage import distance_transform_edt
from scipy.spatial import ConvexHull

AWAY = 5.0
PATCHES = 4


def read(path):
    frame = pyogrio.raw.read(path)
    meta, _, geometry, fields = frame
    lines = [shapely.force_2d(g) for g in shapely.from_wkb(geometry)]
    elevation = np.asarray(fields[list(meta["fields"]).index("elev")], float)
    parts = [(part, e) for line, e in zip(lines, elevation) for part in shapely.get_parts(line)]
    return [shapely.get_coordinates(p) for p, _ in parts], np.array([e for _, e in parts]), meta["crs"]


def mean_gap(lines):
    length = sum(np.hypot(*np.diff(l, axis=0).T).sum() for l in lines)
    return ConvexHull(np.vstack(lines)).volume / length


def write(path, lines, elevation, crs):
    points = [np.column_stack([l, np.full(len(l), e)]) for l, e in zip(lines, elevation)]
    geometry = shapely.to_wkb([shapely.linestrings(p) for p in points])
    pyogrio.raw.write(path, np.array(geometry, object), [elevation], ["elev"], crs=crs, geometry_type="LineString Z",
                      layer="contours", driver="GPKG")


def damaged(kind, lines, elevation, share, random):
    gap, interval = mean_gap(lines), np.diff(np.unique(elevation)).min()
    lines, elevation = [l.copy() for l in lines], elevation.copy()
    places = []
    if kind in ("displace", "patches"):
        counts = np.cumsum([0] + [len(l) for l in lines])
        everything = np.vstack(lines)
        wanted = int(round(share * len(everything)))
        chosen = random.choice(len(everything), wanted, replace=False)
        if kind == "patches":
            middles = everything[random.choice(len(everything), PATCHES, replace=False)]
            near = np.min([np.hypot(*(everything - m).T) for m in middles], axis=0)
            chosen = random.permutation(np.argsort(near)[:4 * wanted])[:wanted]
        angle = random.uniform(0.0, 2.0 * np.pi, wanted)
        reach = gap * np.sqrt(random.uniform(0.0, 1.0, wanted))
        for vertex, move in zip(chosen, np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None]):
            line = int(np.searchsorted(counts, vertex, "right")) - 1
            k, points = vertex - counts[line], lines[line]
            closed = len(points) > 3 and (points[0] == points[-1]).all()
            points[k] += move
            if closed and k in (0, len(points) - 1):
                points[0] = points[-1] = points[k]
            places.append(points[k])
            places.append(points[k] - move)
    else:
        chosen = random.choice(len(lines), int(round(share * len(lines))), replace=False)
        for line in chosen:
            for a, b in zip(lines[line], lines[line][1:]):
                steps = max(1, int(np.hypot(*(b - a)) / gap * 2.0))
                places.extend(a + (b - a) * t for t in np.linspace(0.0, 1.0, steps + 1))
        if kind == "relabel":
            elevation[chosen] += interval * random.choice([-3, -2, -1, 1, 2, 3], len(chosen))
        else:
            lines = [l for k, l in enumerate(lines) if k not in set(chosen)]
            elevation = np.delete(elevation, chosen)
    return lines, elevation, np.array(places)


def score(truth_path, contours, places, whole, broken):
    with rasterio.open(truth_path) as file:
        truth, transform = file.read(1).astype(float), file.transform
        if file.nodata is not None:
            truth[truth == file.nodata] = np.nan
    lines, elevation, _ = read(contours)
    gap, interval = mean_gap(lines), np.diff(np.unique(elevation)).min()
    is_hit = np.zeros(truth.shape, bool)
    rows, cols = rasterio.transform.rowcol(transform, places[:, 0], places[:, 1])
    is_hit[np.clip(rows, 0, truth.shape[0] - 1), np.clip(cols, 0, truth.shape[1] - 1)] = True
    away = distance_transform_edt(~is_hit) * abs(transform.a) > AWAY * gap
    heights = []
    for path in (whole, broken):
        with rasterio.open(path) as file:
            z = file.read(1).astype(float)
            z[~np.isfinite(z) | (z == (file.nodata if file.nodata is not None else np.nan))] = np.nan
            heights.append(z)
    known = np.isfinite(truth) & np.isfinite(heights[0]) & np.isfinite(heights[1])
    rmse = lambda z, cells: np.sqrt(np.mean((z - truth)[cells] ** 2)) / interval if cells.any() else np.nan
    for name, cells in (("away", known & away), ("all", known)):
        a, b = rmse(heights[0], cells), rmse(heights[1], cells)
        print(f"{name:5s} {cells.sum() / known.sum():6.1%} of cells  whole {a:.4f}  damaged {b:.4f}  {b / a - 1.0:+.2%}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    make = verbs.add_parser("make")
    make.add_argument("kind", choices=["displace", "patches", "remove", "relabel"])
    make.add_argument("contours")
    make.add_argument("damaged")
    make.add_argument("places")
    make.add_argument("--share", type=float)
    make.add_argument("--seed", type=int, default=1)
    result = verbs.add_parser("score")
    for name in ("truth", "contours", "places", "whole", "damaged"):
        result.add_argument(name)
    args = parser.parse_args()
    if args.verb == "score":
        return score(args.truth, args.contours, np.load(args.places), args.whole, args.damaged)
    share = args.share or (0.01 if args.kind in ("displace", "patches") else 0.05)
    lines, elevation, crs = read(args.contours)
    lines, elevation, places = damaged(args.kind, lines, elevation, share, np.random.default_rng(args.seed))
    write(args.damaged, lines, elevation, crs)
    np.save(args.places, places)


if __name__ == "__main__":
    main()
