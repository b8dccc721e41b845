"""What the tests share: the samples, a folder for each test, and what the examples in the documentation use."""

import pathlib
import subprocess
import sys

import numpy
import pytest

import tokosen

ROOT = pathlib.Path(__file__).parents[3]
SAMPLES = ROOT / "samples"


@pytest.fixture(autouse=True)
def names_of_examples(doctest_namespace, tmp_path):
    """The names that examples may use without an import."""
    doctest_namespace.update(tokosen=tokosen, np=numpy, folder=tmp_path, samples=SAMPLES)


@pytest.fixture(scope="session")
def part(tmp_path_factory):
    """A part of the large sample, 3500 x 3000 m."""
    path = tmp_path_factory.mktemp("part") / "part.gpkg"
    given = [SAMPLES / "caryville_20m.gpkg", "-i", "20", "--extent", "745000,4017500,748500,4020500", "-o", path, "-q"]
    subprocess.run([sys.executable, "-m", "tokosen", "densify", *map(str, given)], check=True)
    return path


@pytest.fixture
def program(tmp_path):
    """Runs the program of the package in the folder of the test."""

    def run(*arguments, status=0):
        command = [sys.executable, "-m", "tokosen", *map(str, arguments)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == status, done.stderr
        return done

    return run
