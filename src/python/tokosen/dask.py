"""The tasks of a plan on a Dask cluster, and its height map as a Dask-backed xarray.

    from dask.distributed import Client
    import tokosen.dask

    client = Client("scheduler:8786")
    tokosen.dask.run("plan", client)                 # what 'tokosen work plan' does, on all workers
    heights = tokosen.dask.heights("plan")           # xarray.DataArray; blocks are read when they are needed

`tokosen plan` makes the folder, and `tokosen join` joins the lines. All workers must see the folder under the same path: a local or
mounted disk. Each task writes its files and returns only its name. So when a worker is killed, Dask repeats the tasks that were
running, and those whose files are whole are not done again.
"""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

_HEADER = 32
"""Bytes before the heights of a tile."""


def _manifest(plan: str | os.PathLike[str]) -> dict[str, Any]:
    manifest: dict[str, Any] = json.loads((Path(plan) / "manifest.json").read_text(encoding="utf-8"))
    return manifest


def _work(plan: str, task: str, threads: int) -> str:
    """Does a task in a process of its own: its memory is free again afterwards."""
    command = [sys.executable, "-m", "tokosen", "work", plan, "--task", task, "--quiet", "--threads", str(threads)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"task {task}: {done.stderr.strip() or f'ended with status {done.returncode}'}")
    return task


def run(plan: str | os.PathLike[str], client: Any, *, retries: int = 10, threads: int = 1) -> list[str]:
    """Does the tasks of a plan on the workers of a Dask client, and returns their names.

    A task that fails is tried again `retries` times; then the error names it. Tasks that are done stay done: the same call goes on
    with the others. `threads` is the number of threads of each task.

    While no worker is left, Dask waits for one. After three killed workers it gives a task up; its setting
    `distributed.scheduler.allowed-failures` allows more.
    """
    folder = str(Path(plan).resolve())
    futures: dict[str, Any] = {}
    for task in _manifest(plan)["tasks"]:
        needs = [futures[need] for need in task["needs"]]
        futures[task["id"]] = client.submit(
            # A key of its own: Dask must not take the answer of a former run.
            _after, needs, folder, task["id"], threads, key=f"tokosen-{task['id']}-{os.urandom(4).hex()}", retries=retries
        )
    done: list[str] = client.gather(list(futures.values()))
    return done


def _after(needs: list[str], plan: str, task: str, threads: int) -> str:
    """Does a task after those that it needs."""
    del needs
    return _work(plan, task, threads)


def _block(plan: str, tasks: list[dict[str, Any]], rows: tuple[int, int], cols: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Reads some cells of the height map from the files of the tiles."""
    import numpy as np

    heights = np.full((rows[1] - rows[0], cols[1] - cols[0]), np.nan, dtype=np.float32)
    for task in tasks:
        cells = task["cells"]
        top, left = cells["row"], cells["col"]
        first, last = max(rows[0], top), min(rows[1], top + cells["rows"])
        west, east = max(cols[0], left), min(cols[1], left + cells["cols"])
        if first >= last or west >= east:
            continue
        name = next(name for name in task["outputs"] if name.endswith(".heights"))
        shape = (cells["rows"], cells["cols"])
        tile = np.memmap(Path(plan) / name, dtype="<f4", mode="r", offset=_HEADER, shape=shape)
        part = tile[first - top : last - top, west - left : east - left]
        heights[first - rows[0] : last - rows[0], west - cols[0] : east - cols[0]] = part
    return heights


def heights(plan: str | os.PathLike[str], chunk: int = 2048) -> Any:
    """The height map of a plan whose tasks are done, as an `xarray.DataArray` over Dask, metres. Needs dask and xarray."""
    import numpy as np
    import xarray

    # Dask has types for a part of its functions only.
    arrays: Any = importlib.import_module("dask.array")
    delayed: Any = importlib.import_module("dask").delayed

    manifest = _manifest(plan)
    grid = manifest["shared"]["cells"]
    if grid is None:
        raise ValueError("this plan has no height map: name the size of its cells when the plan is made")
    folder, tasks = str(Path(plan).resolve()), [task for task in manifest["tasks"] if task["cells"] is not None]
    rows, cols = grid["rows"], grid["cols"]
    bands = []
    for top in range(0, rows, chunk):
        band = []
        for left in range(0, cols, chunk):
            size = (min(chunk, rows - top), min(chunk, cols - left))
            block = delayed(_block)(folder, tasks, (top, top + size[0]), (left, left + size[1]))
            band.append(arrays.from_delayed(block, size, dtype=np.float32))
        bands.append(band)
    (west, north), (width, height) = grid["corner"], grid["cell"]
    x = west + (np.arange(cols) + 0.5) * width
    y = north - (np.arange(rows) + 0.5) * height
    return xarray.DataArray(arrays.block(bands), coords={"y": y, "x": x}, dims=("y", "x"), name="height", attrs={"units": "m"})
