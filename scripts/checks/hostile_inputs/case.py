"""What a hostile input is: files in a folder, a command, and what must come of it."""
import pathlib
from typing import Any, Callable, NamedTuple

DENSIFY = "densify {} -i 5 -o out.gpkg --dem out.tif --cell 5"
DEM = "dem {} --cell 5 -o out.tif"


class Case(NamedTuple):
    name: str
    # Writes the input into the folder. What it returns is closed after the run, for instance a lock.
    write: Callable[[pathlib.Path], Any]
    command: str
    refused: bool = False  # the run must fail
    says: str = ""  # words in the error
    keeps: tuple = ()  # files that must be the same afterwards
    file_size: int | None = None  # the largest file that may be written, bytes: a disk that is full
    seconds: float | None = None  # what the run may take, if less than usual
    look: Callable[[pathlib.Path], str | None] = lambda folder: None  # a further look at the folder: what is wrong there
