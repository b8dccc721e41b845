#!/usr/bin/env python3
"""Calibration of standard errors: the share of true errors within one and within two standard errors.

    calibration.py TRUTH.tif INTERVAL TWO_BANDS.tif [--json]

TRUTH holds the heights that contour lines were cut from at INTERVAL metres. TWO_BANDS is the result of `tokosen dem --like
TRUTH --uncertainty` from those lines alone: heights and standard errors on the same grid. With --sample the height map of a
sample is made first. The program is found on the path, or named by the environment variable TOKOSEN:

    calibration.py --sample

One row per class of cells: all; near a contour (the height is within an eighth of the interval of a level); in the middle
of a band; steep and gentle ground (the steepest and the gentlest quarter); the largest and the smallest quarter of the
stated errors; tops and pits (above the highest or below the lowest contour around, where the truth reaches no further
level). For normally distributed errors, 68 and 95 per cent are right.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np
import rasterio
from scipy import ndimage

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
SAMPLE = (SAMPLES / "caryville_20m_truth.tif", 20.0, SAMPLES / "caryville_20m.gpkg")
RIM = 0.01  # share of columns and rows at the border that is left out


def band(path, number):
    with rasterio.open(path) as file:
        values = file.read(number).astype(float)
        nodata = file.nodatavals[number - 1]
        if nodata is not None:
            values[values == nodata] = np.nan
        return values, file.transform


def beyond(truth, interval):
    """Cells whose patch of ground between two levels touches only one neighbouring patch level: tops and pits."""
    level = np.where(np.isfinite(truth), np.floor(truth / interval), np.nan)
    out = np.zeros(truth.shape, bool)
    for k in np.unique(level[np.isfinite(level)]):
        patches, count = ndimage.label(level == k)
        if not count:
            continue
        sides = []
        for other in (level < k, level > k):
            touched = np.unique(patches[ndimage.binary_dilation(other, np.ones((3, 3))) & (patches > 0)])
            has = np.zeros(count + 1, bool)
            has[touched] = True
            sides.append(has)
        alone = sides[0] != sides[1]
        alone[0] = False
        out |= alone[patches]
    return out


def classes(truth, heights, errors, transform, interval):
    south, east = np.gradient(heights, -transform.e, transform.a)
    slope = np.hypot(south, east)
    rim = np.zeros(truth.shape, bool)
    rows, cols = (max(1, round(RIM * n)) for n in truth.shape)
    rim[rows:-rows, cols:-cols] = True
    use = np.isfinite(truth) & np.isfinite(heights) & np.isfinite(errors) & np.isfinite(slope) & rim
    part = np.mod(heights, interval) / interval
    near = np.minimum(part, 1 - part)
    alone = beyond(truth, interval)
    low, high = np.percentile(slope[use & ~alone], [25, 75])
    small, large = np.percentile(errors[use], [25, 75])
    return {
        "all": use,
        "near a contour": use & ~alone & (near < 0.125),
        "middle of a band": use & ~alone & (near > 0.375),
        "steep": use & ~alone & (slope > high),
        "gentle": use & ~alone & (slope < low),
        "tops and pits": use & alone,
        "large errors": use & (errors >= large),
        "small errors": use & (errors <= small),
    }


def table(truth_file, interval, dem_file):
    truth, transform = band(truth_file, 1)
    heights, placed = band(dem_file, 1)
    errors, _ = band(dem_file, 2)
    if heights.shape != truth.shape or not np.allclose(transform[:6], placed[:6]):
        raise SystemExit(f"{dem_file}: not on the grid of {truth_file}")
    off = np.abs(heights - truth)
    rows = {}
    for name, cells in classes(truth, heights, errors, transform, interval).items():
        if cells.any():
            a, s = off[cells], errors[cells]
            rows[name] = {
                "cells": int(cells.sum()),
                "within 1": float(100 * (a <= s).mean()),
                "within 2": float(100 * (a <= 2 * s).mean()),
                "rms error": float(np.sqrt((a**2).mean())),
                "rms stated": float(np.sqrt((s**2).mean())),
            }
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("truth", nargs="?")
    parser.add_argument("interval", nargs="?", type=float)
    parser.add_argument("dem", nargs="?")
    parser.add_argument("--sample", action="store_true", help="make the height map of a sample, and examine it")
    parser.add_argument("--json", action="store_true")
    wanted = parser.parse_args()
    if wanted.sample:
        truth, interval, lines = SAMPLE
        with tempfile.TemporaryDirectory() as folder:
            dem = os.path.join(folder, "dem.tif")
            program = os.environ.get("TOKOSEN", "tokosen")
            command = [program, "dem", lines, "--like", truth, "--uncertainty", "-o", dem]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            rows = table(truth, interval, dem)
    elif wanted.dem:
        rows = table(wanted.truth, wanted.interval, wanted.dem)
    else:
        parser.error("name TRUTH, INTERVAL and the height map, or --sample")
    if wanted.json:
        print(json.dumps(rows, indent=1))
        return
    print(f"{'':18s}{'cells':>10s}{'within 1':>10s}{'within 2':>10s}{'rms error':>11s}{'rms stated':>12s}")
    for name, row in rows.items():
        print(
            f"{name:18s}{row['cells']:10d}{row['within 1']:9.1f}%{row['within 2']:9.1f}%"
            f"{row['rms error']:11.3f}{row['rms stated']:12.3f}"
        )


if __name__ == "__main__":
    main()
