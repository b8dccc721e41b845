"""Arguments are flags of the program, none of its flags is forgotten, and both have the same defaults."""

import inspect
import re
import typing

import pytest

import tokosen
from tokosen import _options

# Flags about files, pictures and the run: functions return results, and a result has a method that writes or draws it.
NO_ARGUMENTS = {
    "help", "output", "preview", "diagnostics", "quiet", "verbose", "overwrite", "threads", "save-run", "labels", "bands", "cog",
    "png-encoding", "report", "page", "json", "zooms", "tile-image", "viewer", "attribution",
    "paper", "scale", "title", "source", "font", "for", "size", "stac",
}
# Names that differ: a flag that switches something off is an argument that is true.
RENAMED = {"elevation-field": "elevation", "no-extend": "extend"}
# Flags whose work is another function or a method of the result: `Dem.to_file` has the unit of a height map, `Dem.shifted` brings
# it to another height system, and a `Dem` has its
# own system. `Terrain.to_html` makes the page of a model; models to print and to cut are made by the program.
LEFT_OUT = {
    "dem": {"to-unit", "vertical-shift", "vertical-shift-inverse"},
    "contour": {"crs", "vertical-shift", "vertical-shift-inverse"},
    "densify": {"dem", "cell", "cell-degrees", "like", "max-zoom", "tile-size", "compare"},
    "skeleton": {"triangles", "curve-mesh"},
    "mesh": {"interval", "uncertainty", "size", "exaggeration", "thickness", "sheet"},
    "derive": {
        "slope", "aspect", "hillshade", "steep", "flow-direction", "flow-accumulation", "catchments", "cell", "cell-degrees",
        "like", "to-crs",
    },
    "check": {"strict"},
}
VERBS = ["densify", "dem", "mesh", "regions", "skeleton", "contour", "check"]


def flags_of(program, verb):
    """The flags of a verb, each with its default or None."""
    help_ = program(verb, "--help").stdout
    found, name = {}, None
    for line in help_.splitlines():
        if flag := re.match(r"^ +(?:-\w, )?--([\w-]+)", line):
            name = flag.group(1)
            found.setdefault(name, None)
        if name and (default := re.search(r"\[default: ([\w.]+)\]", line)):
            found[name] = default.group(1)
    return found


def arguments_of(verb):
    """The keyword arguments of a function, each with its default."""
    found = {}
    for name, parameter in inspect.signature(getattr(tokosen, verb)).parameters.items():
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            options = typing.get_args(typing.get_type_hints(getattr(tokosen, verb))["given"])[0]
            found |= {name: _options._DEFAULTS[name] for name in _options._names(options)}
        else:
            found[name] = parameter.default
    return found


@pytest.mark.parametrize("verb", VERBS)
def test_arguments_are_flags(program, verb):
    flags, arguments = flags_of(program, verb), arguments_of(verb)
    assert len(flags) > 10
    wanted = flags.keys() - NO_ARGUMENTS - LEFT_OUT.get(verb, set())
    named = {RENAMED.get(flag, flag.replace("-", "_")): flag for flag in wanted}
    missing = {flag for name, flag in named.items() if name not in arguments}
    assert missing - {"progress"} == set()
    compared = 0
    for name, flag in named.items():
        default = flags[flag]
        # "auto" and None say the same of what is chosen from the contours.
        if default is not None and arguments.get(name) is not None:
            assert str(arguments[name]).removesuffix(".0") == default.removesuffix(".0"), flag
            compared += 1
    assert compared > 0
