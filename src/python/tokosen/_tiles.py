"""Map tiles."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from tokosen import _tokosen


def tiling(zooms: Mapping[int, float] | None, attribution: str | None, overwrite: bool) -> dict[str, Any]:
    """How tiles are written, as the extension module takes it."""
    steps = [] if zooms is None else [(int(zoom), float(step)) for zoom, step in zooms.items()]
    return {"zooms": steps, "attribution": attribution, "overwrite": overwrite}


def viewer(path: str | os.PathLike[str], *, title: str = "tokosen", overwrite: bool = False) -> list[str]:
    """Writes a page that shows the map tiles in its folder in a browser, as `--viewer` of the program; returns their names.

    It shows all .pmtiles and folders of tiles there that tokosen made. Open it from a web server that answers range requests.

    >>> tokosen.densify(tokosen.example(), 5).to_file(folder / "contours.pmtiles")
    >>> tokosen.dem(tokosen.example(), max_zoom=16).to_file(folder / "terrain.pmtiles")
    >>> tokosen.viewer(folder / "index.html")
    ['contours.pmtiles', 'terrain.pmtiles']
    """
    return _tokosen.viewer(os.fspath(path), title, overwrite)


__all__ = ["tiling", "viewer"]
