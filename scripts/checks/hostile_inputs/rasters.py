"""Height maps that are broken, or hold other things than heights, for all commands that read them."""
import struct

from hostile_inputs.case import Case
from hostile_inputs.maps import collection, hill

ASC = "ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize {}\n{}"
RASTERS = {
    "no tif": ("a.tif", b"hello"),
    "a tif of 4e9 tiles": ("a.tif", struct.pack("<2sHIH", b"II", 42, 8, 4) + b"".join(struct.pack("<HHII", t, 4, 1, v) for t, v in ((256, 2**31 - 1), (257, 2**31 - 1), (258, 32), (339, 3))) + b"\0" * 4),
    "a tif that turns in a circle": ("a.tif", struct.pack("<2sHIH", b"II", 42, 8, 0) + struct.pack("<I", 8)),
    "asc of negative size": ("a.asc", ASC.format(-3, 4, 1, "1 2 3").encode()),
    "asc of 1e18 cells": ("a.asc", ASC.format(10**9, 10**9, 1, "1 2 3").encode()),
    "asc with cells of 0": ("a.asc", ASC.format(2, 2, 0, "1 2 3 4").encode()),
    "asc of words": ("a.asc", ASC.format(2, 2, 1, "one two three four").encode()),
    "asc of NaN": ("a.asc", ASC.format(2, 2, 1, "nan nan nan nan").encode()),
    "no exr": ("a.exr", b"\x76\x2f\x31\x01" + b"\xff" * 200),
    "asc of one cell": ("a.asc", ASC.format(1, 1, 1, "5").encode()),
    "asc without data": ("a.asc", ASC.format(2, 2, 1, "NODATA_value 5\n5 5 5 5").encode()),
    "asc of 1e308": ("a.asc", ASC.format(3, 3, 1, "1e308 -1e308 " * 4 + "1").encode()),
    "asc at 1e300": ("a.asc", ASC.replace("xllcorner 0", "xllcorner 1e300").format(3, 3, 1, "1 2 3 4 5 6 7 8 9").encode()),
    "asc with cells of 1e-300": ("a.asc", ASC.format(3, 3, 1e-300, "1 2 3 4 5 6 7 8 9").encode()),
    "asc that is level": ("a.asc", ASC.format(30, 30, 1, "5 " * 900).encode()),
    "asc of a chequerboard": ("a.asc", ASC.format(101, 101, 1, "0 100 " * 5100 + "0").encode()),
    "asc of spikes": ("a.asc", ASC.format(60, 60, 1, " ".join(str(10 ** (k % 37)) for k in range(3600))).encode()),
    "asc with holes": ("a.asc", ASC.format(60, 60, 1, "NODATA_value -1\n" + " ".join("-1" if k % 2 else str(k) for k in range(3600))).encode()),
    "a png of one byte": ("a.png", b"\x89"),
}

# Beside the hill, as another height map.
BESIDE = {
    "base": "dem hill.geojson --cell 5 --base {} -o out.tif",
    "like": "dem hill.geojson --like {} -o out.tif",
    "compare": "compare hill.geojson {} -o out.tif",
}
COMMANDS = {"raster": "derive {} --slope out.tif", "contour": "contour {} -i 10 -o out.gpkg", "flow": "derive {} --flow-accumulation out.tif"}


def cases():
    for name, (file, data) in RASTERS.items():

        def write(folder, file=file, data=data):
            (folder / "hill.geojson").write_text(collection(hill()))
            (folder / file).write_bytes(data)

        for kind, command in {**COMMANDS, **BESIDE}.items():
            yield Case(f"{kind}: {name}", write, command.format(file))
