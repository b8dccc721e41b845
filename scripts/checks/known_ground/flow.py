"""Where water runs on a ground: its valleys, and the ridges as valleys of the ground upside down."""
import heapq

import numpy as np
import shapely

import terrain
from streams import STEPS, reaches

SHARE = 0.02  # of all cells that drain through a valley


def filled(heights, fall):
    """Heights without pits: from every cell a way leads to the edge that falls by at least `fall` from cell to cell."""
    rows, cols = heights.shape
    out = np.full(heights.shape, np.inf)
    edge = np.ones(heights.shape, bool)
    edge[1:-1, 1:-1] = False
    queue = [(heights[cell], cell) for cell in zip(*(a.tolist() for a in np.nonzero(edge)))]
    for height, cell in queue:
        out[cell] = height
    heapq.heapify(queue)
    done = np.zeros(heights.shape, bool)
    while queue:
        height, (row, col) = heapq.heappop(queue)
        if done[row, col]:
            continue
        done[row, col] = True
        for step_row, step_col in STEPS.values():
            cell = row + step_row, col + step_col
            if 0 <= cell[0] < rows and 0 <= cell[1] < cols and not done[cell]:
                to = max(heights[cell], height + fall)
                if to < out[cell]:
                    out[cell] = to
                    heapq.heappush(queue, (to, cell))
    return out


def directions(heights):
    """The step of steepest descent from each cell; 0 where no neighbour is lower."""
    rows, cols = heights.shape
    wide = np.pad(heights, 1, constant_values=np.inf)
    falls = np.stack([
        (heights - wide[1 + i : 1 + i + rows, 1 + j : 1 + j + cols]) / np.hypot(i, j) for i, j in STEPS.values()
    ])  # fmt: skip
    return np.where(falls.max(0) > 0, np.array(list(STEPS))[falls.argmax(0)], 0)


def accumulation(heights, direction):
    """How many cells drain through each cell, with itself."""
    rows, cols = heights.shape
    drained = np.ones(rows * cols, int)
    steps = {code: i * cols + j for code, (i, j) in STEPS.items()}
    codes = direction.ravel().tolist()
    for cell in np.argsort(-heights, axis=None, kind="stable").tolist():
        if codes[cell]:
            drained[cell + steps[codes[cell]]] += drained[cell]
    return drained.reshape(rows, cols)


def valleys(heights):
    """The lines of valleys of ground without pits, as lists of cells from a source or confluence to the next one."""
    direction = directions(heights)
    return [np.array(line) for line in reaches(direction, accumulation(heights, direction), SHARE * heights.size) if len(line) > 3]


def pieces(line, use):
    """The parts of a line of cells that run over more than three of the `use` cells in a row."""
    good = use[tuple(line.T)]
    parts = np.split(line, np.flatnonzero(np.diff(good)) + 1)
    return [part for part in parts if len(part) > 3 and use[tuple(part[0])]]


def on_map(cells, transform, heights=None):
    x, y = terrain.to_map(transform, cells[:, 0], cells[:, 1])
    places = [x, y] if heights is None else [x, y, heights[tuple(cells.T)]]
    return shapely.linestrings(np.column_stack(places))


def with_contours(line, lines, levels):
    """A line with heights that also has a vertex at each contour that it crosses, at the contour's level. Between cells, heights
    of a straight line are not quite those of the contours."""
    tree = shapely.STRtree(lines)
    points = shapely.get_coordinates(line, include_z=True)
    out = [points[:1]]
    for a, b in zip(points[:-1], points[1:]):
        piece = shapely.linestrings([a[:2], b[:2]])
        near = tree.query(piece, predicate="intersects")
        at, owners = shapely.get_coordinates(shapely.intersection(lines[near], piece), return_index=True)
        order = np.argsort(np.hypot(*(at - a[:2]).T))
        out += [np.column_stack([at, levels[near[owners]]])[order], [b]]
    return shapely.linestrings(np.concatenate(out))
