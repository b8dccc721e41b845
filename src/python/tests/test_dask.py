"""The tasks of a plan through Dask's interface, and its height map in blocks."""

import numpy
import pytest
import tokosen.dask

from conftest import SAMPLES


class Client:
    """What is used of a Dask client: work is done when it is asked for, and a task may be tried again."""

    def __init__(self):
        self.keys = []

    def submit(self, work, *arguments, key, retries):
        self.keys.append(key)
        for left in range(retries, -1, -1):
            try:
                return work(*arguments)
            except RuntimeError:
                if left == 0:
                    raise

    def gather(self, futures):
        return futures


@pytest.fixture
def plan(program, tmp_path):
    program("plan", SAMPLES / "fig1f_nested.geojson", "--cell", 10, "--tile-side", 600, "--surface", "linear", "-o", "plan")
    return tmp_path / "plan"


def test_tasks_are_done_once(plan, program):
    client = Client()
    names = tokosen.dask.run(plan, client)
    assert len(names) == len(set(names)) == len(set(client.keys)) >= 4
    assert program("work", "plan", "--list").stdout == ""
    (plan / "tiles" / f"{names[1]}.heights").write_bytes(b"cut off")
    assert program("work", "plan", "--list").stdout.split() == [names[1]]
    assert tokosen.dask.run(plan, Client()) == names
    assert program("work", "plan", "--list").stdout == ""


def test_a_task_that_fails_is_named(plan):
    damaged = sorted(plan.glob("tiles/*.lines"))[1]
    damaged.write_bytes(b"broken")
    with pytest.raises(RuntimeError, match=f"task {damaged.stem}: .*make the plan again"):
        tokosen.dask.run(plan, Client(), retries=1)


def test_heights_are_those_of_the_joined_raster(plan, program, tmp_path):
    pytest.importorskip("dask.array")
    pytest.importorskip("xarray")
    tokosen.dask.run(plan, Client())
    heights = tokosen.dask.heights(plan, chunk=37)
    program("join", "plan", "--dem", "dem.xyz")
    joined = numpy.loadtxt(tmp_path / "dem.xyz")
    found = heights.compute().to_series().dropna()
    assert len(found) == len(joined) > 1000
    by_place = {(x, y): z for x, y, z in joined}
    assert all(abs(by_place[x, y] - z) < 1e-3 for (y, x), z in found.items())
