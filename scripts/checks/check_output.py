#!/usr/bin/env python3
"""Checks an output of tokosen against its input, independently of tokosen's own code.

    check_output.py INPUT OUTPUT [--dem DEM.tif] [--frame POLYGON [--clip]] [--sampled]

INPUT holds contour lines with an attribute for the elevation (--elev; a usual name is found by itself) or 3-D lines.
OUTPUT is a GeoPackage (all its layers), GeoJSON or Shapefile of tokosen. Prints one row per check, with the first few
places where it failed; exit status 0 all passed, 1 a check failed, 2 a file could not be used.

Checks of each layer that has the attributes elev and source:
  attributes   elev finite, source "input" or "interpolated", one value of is_index per level, two points or more per line
  input kept   the vertices of each input line are a contiguous run of an output line of its elevation with source
               "input", in either direction, rings from any start, every number the same; these output lines have no
               further segment
  crossings    no two lines of different elevation share a point
  simple       no line touches or crosses itself
  same level   interpolated lines of one level do not cross (their ends may touch)
  z            the z of every vertex is the line's elev
  ends         interpolated lines end on the frame (--frame, otherwise the convex hull of the input's vertices) or
               at a vertex of an open input line of the same elevation, which they continue
  closed       the attribute closed says whether the line repeats its first point
  turning      closed lines run clockwise, and counterclockwise where the attribute depression is set, which is
               set on closed lines only
  right side   the neighbours of another level on the right of a line are higher, those on the left lower
Checks of a DEM:
  dem range    no cell further than one interval outside the levels of the input
  dem side     the DEM is higher on the right of the lines than on the left (in 98 of 100 lines)

With --clip the output was cut to the polygon. Only segments of input lines inside it are required. Lines of source input
must lie inside it, and may end on its border with a part of an input segment. If the polygon reaches beyond the bounding
box of the map by more than half the mean distance between contours, only its part inside the map's convex hull counts.

With --sampled vertices may have been added on the input's segments: they must lie within --tolerance of the straight line
between the input's vertices on both sides, and without them the input must be kept as in the check above.

Repeated points of the input count once; so does a line that returns along itself. An input line that was repaired on
purpose is no error of the output: --cut and --joints give the number of lines and segments that may differ.
"""
import argparse
import sys

import numpy as np
import pyogrio
import shapely

CHUNK = 16  # segments in one piece of a line in the spatial index
SHOWN = 5  # places named in a row
ELEVATION_NAMES = ("elev", "elevation", "height", "ele", "z", "contour", "level", "hoyde")


class Unusable(Exception):
    """A file that cannot be checked."""


class Lines:
    """Lines as flat arrays: vertices of all lines in `xy`, line i from start[i] to start[i + 1]."""

    def __init__(self, geometry, elev, fields):
        parts, owner = shapely.get_parts(geometry, return_index=True)
        count = shapely.get_num_coordinates(parts)
        coordinates = shapely.get_coordinates(parts, include_z=True)
        self.xy = np.ascontiguousarray(coordinates[:, :2])
        self.z = coordinates[:, 2]
        self.has_z = shapely.has_z(parts)
        self.start = np.r_[0, np.cumsum(count)]
        self.elev = elev[owner]
        self.feature = owner
        self.fields = {k: v[owner] for k, v in fields.items()}

    def __len__(self):
        return len(self.elev)

    def points(self, i):
        return self.xy[self.start[i] : self.start[i + 1]]

    def sizes(self):
        return np.diff(self.start)

    def closed(self):
        first, last = self.start[:-1], self.start[1:] - 1
        return (self.sizes() >= 4) & (self.xy[first] == self.xy[last]).all(axis=1)

    def line_of_vertex(self):
        return np.repeat(np.arange(len(self)), self.sizes())

    def geometry(self, which=slice(None)):
        keep = np.zeros(len(self), bool)
        keep[which] = True
        at = np.repeat(keep, self.sizes())
        return shapely.linestrings(self.xy[at], indices=np.repeat(np.arange(keep.sum()), self.sizes()[keep]))

    def without(self, vertex, line):
        """The lines less some vertices, and less the lines that are left with fewer than two."""
        size = np.bincount(self.line_of_vertex()[vertex], minlength=len(self))
        keep = line & (size >= 2)
        vertex = vertex & np.repeat(keep, self.sizes())
        out = object.__new__(Lines)
        out.xy, out.z = self.xy[vertex], self.z[vertex]
        out.start = np.r_[0, np.cumsum(size[keep])]
        out.elev, out.has_z, out.feature = self.elev[keep], self.has_z[keep], self.feature[keep]
        out.fields = {k: v[keep] for k, v in self.fields.items()}
        return out


def read(path, layer=None):
    try:
        meta, _, wkb, columns = pyogrio.raw.read(path, layer=layer)
    except Exception as e:
        raise Unusable(f"{path}: {e}") from e
    geometry = shapely.from_wkb(wkb) if wkb is not None else np.array([], object)
    return geometry, dict(zip(meta["fields"], columns))


def line_features(geometry):
    return np.isin(shapely.get_type_id(geometry), (1, 5)) & ~shapely.is_empty(geometry)


def read_input(path, elev_name):
    layers = [n for n, kind in pyogrio.list_layers(path) if kind and ("Line" in kind or kind == "Unknown")]
    if not layers:
        raise Unusable(f"{path}: no layer of lines")
    geometry, fields = read(path, layers[0])
    use = line_features(geometry)
    names = {k.lower(): k for k in fields}
    name = elev_name or next((names[n] for n in ELEVATION_NAMES if n in names), None)
    if name is not None and name not in fields:
        raise Unusable(f"{path}: no attribute {name}; there are: {', '.join(fields)}")
    if name is not None:
        elev = np.asarray(fields[name][use], float)
    else:
        parts = shapely.get_point(shapely.get_geometry(geometry[use], 0), 0)
        elev = shapely.get_z(parts)
    lines = Lines(geometry[use], elev, {})
    repeat = np.r_[False, (lines.xy[1:] == lines.xy[:-1]).all(axis=1)]
    repeat[lines.start[:-1]] = False
    lines = lines.without(~repeat & np.isfinite(lines.xy).all(axis=1), np.isfinite(lines.elev))
    lines = lines.without(~way_back(lines), np.ones(len(lines), bool))
    if not len(lines):
        raise Unusable(f"{path}: no line has an elevation; name the attribute with --elev")
    return lines


def way_back(lines):
    """The vertices on the way back of lines that return along themselves."""
    back = np.zeros(len(lines.xy), bool)
    for i in np.flatnonzero(lines.sizes() % 2):
        points = lines.points(i)
        if len(points) > 1 and np.array_equal(points, points[::-1]):
            back[lines.start[i] + len(points) // 2 + 1 : lines.start[i + 1]] = True
    return back


def truth_values(column):
    """A column of yes and no, which formats keep as bool, number or text."""
    if column.dtype == object:
        return np.array([str(v).strip().lower() in ("1", "1.0", "t", "true", "y", "yes") for v in column])
    return column.astype(float) == 1


def read_output(path):
    layers = {}
    try:
        listed = pyogrio.list_layers(path)
    except Exception as e:
        raise Unusable(f"{path}: {e}") from e
    for name, _ in listed:
        geometry, fields = read(path, name)
        if "elev" not in fields or "source" not in fields:
            print(f"layer {name}: no contours (no attributes elev and source), left out")
            continue
        use = line_features(geometry)
        fields = {k: v[use] for k, v in fields.items()}
        layers[name] = (Lines(geometry[use], np.asarray(fields.pop("elev"), float), fields), int((~use).sum()))
    if not layers:
        raise Unusable(f"{path}: no layer with the attributes elev and source")
    return layers


class Rows:
    """Prints the result of each check and remembers whether one failed."""

    def __init__(self):
        self.failed = 0

    def row(self, layer, check, problems, passed, note=""):
        """`problems` are sentences; `passed` says in a few words what was looked at."""
        problems = list(problems)
        self.failed += bool(problems)
        text = f"{len(problems)} wrong: " + "; ".join(problems[:SHOWN]) + ("; ..." if len(problems) > SHOWN else "")
        print(f"{'FAIL' if problems else 'ok  '}  {layer:<16} {check:<11} {text if problems else passed}{note}")

    def skipped(self, layer, check, why):
        print(f"-     {layer:<16} {check:<11} {why}")


def place(p):
    return f"{p[0]:.3f} {p[1]:.3f}"


def attributes(lines, not_lines):
    out = [f"{not_lines} features are no lines"] if not_lines else []
    out += [f"line {i} has the elevation {lines.elev[i]}" for i in np.flatnonzero(~np.isfinite(lines.elev))]
    known = np.isin(lines.fields["source"], ("input", "interpolated"))
    out += [f"line {i} has the source {lines.fields['source'][i]!r}" for i in np.flatnonzero(~known)]
    out += [f"line {i} has a coordinate that is not finite"
            for i in np.unique(lines.line_of_vertex()[~np.isfinite(lines.xy).all(axis=1)])]
    for name in ("is_index", "depression", "closed"):
        if name not in lines.fields:
            out.append(f"no attribute {name}")
    if "is_index" in lines.fields:
        flag = truth_values(lines.fields["is_index"])
        both = np.intersect1d(lines.elev[flag], lines.elev[~flag])
        out += [f"level {e:g} has lines with and without is_index" for e in both]
    repeated = np.r_[False, (lines.xy[1:] == lines.xy[:-1]).all(axis=1)]
    repeated[lines.start[:-1]] = False
    out += [f"line {lines.line_of_vertex()[v]} repeats a point at {place(lines.xy[v])}" for v in np.flatnonzero(repeated)]
    return out


def numbered(*groups):
    """Numbers the vertices of several Lines so that equal numbers mean equal x, y and elevation."""
    xy = np.concatenate([g.xy for g in groups])
    elev = np.concatenate([np.repeat(g.elev, g.sizes()) for g in groups])
    order = np.lexsort((xy[:, 1], xy[:, 0], elev))
    new = np.r_[True, (np.diff(xy[order], axis=0) != 0).any(axis=1) | (np.diff(elev[order]) != 0)]
    ids = np.empty(len(xy), np.int64)
    ids[order] = np.cumsum(new) - 1
    return np.split(ids, np.cumsum([len(g.xy) for g in groups])[:-1])


def segments(lines):
    """Global index of the first vertex of every segment."""
    first = np.ones(len(lines.xy), bool)
    first[lines.start[1:] - 1] = False
    return np.flatnonzero(first)


def inside(lines, frame):
    """The runs of segments of lines that lie inside the frame."""
    s = segments(lines)
    pieces = shapely.linestrings(np.stack([lines.xy[s], lines.xy[s + 1]], axis=1))
    shapely.prepare(frame)
    s = s[shapely.covers(frame, pieces)]
    runs = np.split(s, np.flatnonzero((np.diff(s) != 1) | np.isin(s[1:], lines.start)) + 1) if len(s) else []
    out = Lines(np.array([shapely.linestrings(lines.xy[run[0] : run[-1] + 2]) for run in runs], object), np.zeros(len(runs)), {})
    owner = lines.line_of_vertex()[[run[0] for run in runs]] if runs else np.array([], int)
    out.elev, out.feature = lines.elev[owner], lines.feature[owner]
    return out


def not_cut(inp, out, first, frame, tolerance):
    """Of the output segments that start at the vertices `first`, those that are no part of an input segment of their
    level up to the border of the frame."""
    s = segments(inp)
    tree = shapely.STRtree(shapely.linestrings(np.stack([inp.xy[s], inp.xy[s + 1]], axis=1)))
    level = inp.elev[inp.line_of_vertex()[s]]
    own = out.elev[out.line_of_vertex()[first]]
    on_border = np.zeros(len(first), bool)
    on_line = np.ones(len(first), bool)
    for end in (0, 1):
        p = shapely.points(out.xy[first + end])
        on_border |= shapely.distance(p, shapely.boundary(frame)) <= tolerance
        n, m = tree.query(p, predicate="dwithin", distance=tolerance)
        on_line &= np.isin(np.arange(len(first)), n[level[m] == own[n]])
    return first[~(on_border & on_line)]


def kept(inp, out, allowed_cut, allowed_joints, clip=None):
    """Compares input lines and the output lines of source input: (problems, text). `clip`: a frame that the lines were
    cut to, and the distance that counts as on it."""
    whole_input = inp
    if clip:
        inp = inside(inp, clip[0])
    a, b = numbered(inp, out)
    sa, sb = segments(inp), segments(out)
    factor = np.int64(max(a.max(initial=0), b.max(initial=0)) + 1)
    key = lambda v, s: np.minimum(v[s], v[s + 1]) * factor + np.maximum(v[s], v[s + 1])
    ka, kb = key(a, sa), key(b, sb)
    order = np.argsort(kb, kind="stable")
    sorted_keys = kb[order]
    at = np.searchsorted(sorted_keys, ka)
    found = np.zeros(len(ka), bool)
    if len(kb):
        found = sorted_keys[np.minimum(at, len(kb) - 1)] == ka
    owner_a, owner_b = inp.line_of_vertex(), out.line_of_vertex()
    lost_vertices = int((~np.isin(np.unique(a), b)).sum())
    lost = np.bincount(owner_a[sa], weights=~found, minlength=len(inp)).astype(int)

    def run_of(i):
        """Whether line i, all of whose segments are there, is a run of one output line."""
        ids = a[inp.start[i] : inp.start[i + 1]]
        first = sa.searchsorted(inp.start[i])
        lo, hi = at[first], np.searchsorted(sorted_keys, ka[first], side="right")
        ring = ids[0] == ids[-1]
        for j in np.unique(owner_b[sb[order[lo:hi]]]):
            line = b[out.start[j] : out.start[j + 1]]
            round_trip = np.r_[line, line[1:]] if line[0] == line[-1] else line
            for want in (ids, ids[::-1]):
                if ring and line[0] == line[-1] and len(line) != len(ids):
                    continue
                for s in np.flatnonzero(round_trip == want[0]):
                    if np.array_equal(round_trip[s : s + len(want)], want):
                        return True
        return False

    whole = lost == 0
    in_pieces = [i for i in np.flatnonzero(whole) if not run_of(i)]
    cut = np.flatnonzero(lost)
    foreign = sb[~np.isin(kb, ka)]
    problems = []
    if clip:
        foreign = not_cut(whole_input, out, foreign, *clip)
        shapely.prepare(reach := shapely.buffer(clip[0], clip[1]))
        beyond = np.flatnonzero(~shapely.covers(reach, shapely.points(out.xy)))
        problems += [f"line of source input (level {out.elev[owner_b[v]]:g}) leaves the frame at {place(out.xy[v])}" for v in beyond]
    if len(cut) + len(in_pieces) > allowed_cut:
        for i in cut:
            missing = sa[(owner_a[sa] == i) & ~found][0] if len(problems) < SHOWN else None
            where = "" if missing is None else f", first at {place(inp.xy[missing])}"
            problems.append(f"input feature {inp.feature[i]} (level {inp.elev[i]:g}) lacks {lost[i]} segments{where}")
        problems += [f"input feature {inp.feature[i]} (level {inp.elev[i]:g}) is there in pieces" for i in in_pieces]
    if len(foreign) > allowed_joints:
        problems += [f"line of source input has a segment that the input has not at {place(out.xy[v])}" for v in foreign]
    text = (f" [{len(inp) - len(cut) - len(in_pieces)} of {len(inp)} input lines whole, {len(cut)} cut, {len(in_pieces)} in "
            f"pieces; of {len(ka)} segments {int(lost.sum())} missing, {lost_vertices} vertices missing, "
            f"{len(foreign)} segments new]")
    return problems, text


def without_added(inp, out, tolerance):
    """The output's lines less the vertices that were added on segments: (lines, problems)."""
    a, b = numbered(inp, out)
    own = np.isin(b, a)
    owner = out.line_of_vertex()
    at = np.arange(len(b))
    before = np.maximum.accumulate(np.where(own, at, -1))
    after = np.minimum.accumulate(np.where(own, at, len(b))[::-1])[::-1]
    added = np.flatnonzero(~own)
    # A closed line may start at any vertex of the input, an open one at its end: none starts or ends with an added one.
    stray = (before[added] < 0) | (after[added] >= len(b))
    p, q = np.maximum(before[added], 0), np.minimum(after[added], len(b) - 1)
    stray |= (owner[p] != owner[added]) | (owner[q] != owner[added])
    way = shapely.linestrings(np.stack([out.xy[p], out.xy[q]], axis=1))
    off = shapely.distance(shapely.points(out.xy[added]), way) > tolerance
    problems = [f"line {owner[i]}, level {out.elev[owner[i]]:g}, has a vertex beside the input at {place(out.xy[i])}"
                for i in added[stray | off]]
    return out.without(own, np.ones(len(out), bool)), problems


def chunks_of(lines):
    """The lines cut into pieces of CHUNK segments: (pieces, line of each, first vertex of each)."""
    count = np.maximum(-(-(lines.sizes() - 1) // CHUNK), 1)
    line = np.repeat(np.arange(len(lines)), count)
    nth = np.arange(count.sum()) - np.repeat(np.r_[0, np.cumsum(count)[:-1]], count)
    first = lines.start[line] + nth * CHUNK
    last = np.minimum(first + CHUNK, lines.start[line + 1] - 1)
    size = last - first + 1
    vertex = np.arange(size.sum()) + np.repeat(first - np.r_[0, np.cumsum(size)[:-1]], size)
    return shapely.linestrings(lines.xy[vertex], indices=np.repeat(np.arange(len(size)), size)), line, first


def crossing(lines, tree, chunks, line):
    """Problems between lines of different elevation, and between interpolated ones of the same."""
    i, j = tree.query(chunks, predicate="intersects")
    i, j = i[i < j], j[i < j]
    other = lines.elev[line[i]] != lines.elev[line[j]]
    seen = {}
    for p, q in zip(i[other], j[other]):
        seen.setdefault((line[p], line[q]), (p, q))
    different = []
    for (p, q), (cp, cq) in seen.items():
        where = ""
        if len(different) < SHOWN:
            where = " at " + place(shapely.get_coordinates(shapely.intersection(chunks[cp], chunks[cq]))[0])
        different.append(f"lines {p} (level {lines.elev[p]:g}) and {q} (level {lines.elev[q]:g}) meet{where}")
    new = lines.fields["source"] == "interpolated"
    alike = ~other & (line[i] != line[j]) & new[line[i]] & new[line[j]]
    same = []
    for p, q in zip(i[alike], j[alike]):
        s, t = (shapely.linestrings(np.stack([c[:-1], c[1:]], axis=1))
                for c in (shapely.get_coordinates(chunks[p]), shapely.get_coordinates(chunks[q])))
        bad = shapely.crosses(s[:, None], t[None, :]) | shapely.overlaps(s[:, None], t[None, :])
        bad |= shapely.equals(s[:, None], t[None, :])
        if bad.any():
            at = shapely.get_coordinates(s[np.argwhere(bad)[0][0]])[0]
            same.append(f"lines {line[p]} and {line[q]} (level {lines.elev[line[p]]:g}) near {place(at)}")
    return different, same


def heights(lines):
    bad = lines.z != np.repeat(lines.elev, lines.sizes())
    return [f"line {lines.line_of_vertex()[v]} (level {lines.elev[lines.line_of_vertex()[v]]:g}) has z {lines.z[v]!r} at "
            f"{place(lines.xy[v])}" for v in np.flatnonzero(bad)]


def ends(lines, inp, frame, tolerance):
    """Ends of interpolated open lines that are neither on the frame nor on an open input line of their level."""
    open_new = np.flatnonzero((lines.fields["source"] == "interpolated") & ~lines.closed())
    vertex = np.concatenate([lines.start[open_new], lines.start[open_new + 1] - 1])
    level = np.tile(lines.elev[open_new], 2)
    points = shapely.points(lines.xy[vertex])
    off = np.flatnonzero(shapely.distance(points, shapely.boundary(frame)) > tolerance)
    if len(off):
        stop = np.flatnonzero(np.repeat(~inp.closed(), inp.sizes()))
        stop_level = np.repeat(inp.elev, inp.sizes())[stop]
        tree = shapely.STRtree(shapely.points(inp.xy[stop]))
        n, m = tree.query(points[off], predicate="dwithin", distance=tolerance)
        joined = n[stop_level[m] == level[off[n]]]
        off = np.delete(off, np.unique(joined))
    return [f"an interpolated line of level {level[k]:g} ends at {place(lines.xy[vertex[k]])}" for k in off], len(vertex)


def turning(lines):
    """Closed lines that run the wrong way round for their attribute depression."""
    closed, depression = lines.closed(), truth_values(lines.fields["depression"])
    out = [f"line {i} is open and has depression set" for i in np.flatnonzero(depression & ~closed)]
    for i in np.flatnonzero(closed):
        p = lines.points(i) - lines.points(i)[0]
        area = float(np.sum(p[:-1, 0] * p[1:, 1] - p[1:, 0] * p[:-1, 1]))
        if area != 0 and (area > 0) != depression[i]:
            out.append(f"line {i} (level {lines.elev[i]:g}, depression {bool(depression[i])}) at {place(lines.points(i)[0])}")
    return out


def probes(lines, a_line):
    """Middles of up to `a_line` segments of each line and unit vectors to their right: (line, middle, right)."""
    n = lines.sizes() - 1
    first = np.concatenate([lines.start[:-1] + (n * (2 * k + 1)) // (2 * a_line) for k in range(a_line)])
    line = np.tile(np.arange(len(lines)), a_line)
    a, b = lines.xy[first], lines.xy[first + 1]
    length = np.hypot(*(b - a).T)
    use = length > 0
    along = (b - a)[use] / length[use, None]
    return line[use], ((a + b) / 2)[use], np.column_stack([along[:, 1], -along[:, 0]])


def right_side(lines, tree, chunks, chunk_line, area=None):
    """Lines whose neighbours of another level lie on the wrong side, by rays to both sides: (problems, lines told). Rays
    that leave `area` tell nothing."""
    if area is not None:
        shapely.prepare(area)
    line, middle, right = probes(lines, 5)
    extent = float(np.ptp(lines.xy, axis=0).max())
    votes = np.zeros(len(lines), int)
    told = np.zeros(len(lines), int)
    for sign in (1, -1):
        start = middle + sign * 1e-7 * extent * right
        waiting = np.arange(len(line))
        # Short rays first: few of them have to be followed through half the map.
        for reach in (0.01, 0.1, 0.5):
            rays = shapely.linestrings(np.stack([start[waiting], (middle + sign * reach * extent * right)[waiting]], axis=1))
            r, c = tree.query(rays, predicate="intersects")
            distance = shapely.distance(shapely.points(start)[waiting[r]], shapely.intersection(rays[r], chunks[c]))
            order = np.lexsort((distance, r))
            r, c = r[order], c[order]
            nearest = np.r_[True, r[1:] != r[:-1]][: len(r)]
            r, hit, distance = r[nearest], chunk_line[c[nearest]], distance[order][nearest]
            own = line[waiting[r]]
            rise = np.sign(lines.elev[hit] - lines.elev[own]) * sign
            if area is not None:
                a = start[waiting[r]]
                b = a + 0.999 * sign * distance[:, None] * right[waiting[r]]
                rise[~shapely.covers(area, shapely.linestrings(np.stack([a, b], axis=1)))] = 0
            np.add.at(votes, own, rise.astype(int))
            np.add.at(told, own, (rise != 0).astype(int))
            waiting = np.delete(waiting, r)
    wrong = np.flatnonzero(votes < 0)
    return [f"line {i} (level {lines.elev[i]:g}) at {place(lines.points(i)[0])}" for i in wrong], int((told > 0).sum())


def dem_side(lines, z, transform):
    """Lines on whose right the DEM is lower than on the left: (problems, lines told)."""
    line, middle, right = probes(lines, 7)

    def sample(p):
        col, row = (p[:, 0] - transform.c) / transform.a - 0.5, (p[:, 1] - transform.f) / transform.e - 0.5
        c, r = np.floor(col).astype(int), np.floor(row).astype(int)
        inside = (c >= 0) & (r >= 0) & (c < z.shape[1] - 1) & (r < z.shape[0] - 1)
        c, r, u, v = (np.where(inside, a, 0) for a in (c, r, col - c, row - r))
        h = (z[r, c] * (1 - u) + z[r, c + 1] * u) * (1 - v) + (z[r + 1, c] * (1 - u) + z[r + 1, c + 1] * u) * v
        return np.where(inside, h, np.nan)

    step = 0.5 * abs(transform.a) * right
    rise = np.nan_to_num(sample(middle + step) - sample(middle - step))
    votes, told = (np.bincount(line, weights=w, minlength=len(lines)) for w in (np.sign(rise), rise != 0))
    wrong = np.flatnonzero(votes < 0)
    return [f"line {i} (level {lines.elev[i]:g}) at {place(lines.points(i)[0])}" for i in wrong], int((told > 0).sum())


def check_layer(rows, name, lines, not_lines, inp, frame, args):
    rows.row(name, "attributes", attributes(lines, not_lines), f"{len(lines)} lines, {len(lines.xy)} vertices")
    sound = lines.sizes() >= 2
    lines = lines.without(np.isfinite(lines.xy).all(axis=1), sound & np.isfinite(lines.elev))
    if not len(lines):
        rows.row(name, "lines", ["no line"], "")
        return None
    source_input = lines.without(np.ones(len(lines.xy), bool), lines.fields["source"] == "input")
    clip = (frame, args.tolerance) if args.clip else None
    end_lines, astray = inp, []
    if args.sampled:
        # New lines may end at an added vertex too.
        end_lines = source_input
        source_input, astray = without_added(inp, source_input, args.tolerance)
    problems, note = kept(inp, source_input, args.cut, args.joints, clip)
    problems = astray + problems
    rows.row(name, "input kept", problems, "all there" if not args.cut + args.joints else "within what is allowed", note)
    chunks, chunk_line, _ = chunks_of(lines)
    tree = shapely.STRtree(chunks)
    different, same = crossing(lines, tree, chunks, chunk_line)
    rows.row(name, "crossings", different, f"none among {len(lines.xy) - len(lines)} segments")
    simple = shapely.is_simple(lines.geometry())
    rows.row(name, "simple", [f"line {i} ({lines.fields['source'][i]}, level {lines.elev[i]:g}) at {place(lines.points(i)[0])}"
                              for i in np.flatnonzero(~simple)], "all lines")
    rows.row(name, "same level", same, "no interpolated lines cross")
    if lines.has_z.any():
        rows.row(name, "z", heights(lines), "equal to elev everywhere")
    else:
        rows.skipped(name, "z", "two-dimensional lines")
    problems, count = ends(lines, end_lines, frame, args.tolerance)
    rows.row(name, "ends", problems, f"{count} ends of interpolated lines in place")
    if "closed" in lines.fields:
        wrong = np.flatnonzero(truth_values(lines.fields["closed"]) != lines.closed())
        rows.row(name, "closed", [f"line {i} at {place(lines.points(i)[0])}" for i in wrong], f"{int(lines.closed().sum())} closed lines")
    if "depression" in lines.fields:
        rows.row(name, "turning", turning(lines), f"{int(truth_values(lines.fields['depression']).sum())} depression contours")
    problems, told = right_side(lines, tree, chunks, chunk_line, frame if args.clip else None)
    rows.row(name, "right side", problems, f"higher for {told} lines; {len(lines) - told} cannot be told")
    return lines


def check_dem(rows, path, inp, layers):
    import rasterio

    try:
        with rasterio.open(path) as f:
            z, transform = f.read(1, masked=True).astype(float).filled(np.nan), f.transform
    except Exception as e:
        raise Unusable(f"{path}: {e}") from e
    levels = np.unique(inp.elev)
    interval = float(np.median(np.diff(levels))) if len(levels) > 1 else 0.0
    low, high = levels[0] - interval, levels[-1] + interval
    bad = np.isinf(z) | (z < low) | (z > high)
    empty = float(np.isnan(z).mean())
    problems = [] if not bad.any() else [f"{100 * bad.mean():.4f} % of the cells ({int(bad.sum())}) outside {low:g} to {high:g}, first "
                                         f"{z[bad][0]:g} in row {np.argwhere(bad)[0][0]}, column {np.argwhere(bad)[0][1]}"]
    if empty == 1:
        problems.append("no cell has a height")
    rows.row("dem", "dem range", problems, f"{np.nanmin(z) if empty < 1 else 0:g} to {np.nanmax(z) if empty < 1 else 0:g}, allowed "
             f"{low:g} to {high:g}; {100 * empty:.1f} % nodata")
    for name, lines in layers.items():
        problems, told = dem_side(lines, z, transform)
        few = len(problems) <= 0.02 * told
        rows.row(name, "dem side", [] if few else problems, f"{told - len(problems)} of {told} lines right")


def read_frame(path):
    geometry, _ = read(path)
    areas = geometry[np.isin(shapely.get_type_id(geometry), (3, 6))]
    if not len(areas):
        raise Unusable(f"{path}: no polygon")
    return shapely.union_all(areas)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("input")
    parser.add_argument("output")
    parser.add_argument("--dem", help="a DEM that was made from the same input")
    parser.add_argument("--frame", help="file with the polygon that the output was made in (default: convex hull of the input)")
    parser.add_argument("--clip", action="store_true", help="the output was cut to the polygon of --frame")
    parser.add_argument("--sampled", action="store_true", help="vertices were added on the input's segments")
    parser.add_argument("--elev", help="attribute of the input that holds the elevation")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="distance of an end from the frame, map units (%(default)s)")
    parser.add_argument("--cut", type=int, default=0, metavar="N", help="input lines that may be cut or in pieces (%(default)s)")
    parser.add_argument("--joints", type=int, default=0, metavar="N", help="segments that may join input lines (%(default)s)")
    args = parser.parse_args()
    rows = Rows()
    try:
        inp = read_input(args.input, args.elev)
        layers = read_output(args.output)
        hull = shapely.convex_hull(shapely.multipoints(inp.xy))
        frame = read_frame(args.frame) if args.frame else hull
        if args.clip:
            beyond = (np.array(frame.bounds) - hull.bounds) * [-1, -1, 1, 1]
            if (beyond > 0.5 * shapely.area(hull) / shapely.length(inp.geometry()).sum()).any():
                frame = shapely.intersection(frame, hull)
        checked = {name: check_layer(rows, name, lines, rest, inp, frame, args) for name, (lines, rest) in layers.items()}
        if args.dem:
            check_dem(rows, args.dem, inp, {k: v for k, v in checked.items() if v is not None})
    except Unusable as e:
        print(f"error: {e}", file=sys.stderr)
        return 2
    print(f"{rows.failed} checks failed" if rows.failed else "all checks passed")
    return 1 if rows.failed else 0


if __name__ == "__main__":
    sys.exit(main())
