"""Terrain from contour lines: denser contours, height maps, ridge and canyon lines, and comparison with height maps.

    import tokosen

    lines = tokosen.densify(gdf, 2)                      # a GeoDataFrame in, a GeoDataFrame out
    dem = tokosen.dem(gdf, cell=5, uncertainty=True)     # dem.values, dem.error, dem.to_xarray(), dem.to_file("dem.tif")

    terrain = tokosen.Terrain(gdf, streams="rivers.gpkg", water="lakes.gpkg")     # build once, ask often
    terrain.contours([5, 2, 1]); terrain.dem(cell=10); terrain.findings; terrain.accuracy

    tokosen.check(gdf); tokosen.compare(gdf, "published.tif"); tokosen.derive(dem, "slope")

Contours are a path, a GeoDataFrame, an Arrow table with GeoArrow geometries, an object with `__geo_interface__`, or numpy
arrays. Functions take keyword arguments with the names of the program's flags (`tokosen dem --help`). Results are the same as
those of the program. While the work is done, other threads of Python run, and Ctrl-C stops it. The environment variable
RAYON_NUM_THREADS sets the number of threads; the result does not depend on it.
"""

from tokosen import _pickle as _pickle
from tokosen._dem import Dem, Transform, Volume
from tokosen._errors import Error, FileError, FindingWarning, InputError, OutOfMemoryError, ParameterError
from tokosen._example import example
from tokosen._layers import Layer
from tokosen._mesh import Mesh
from tokosen._terrain import Accuracy, Terrain
from tokosen._tiles import viewer
from tokosen._tokosen import __version__
from tokosen._verbs import Check, Comparison, bands, check, compare, contour, dem, densify, derive, mesh, regions, skeleton

__all__ = [
    "Accuracy",
    "Check",
    "Comparison",
    "Dem",
    "Error",
    "FileError",
    "FindingWarning",
    "InputError",
    "Layer",
    "Mesh",
    "OutOfMemoryError",
    "ParameterError",
    "Terrain",
    "Transform",
    "Volume",
    "__version__",
    "bands",
    "check",
    "compare",
    "contour",
    "dem",
    "densify",
    "derive",
    "example",
    "mesh",
    "regions",
    "skeleton",
    "viewer",
]

# So messages of uncaught exceptions have the names that users catch.
for _exception in (Error, FileError, FindingWarning, InputError, OutOfMemoryError, ParameterError):
    _exception.__module__ = __name__
