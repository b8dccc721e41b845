#!/usr/bin/env python3
"""Opens output files of every format with GDAL, and compares them with the GeoPackage and the GeoTIFF.

    cargo build --release
    .venv/bin/python scripts/checks/check_formats.py target/release/tokosen

GDAL comes with pyogrio and rasterio (scripts/requirements.txt). A raster format that rasterio's GDAL lacks is converted by
the command line tools (gdalinfo, gdal_translate) if they are installed and support it; otherwise it is reported as skipped.

Vectors: coordinate reference system, number of features, every coordinate bit for bit, every attribute that the format can
keep, and the number of features in a window. Features may be in another order, rings in the other direction. Rasters:
coordinate reference system, placement to a billionth of a cell, cells without data, heights; on a plane and in degrees.
Exit status 1 if anything differs.
"""
import argparse
import collections
import pathlib
import subprocess
import sys
import tempfile

import numpy
import pyogrio
import pyproj
import rasterio
import shapely

SAMPLE = pathlib.Path(__file__).resolve().parents[2] / "samples" / "caryville_20m.gpkg"

# Verb and its options; what they write is compared.
VECTOR_RUNS = [("densify", "-i 5"), ("skeleton", ""), ("regions", "")]
# Extension, whether the format names the system, whether it keeps attributes.
VECTORS = [("geojson", True, True), ("shp", True, True), ("fgb", True, True), ("dxf", False, False)]

# What is written, with the options that place its cells.
RASTER_RUNS = [("dem", "--cell 20"), ("dem in degrees", "--cell-degrees 1s")]
# Extension, whether the format names the system, how far a height may be off: a number of metres, or "step" for half the
# step that the file states.
RASTERS = [("exr", True, 0.0), ("png", True, "step"), ("asc", True, 0.0), ("xyz", False, 0.0)]
# Formats that list the cells with data, so that rows and columns without any at the edges are missing.
LISTS = ["xyz"]


def run(program, verb, options, output):
    command = [program, verb, SAMPLE, "-q", "-o", output, *options.split()]
    subprocess.run(command, check=True)


def same_system(a, b):
    return bool(a) and bool(b) and pyproj.CRS.from_user_input(a).equals(pyproj.CRS.from_user_input(b), ignore_axis_order=True)


# ---- vectors


def ring_bytes(ring, is_hole):
    """A ring's coordinates as bytes, turned to the left if it is an outer one, to the right if it is a hole."""
    points = shapely.get_coordinates(ring)
    return (points if shapely.is_ccw(ring) != is_hole else points[::-1]).tobytes()


def shape_bytes(geometry):
    """All coordinates of a feature, so that equal bytes are equal features."""
    parts = []
    for part in shapely.get_parts(geometry):
        if part.geom_type == "Polygon":
            parts.append(ring_bytes(part.exterior, False))
            parts.extend(ring_bytes(hole, True) for hole in part.interiors)
        else:
            parts.append(shapely.get_coordinates(part, include_z=True).tobytes())
    return b"|".join(parts)


def plain(value):
    """A value as every format means it."""
    if value is None or (isinstance(value, (float, numpy.floating)) and numpy.isnan(value)):
        return None
    return float(value) if isinstance(value, (bool, numpy.bool_, int, float, numpy.number)) else str(value)


class Features:
    """The features of a file, as GDAL reads them."""

    def __init__(self, path):
        self.path = path
        meta, _, geometry, columns = pyogrio.raw.read(path)
        self.system = meta["crs"]
        self.shapes = shapely.from_wkb(geometry)
        names = [str(name) for name in meta["fields"]]
        cells = [[plain(value) for value in column] for column in columns]
        self.attributes = [dict(zip(names, row)) for row in zip(*cells)] if names else [{} for _ in self.shapes]

    def counted(self, names):
        rows = zip(self.shapes, self.attributes)
        return collections.Counter((shape_bytes(s), tuple(a.get(name) for name in names)) for s, a in rows)

    def in_window(self, window):
        return len(pyogrio.raw.read(self.path, bbox=window, columns=[])[2])


def outlines(shapes):
    """What a format without areas has of a layer: lines as they are, of areas each ring."""
    for part in shapely.get_parts(shapes):
        if part.geom_type == "Polygon":
            yield ring_bytes(part.exterior, False)
            yield from (ring_bytes(hole, False) for hole in part.interiors)
        else:
            yield shapely.get_coordinates(part, include_z=True).tobytes()


def drawn_outlines(shapes, flat):
    """The lines of a drawing; those that stand for rings turned to the left and without their height of 0."""
    for line in shapely.get_parts(shapes):
        yield ring_bytes(line, False) if flat else shapely.get_coordinates(line, include_z=True).tobytes()


def drawing_layer(attributes):
    """The layer that a contour belongs on."""
    name = "CONTOUR-" + attributes["source"].upper()
    return name + "-INDEX" if attributes["is_index"] else name


def compare_vectors(reference, found, has_system, has_attributes):
    """The differences, as words."""
    wrong = []
    if has_system and not same_system(reference.system, found.system):
        wrong.append(f"system {found.system!r}")
    if has_attributes:
        names = [name for name in reference.attributes[0] if name != "fid"]
        if len(found.shapes) != len(reference.shapes):
            wrong.append(f"{len(found.shapes)} features")
        missing = reference.counted(names) - found.counted(names)
        if missing:
            shapes = {shape for shape, _ in found.counted(names)}
            moved = sum(count for (shape, _), count in missing.items() if shape not in shapes)
            wrong.append(f"{moved} features with other coordinates, {sum(missing.values()) - moved} with other attributes")
    else:
        flat = shapely.get_type_id(reference.shapes[0]) == shapely.GeometryType.POLYGON
        lines = collections.Counter(outlines(reference.shapes))
        missing = lines - collections.Counter(drawn_outlines(found.shapes, flat))
        if missing or len(found.shapes) != lines.total():
            wrong.append(f"{len(found.shapes)} lines, {missing.total()} with other coordinates")
        if "source" in reference.attributes[0]:
            wanted = collections.Counter(drawing_layer(row) for row in reference.attributes)
            if wanted != collections.Counter(row["Layer"] for row in found.attributes):
                wrong.append("other layers")
    bounds = shapely.total_bounds(reference.shapes)
    centre, size = (bounds[:2] + bounds[2:]) / 2, (bounds[2:] - bounds[:2]) / 7
    window = (*(centre - size / 2), *(centre + size / 2))
    if has_attributes and reference.in_window(window) != found.in_window(window):
        wrong.append("another number of features in a window")
    return wrong


# ---- rasters


def heights(path):
    """Heights with NaN where there are none, placement, system and step of a raster."""
    with rasterio.open(path) as file:
        values = file.read(1, masked=True).astype("f8").filled(numpy.nan)
        values = values * file.scales[0] + file.offsets[0]
        return values, file.transform, file.crs, file.scales[0]


def readable(path, extension):
    """The file, or a GeoTIFF made of it where rasterio cannot read it; None if nothing can."""
    with rasterio.Env() as environment:
        known = {name.lower() for name in environment.drivers()} | set(rasterio.drivers.raster_driver_extensions())
    if extension in known:
        return path
    try:
        formats = subprocess.run(["gdalinfo", "--formats"], capture_output=True, text=True, check=True).stdout
    except FileNotFoundError:
        return None
    if f" {extension.upper()} -raster" not in formats:
        return None
    converted = path.with_suffix(f".{extension}.tif")
    subprocess.run(["gdal_translate", "-q", "-of", "GTiff", path, converted], check=True)
    return converted


def laid_out(found, reference):
    """A list of cells on the cells of the reference; as it is if it does not fit on them."""
    values, transform, system, step = found
    whole, placement = reference[0].shape, reference[1]
    column, row = ~placement @ (transform.c, transform.f)
    left, top = round(column), round(row)
    fits = max(abs(column - left), abs(row - top)) < 1e-9 and min(left, top) >= 0
    if not fits or left + values.shape[1] > whole[1] or top + values.shape[0] > whole[0]:
        return found
    laid = numpy.full(whole, numpy.nan)
    laid[top : top + values.shape[0], left : left + values.shape[1]] = values
    origin = rasterio.Affine(transform.a, transform.b, placement.c, transform.d, transform.e, placement.f)
    return laid, origin, system, step


def compare_rasters(reference, found, has_system, tolerance):
    """The differences, as words."""
    wrong = []
    values, transform, system, _ = reference
    other, other_transform, other_system, step = found
    if has_system and not same_system(system, other_system):
        wrong.append(f"system {other_system}")
    if any(abs(a - b) > 1e-9 * transform.a for a, b in zip(transform, other_transform)):
        wrong.append(f"placement {tuple(other_transform)}")
    if values.shape != other.shape:
        return [*wrong, f"{other.shape} cells"]
    if (numpy.isnan(values) != numpy.isnan(other)).any():
        wrong.append("other cells without data")
    # Half a step, and what the sum of offset and steps is rounded by.
    allowed = step / 2 + 1e-9 * numpy.nanmax(numpy.abs(values)) if tolerance == "step" else tolerance
    off = numpy.nanmax(numpy.abs(values - other))
    if not off <= allowed:
        wrong.append(f"heights off by {off} m, {allowed} m allowed")
    return wrong


# ---- the table


def show(what, extension, size, wrong):
    print(f"{what:<16} {extension:<8} {size:<24} {'; '.join(wrong) if wrong else 'same'}")
    return bool(wrong)


def check_vectors(program, folder):
    failed = False
    for verb, options in VECTOR_RUNS:
        paths = {extension: folder / f"{verb}.{extension}" for extension in ["gpkg", *(v[0] for v in VECTORS)]}
        for path in paths.values():
            run(program, verb, options, path)
        reference = Features(paths["gpkg"])
        vertices = shapely.get_num_coordinates(reference.shapes).sum()
        for extension, has_system, has_attributes in VECTORS:
            found = Features(paths[extension])
            wrong = compare_vectors(reference, found, has_system, has_attributes)
            failed |= show(verb, extension, f"{len(reference.shapes)} of {vertices} vertices", wrong)
    return failed


def check_rasters(program, folder):
    failed = False
    for number, (what, options) in enumerate(RASTER_RUNS):
        name = f"dem{number}"
        run(program, "dem", options, folder / f"{name}.tif")
        reference = heights(folder / f"{name}.tif")
        rows, columns = reference[0].shape
        for extension, has_system, tolerance in RASTERS:
            # Names of their own, because formats share the names of files beside them.
            path = folder / f"{name}_{extension}.{extension}"
            run(program, "dem", options, path)
            opened = readable(path, extension)
            if opened is None:
                print(f"{what:<16} {extension:<8} {'':<24} skipped: this GDAL cannot read it")
                continue
            found = heights(opened)
            found = laid_out(found, reference) if extension in LISTS else found
            wrong = compare_rasters(reference, found, has_system, tolerance)
            failed |= show(what, extension, f"{columns} x {rows} cells", wrong)
    return failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path, help="the tokosen binary")
    program = parser.parse_args().program.resolve()
    print(f"GDAL {pyogrio.__gdal_version_string__} for vectors, {rasterio.__gdal_version__} for rasters")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        failed = check_vectors(program, folder)
        failed |= check_rasters(program, folder)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
