"""Shared by the scripts about streams: streams as lines of cells, from directions of flow."""
import numpy as np

# The codes of `tokosen derive` for directions of flow, and the steps in rows and columns.
STEPS = {1: (0, 1), 2: (1, 1), 4: (1, 0), 8: (1, -1), 16: (0, -1), 32: (-1, -1), 64: (-1, 0), 128: (-1, 1)}


def reaches(direction, accumulation, least):
    """Streams as lists of (row, column), from a source or confluence to the next one."""
    is_stream = accumulation >= least
    rows, columns = np.nonzero(is_stream)
    below, into = {}, {}
    for cell in zip(rows.tolist(), columns.tolist()):
        step = STEPS.get(int(direction[cell]) if np.isfinite(direction[cell]) else 0)
        if step:
            to = (cell[0] + step[0], cell[1] + step[1])
            if is_stream[to]:
                below[cell] = to
                into[to] = into.get(to, 0) + 1
    found = []
    for start in below:
        if into.get(start, 0) == 1:
            continue
        line = [start]
        while line[-1] in below:
            line.append(below[line[-1]])
            if into.get(line[-1], 0) != 1:
                break
        found.append(line)
    return found


def along(line, per_cell=2):
    """Places along a line in rows and columns, `per_cell` for each cell."""
    line = np.asarray(line, float)
    steps = np.hypot(*np.diff(line, axis=0).T)
    at = np.r_[0, np.cumsum(steps)]
    places = np.linspace(0, at[-1], max(2, int(per_cell * at[-1])))
    return np.column_stack([np.interp(places, at, line[:, 0]), np.interp(places, at, line[:, 1])])
