"""Random calls: whatever is given, there is a result or an exception of the package, never a crash."""

import os
import warnings

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import tokosen

CALLS = int(os.environ.get("TOKOSEN_RANDOM_CALLS", "300"))
"""How many random calls are made. CI makes few; 10,000 take some minutes."""

numbers = st.floats(width=64) | st.floats(-500, 500) | st.integers(-5, 60).map(float)
shapes = hnp.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=12)
kinds = st.sampled_from([np.float64, np.float32, np.int64, np.int8, np.bool_, np.complex64, "U3", object])
any_arrays = kinds.flatmap(lambda kind: hnp.arrays(kind, shapes) if kind is not object else hnp.arrays(object, shapes, elements=st.none()))


@st.composite
def lines(draw):
    """Ragged arrays that fit each other, with any numbers."""
    lengths = draw(st.lists(st.integers(0, 8), max_size=8))
    coords = draw(hnp.arrays(np.float64, (sum(lengths), 2), elements=numbers))
    elevations = draw(hnp.arrays(np.float64, len(lengths), elements=numbers))
    return coords, np.cumsum([0, *lengths]), elevations


@st.composite
def rings(draw):
    """Ragged arrays of nested rings: contours of a hill, some of them faulty."""
    count = draw(st.integers(1, 4))
    radii = draw(st.lists(st.floats(1, 300), min_size=count, max_size=count))
    angles = np.linspace(0, 2 * np.pi, draw(st.integers(4, 12)))
    coords = np.concatenate([radius * np.column_stack([np.cos(angles), np.sin(angles)]) for radius in radii])
    elevations = [draw(st.sampled_from([0.0, 10.0, 20.0, 30.0, -5.0])) for _ in radii]
    return coords, len(angles) * np.arange(count + 1), elevations


junk = st.none() | st.booleans() | st.integers() | st.text(max_size=5) | any_arrays | st.lists(numbers, max_size=3)
contours = lines() | rings() | rings() | st.tuples(any_arrays, any_arrays, any_arrays) | junk
options = st.fixed_dictionaries(
    {},
    optional={
        "crs": st.sampled_from([None, 6677, "EPSG:4326", "EPSG:2229", "x", 1.5]),
        "unit": st.sampled_from([None, "m", "ft", "us-ft", "x"]),
        "depths": st.booleans(),
        "points": rings().map(lambda r: np.column_stack([r[0], np.full(len(r[0]), 5.0)])) | junk,
        "points_sigma": numbers,
        "sea": numbers,
        "coast": numbers,
        "snap": numbers,
        "fit": numbers,
        "sample": numbers,
        "repair": st.sampled_from([None, "none", "safe", "all", "x"]),
        "strict": st.booleans(),
        "drain": st.sampled_from(["none", "safe", "all"]),
        "frame": st.sampled_from(["auto", "hull", "bbox", "x"]),
        "extend": st.booleans(),
        "surface": st.sampled_from(["linear", "skeleton", "spline"]),
        "tension": numbers,
        "noise": numbers,
        "resolution": numbers,
        "extent": st.tuples(numbers, numbers, numbers, numbers),
        "water": junk,
        "streams": junk,
    },
)
EXPECTED = (tokosen.Error, TypeError, ValueError, OverflowError)


@settings(max_examples=CALLS, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(contours, options, st.sampled_from(["dem", "densify", "check", "regions", "skeleton"]), st.floats(2, 100) | numbers)
def test_random_contours_and_options(given_contours, given_options, verb, size):
    assume(not isinstance(given_contours, str))
    call = {
        "dem": lambda: tokosen.dem(given_contours, size, **given_options),
        "densify": lambda: tokosen.densify(given_contours, size, **given_options),
        "check": lambda: tokosen.check(given_contours, **given_options),
        "regions": lambda: tokosen.regions(given_contours, **given_options),
        "skeleton": lambda: tokosen.skeleton(given_contours, **given_options),
    }[verb]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            assert call() is not None
        except EXPECTED as error:
            assert str(error), error


rasters = hnp.arrays(np.float32, hnp.array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=12), elements=st.floats(width=32))
verbs = st.sampled_from(["slope", "aspect", "hillshade", "flow_direction", "flow_accumulation", "steep", "catchments", "contour"])


@settings(max_examples=CALLS, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(rasters | any_arrays, st.floats(0.5, 20) | numbers, st.sampled_from([None, 6677, 4326]), verbs, numbers)
def test_random_height_maps(values, cell, crs, verb, number):
    dem = (values, (cell, 0, 0, 0, -cell, 100), crs)
    try:
        if verb == "contour":
            assert tokosen.contour(dem, number) is not None
        else:
            assert tokosen.derive(dem, verb, z_factor=number, steep_angle=number) is not None
    except EXPECTED as error:
        assert str(error), error


def test_some_random_calls_succeed():
    """The strategies above are not only junk."""
    succeeded = 0

    @settings(max_examples=50, deadline=None, database=None, suppress_health_check=list(HealthCheck))
    @given(rings())
    def run(given_contours):
        nonlocal succeeded
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                tokosen.dem(given_contours, 20)
                succeeded += 1
            except tokosen.Error:
                pass

    run()
    assert succeeded >= 5


