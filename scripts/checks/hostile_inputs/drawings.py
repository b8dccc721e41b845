"""Drawings (DXF) and FlatGeobufs that are broken."""
from hostile_inputs.case import DENSIFY, Case
from hostile_inputs.maps import hill


def dxf(entities):
    return "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n"


def dxf_line(points, z):
    return f"0\nLWPOLYLINE\n8\nC\n38\n{z}\n90\n{len(points)}\n" + "".join(f"10\n{x}\n20\n{y}\n" for x, y in points)


DXF_HILL = "".join(dxf_line(f["geometry"]["coordinates"], f["properties"]["elev"]) for f in hill())
DXFS = {
    "empty": "",
    "no end": dxf(DXF_HILL)[:-30],
    "binary": "AutoCAD Binary DXF\r\n\x1a\0" + "\0" * 100,
    "codes of text": dxf("x\ny\n" * 50),
    "arcs of 1e300": dxf("0\nLWPOLYLINE\n8\nC\n38\n5\n10\n0\n20\n0\n42\n1e300\n10\n9\n20\n0\n" + DXF_HILL),
    "vertices without a line": dxf("0\nVERTEX\n10\n1\n20\n1\n" * 100),
    "a line without vertices": dxf("0\nPOLYLINE\n8\nC\n66\n1\n0\nSEQEND\n" + DXF_HILL),
    "a line of 1e9 vertices": dxf("0\nLWPOLYLINE\n8\nC\n90\n1000000000\n38\n1\n10\n0\n20\n0\n" + DXF_HILL),
    "coordinates of words": dxf(DXF_HILL.replace("100.0", "east")),
    "a block in itself": "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nB\n0\nINSERT\n2\nB\n0\nENDBLK\n0\nENDSEC\n" + dxf("0\nINSERT\n2\nB\n" + DXF_HILL),
}
FGBS = {
    "no fgb": b"hello",
    "letters alone": b"fgb\3fgb\0",
    "a head of 4 GB": b"fgb\3fgb\0\xff\xff\xff\xff" + b"\0" * 100,
    "noise": b"fgb\3fgb\0" + bytes(range(256)) * 40,
}


def cases():
    for name, text in DXFS.items():
        yield Case(f"dxf: {name}", lambda folder, text=text: (folder / "a.dxf").write_text(text), DENSIFY.format("a.dxf"))
    for name, data in FGBS.items():
        yield Case(f"fgb: {name}", lambda folder, data=data: (folder / "a.fgb").write_bytes(data), DENSIFY.format("a.fgb"))
