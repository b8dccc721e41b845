"""A 3-D model from contour lines."""
from .. import shared
from ..options import file_output, number
from ..verb import STRUCTURE, Verb


class Mesh(Verb):
    command = "mesh"
    title = "3-D model from contours"
    place = STRUCTURE
    keywords = ("3d", "mesh", "tin", "triangles", "model", "print", "ply", "obj", "gltf", "glb")
    about = """
Makes a 3-D model (triangle mesh) from contour lines: PLY, Wavefront OBJ or binary glTF. The contours are edges of the \
triangles.

The model is in metres, relative to an offset that the file states and the log shows. The model of a drawing in feet without \
a coordinate reference system is in feet; a .glb is always in metres. With a height of the bottom, it is a closed solid for \
3-D printing.
"""
    options = [
        *shared.CONTOURS,
        number("--base-height", "Height of the bottom of a closed solid [m]"),
        *shared.TERRAIN,
        *shared.PART,
        *shared.SURFACE,
        *shared.CLEANING,
        file_output("--output", "Model", "PLY (*.ply);;Wavefront OBJ (*.obj);;Binary glTF (*.glb)", optional=False),
        shared.PREVIEW,
    ]
