#!/usr/bin/env python3
"""Draws the pictures of the guide's pages about maps, from the sample:

- map_25000.png: all lines every 5 m, and those of a map of 1:25 000
- thin_100000.png: steep ground at 1:100 000 with all lines, and with --thin
- shift.png: contours of the height map, and of the same one in another height system
- depths.png: a flood in bands of depth

    cargo build --release
    .venv/bin/python scripts/make/make_map_figure.py target/release/tokosen      # writes samples/figures/*.png
"""
import argparse
import json
import pathlib
import struct
import subprocess
import tempfile

from PIL import Image, ImageDraw

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
LINES, HEIGHTS = SAMPLES / "caryville_20m.gpkg", SAMPLES / "caryville_20m_truth.tif"
VALLEY = (749800, 4020600, 752800, 4023600)  # a valley floor with hills
HILL = (750600, 4020700, 752100, 4022200)
SLOPES = (744600, 4020500, 747400, 4023000)
SCALE, SMALL_SCALE = 25_000, 100_000
PIXELS = 4  # for a millimetre on the map
LARGER = 2  # what is near to each other is drawn larger
FINER = 4  # lines are drawn larger, and then made smaller
GAP = 12  # pixels between both halves
BROWN, GREY = (84, 48, 22), (150, 150, 150)
# The depth of water from shallow to deep.
BLUES = [(222, 235, 247), (158, 202, 225), (66, 146, 198), (8, 81, 156)]
# Width and dashes of each kind of line, millimetres.
LOOKS = {
    "index": (0.3, None),
    "intermediate": (0.15, None),
    "supplementary": (0.15, (2.0, 0.7)),
    "supplementary_quarter": (0.15, (0.7, 0.7)),
}


def dashed(points, dashes):
    """The pieces of a line on paper that are drawn."""
    if not dashes:
        return [points]
    pieces, left, is_on = [[points[0]]], dashes[0], True
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        at = 0.0
        while length - at > left:
            at += left
            place = (x0 + (x1 - x0) * at / length, y0 + (y1 - y0) * at / length)
            if is_on:
                pieces[-1].append(place)
            else:
                pieces.append([place])
            is_on = not is_on
            left = dashes[0] if is_on else dashes[1]
        left -= length - at
        if is_on:
            pieces[-1].append((x1, y1))
    return pieces


class Paper:
    """A map of some place, at a scale."""

    def __init__(self, program, folder, extent, scale, larger=1):
        self.program, self.folder, self.extent = program, folder, extent
        self.millimetre = PIXELS * FINER * larger  # pixels
        self.unit = self.millimetre * 1000 / scale  # pixels for a metre
        size = [round((extent[k + 2] - extent[k]) * self.unit) for k in (0, 1)]
        self.picture = Image.new("RGB", size, "white")
        self.draw = ImageDraw.Draw(self.picture)

    def made(self, *command):
        """The features of the last file that a command writes."""
        path = self.folder / "made.geojson"
        subprocess.run([self.program, *command, path, "--overwrite", "--quiet"], cwd=self.folder, check=True)
        return json.loads(path.read_text())["features"]

    def lines(self, *command, colour=BROWN):
        extent = "--extent=" + ",".join(map(str, self.extent))
        for feature in self.made(*command, extent, "-o"):
            found = feature["properties"]
            width, dashes = LOOKS[found.get("kind") or ("index" if found["is_index"] else "intermediate")]
            on_paper = self.placed(feature["geometry"]["coordinates"])
            for piece in dashed(on_paper, dashes and [length * self.millimetre for length in dashes]):
                self.draw.line(piece, colour, round(width * self.millimetre), "curve")
        return self

    def flood(self, level, depths):
        command = ("derive", HEIGHTS, "--flood-level", level, "--flood-bands", ",".join(map(str, depths)), "--flood")
        found = [(ring_size(part[0]), part, area["properties"]) for area in self.made(*command) for part in parts(area["geometry"])]
        # What lies in a hole is smaller than what is around it; an empty hole is dry.
        for _, (outer, *holes), properties in sorted(found, key=lambda each: -each[0]):
            self.draw.polygon(self.placed(outer), fill=BLUES[[0, *depths].index(properties["depth_from"])])
            for hole in holes:
                self.draw.polygon(self.placed(hole), fill="white")
        return self

    def placed(self, points):
        west, north = self.extent[0], self.extent[3]
        return [((p[0] - west) * self.unit, (north - p[1]) * self.unit) for p in points]

    def done(self):
        width, height = self.picture.size
        self.draw.rectangle((0, 0, width - 1, height - 1), outline=BROWN, width=2)
        return self.picture.resize((width // FINER, height // FINER), Image.Resampling.LANCZOS)


def parts(geometry):
    return [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]


def ring_size(ring):
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(ring, ring[1:])))


def shift(path):
    """A grid of shifts: 3 m in the west of the sample, 5 m in the east."""
    west, south, step, columns = -84.4, 36.2, 0.1, 4
    rows = [[3 + 2 * k / (columns - 1) for k in range(columns)]] * columns
    head = struct.pack(">4d2i", south, west, step, step, columns, columns)
    path.write_bytes(head + b"".join(struct.pack(f">{columns}f", *row) for row in rows))
    return path


def save(name, *halves, colours=16):
    width, height = halves[0].size
    picture = Image.new("RGB", (len(halves) * (width + GAP) - GAP, height), "white")
    for k, part in enumerate(halves):
        picture.paste(part, (k * (width + GAP), 0))
    path = SAMPLES / "figures" / f"{name}.png"
    picture.quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path.name}: {picture.width} x {picture.height}, {path.stat().st_size} bytes")


def main():
    args = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    args.add_argument("program", help="the tokosen binary")
    program = pathlib.Path(args.parse_args().program).resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        paper = lambda *place: Paper(program, folder, *place)
        densify, contour = ("densify", LINES, "-i"), ("contour", HEIGHTS, "-i")
        for_map = (*densify, "20", "--supplementary", "10,5", "--scale", str(SCALE))
        valley = [paper(VALLEY, SCALE).lines(*command).done() for command in ((*densify, "5", "--index", "20"), for_map)]
        save("map_25000", *valley)
        steep = (*densify, "10", "--scale", str(SMALL_SCALE))
        save("thin_100000", *(paper(SLOPES, SMALL_SCALE, 2 * LARGER).lines(*steep, *more).done() for more in ((), ("--thin",))), colours=8)
        grid = shift(folder / "shift.gtx")
        both = paper(HILL, SCALE, LARGER).lines(*contour, "20", colour=GREY).lines(*contour, "20", "--vertical-shift", grid)
        save("shift", both.done())
        save("depths", paper(VALLEY, SCALE).flood("330", [1, 3, 6]).lines(*contour, "10").done(), colours=32)


if __name__ == "__main__":
    main()
