"""A 3-D model from contour lines or a height map."""
from .. import shared
from ..options import choice, distance, field, file_output, map_layer, number, text, yes
from ..verb import STRUCTURE, Verb


class Mesh(Verb):
    command = "mesh"
    title = "3-D model from contours or a height map"
    place = STRUCTURE
    keywords = ("3d", "mesh", "tin", "triangles", "model", "print", "ply", "obj", "gltf", "glb", "stl", "3mf", "html", "page", "web", "laser", "layers", "plates", "svg", "dxf")
    about = """
Makes a 3-D model (triangle mesh) from contour lines or a height map: PLY, Wavefront OBJ or binary glTF; a solid to print: STL or 3MF; plates to \
cut with a laser: SVG or DXF, with the thickness of the material; or a page that shows the terrain in a browser (HTML). The contours are edges of the triangles; of few triangles, if they are to stay edges.

The model is in metres, relative to an offset that the file states and the log shows. The model of a drawing in feet without \
a coordinate reference system is in feet; a .glb is always in metres. With a height of the bottom, it is a closed solid for \
3-D printing.
"""
    options = [
        map_layer("", "Contour lines or height map", name="INPUT"),
        field("--elevation-field", "For contours: elevation field", "INPUT"),
        number("--base-height", "Height of the bottom of a closed solid [m]"),
        distance("--tolerance", "Few triangles: largest distance from the surface"),
        choice(
            "--keep",
            "Few triangles: lines that stay edges",
            [("none", "none"), ("contours", "contours and break lines"), ("breaklines", "break lines")],
        ),
        distance("--cell", "Few triangles, page: cell size", help="The triangles of a height map have its own cells."),
        number("--size", "STL, 3MF, plates: length of the longer side [mm]"),
        number("--exaggeration", "STL, 3MF, plates: factor on heights"),
        number("--thickness", "Plates: thickness of the material [mm]"),
        text("--sheet", "Plates: width and height of a sheet, such as 600x400 [mm]"),
        number("--interval", "Page: interval of new contours; plates: interval between them [m]"),
        yes("--uncertainty", "Page: expected errors as colours"),
        *shared.TERRAIN,
        *shared.PART,
        *shared.SURFACE,
        *shared.CLEANING,
        file_output("--output", "Model", "PLY (*.ply);;Wavefront OBJ (*.obj);;Binary glTF (*.glb);;STL (*.stl);;3MF (*.3mf);;Plates (*.svg);;DXF (*.dxf);;Page (*.html)", optional=False),
        shared.PREVIEW,
    ]
