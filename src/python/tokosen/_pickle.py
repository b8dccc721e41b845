"""How objects of the extension module are pickled: by what they consist of. So they go to other processes (multiprocessing, Dask)."""

from __future__ import annotations

import copyreg
from typing import Any

from tokosen import _tokosen


def raster(*state: Any) -> _tokosen.Raster:
    """A raster of its parts."""
    return _tokosen.Raster.restore(*state)


def layer(state: Any) -> _tokosen.Layer:
    """A layer of its parts."""
    return _tokosen.restored_layer(state)


def model(state: Any) -> _tokosen.Model:
    """A model of its parts."""
    return _tokosen.Model.restore(state)


copyreg.pickle(_tokosen.Raster, lambda given: (raster, given.state()))
copyreg.pickle(_tokosen.Layer, lambda given: (layer, (_tokosen.layer_state(given),)))
copyreg.pickle(_tokosen.Model, lambda given: (model, (given.state(),)))
