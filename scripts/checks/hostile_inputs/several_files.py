"""Several files as one map, parts of a map, and labels."""
import os

from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import collection, hill, line, ring

SHEETS = {
    "a sheet that is empty": {"a.geojson": collection(hill()), "b.geojson": ""},
    "a sheet without lines": {"a.geojson": collection(hill()), "b.geojson": collection([])},
    "a sheet that is broken": {"a.geojson": collection(hill()), "b.geojson": collection(hill())[:300]},
    "sheets in other systems": {"a.geojson": collection(hill()), "b.geojson": collection(hill(), crs="EPSG:4326")},
    "sheets without a system": {"a.geojson": collection(hill()), "b.geojson": collection(hill(), crs=None)},
    "sheets of two moons": {"a.geojson": collection(hill(), crs="urn:ogc:def:crs:IAU:2015:30100"), "b.geojson": collection(hill(), crs="IAU:49900")},
    "the same sheet a hundred times": {f"s{k}.geojson": collection(hill()) for k in range(100)},
    "sheets with other fields": {"a.geojson": collection(hill()), "b.geojson": collection([line(ring(9), height=50)])},
    "sheets far from each other": {"a.geojson": collection(hill()), "b.geojson": collection([line([[9e6, 9e6], [9e6, 9.1e6]], elev=5)])},
    "sheets of other formats": {"a.geojson": collection(hill()), "b.dxf": "0\nEOF\n", "c.gpkg": "hello", "d.shp": "", "e.fgb": "fgb"},
}
PARTS = {
    "no width": "--extent 5,5,5,5",
    "turned": "--extent 50,50,-50,-50",
    "outside": "--extent 1e6,1e6,2e6,2e6",
    "NaN": "--extent nan,0,1,1",
    "infinite": "--extent=-inf,-inf,inf,inf",
    "1e308": "--extent=-1e308,-1e308,1e308,1e308",
    "a billionth": "--extent 1,1,1.000000001,1.000000001",
    "three numbers": "--extent 1,2,3",
    "in another system": "--extent 0,0,1,1 --extent-crs EPSG:4326",
    "in no system": "--extent 0,0,1,1 --extent-crs nowhere",
    "clip with the contours": "--clip hill.geojson",
    "clip with a missing file": "--clip missing.gpkg",
}
LABELS = ["--labels", "--labels=0", "--labels=-5", "--labels=nan", "--labels=1e300", "--labels=1e-300", "--labels=1e6", "--labels --index 0", "--labels --index 1"]


def write_hill(folder):
    (folder / "hill.geojson").write_text(collection(hill()))


def link_in_a_circle(folder):
    (folder / "sheets").mkdir()
    (folder / "sheets" / "a.geojson").write_text(collection(hill()))
    os.symlink("..", folder / "sheets" / "up")
    os.symlink("loop.geojson", folder / "sheets" / "loop.geojson")


def cases():
    for name, files in SHEETS.items():

        def write(folder, files=files):
            (folder / "sheets").mkdir()
            for file, text in files.items():
                (folder / "sheets" / file).write_text(text)

        yield Case(f"several: {name}", write, DENSIFY.format("sheets"))
        yield Case(f"several, pattern: {name}", write, DENSIFY.format("sheets/*.geojson"))
    yield Case("several: links in a circle", link_in_a_circle, DENSIFY.format("sheets"))
    yield Case("several: no file matches", write_hill, DENSIFY.format("sheets/*.shp"), refused=True)
    yield Case("several: a pattern that is none", write_hill, DENSIFY.format("sheets/[.shp"), refused=True)
    yield Case("several: a name with a bar", write_hill, DENSIFY.format("hill.geojson|layername="))
    for name, part in PARTS.items():
        yield Case(f"parts: {name}", write_hill, DENSIFY.format(f"hill.geojson {part}"))
    for labels in LABELS:
        yield Case(f"labels: {labels}", write_hill, f"densify hill.geojson -i 5 {labels} -o out.gpkg")
        yield Case(f"labels, dxf: {labels}", write_hill, f"densify hill.geojson -i 5 {labels} -o out.dxf")
