"""3-D models."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from tokosen import _tokosen


class Mesh:
    """A 3-D model: triangles in space.

    >>> model = tokosen.Terrain(tokosen.example()).mesh(0)
    >>> model.is_solid, model.vertices.shape[1], model.triangles.shape[1]
    (True, 3, 3)
    """

    def __init__(self, model: _tokosen.Model) -> None:
        self._model = model

    @property
    def vertices(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The vertices (n, 3): x, y and height, map coordinates. A new array each time."""
        return self._model.vertices()

    @property
    def triangles(self) -> np.ndarray[Any, np.dtype[np.uint32]]:
        """The triangles (n, 3): indices of vertices, counter-clockwise seen from above. A new array each time."""
        return self._model.triangles()

    @property
    def is_solid(self) -> bool:
        """Whether it is closed by a flat bottom."""
        return self._model.is_solid

    def to_file(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the model: .ply, .obj or .glb; a surface also as .xml (LandXML) or .dxf.

        >>> tokosen.Terrain(tokosen.example()).mesh(0).to_file(folder / "hill.ply")
        """
        self._model.write(os.fspath(path), overwrite)

    def __repr__(self) -> str:
        kind = "solid" if self.is_solid else "shell"
        return f"<Mesh {kind}, {len(self.vertices)} vertices, {len(self.triangles)} triangles>"
