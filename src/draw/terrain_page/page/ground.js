// The ground as heights in cells, and what is read off it.

class Ground {
  // The grid has the place of the north-west cell's centre, the size of a cell, and the numbers of columns and rows.
  constructor(grid, heights) {
    Object.assign(this, grid);
    this.heights = heights;
    this.range = [Infinity, -Infinity];
    for (const height of heights) {
      if (height < this.range[0]) this.range[0] = height;
      if (height > this.range[1]) this.range[1] = height;
    }
    this.west = this.x;
    this.north = this.y;
    this.east = this.x + (this.cols - 1) * this.cell;
    this.south = this.y - (this.rows - 1) * this.cell;
  }

  // The height at a place, linear between the four centres around; NaN where the nearest of them has none.
  heightAt(x, y) {
    return this.read(this.heights, x, y);
  }

  read(values, x, y) {
    const [u, v] = [(x - this.x) / this.cell, (this.y - y) / this.cell];
    if (!(u >= -0.5 && v >= -0.5 && u <= this.cols - 0.5 && v <= this.rows - 0.5)) return NaN;
    const value = (col, row) => values[Math.min(Math.max(row, 0), this.rows - 1) * this.cols + Math.min(Math.max(col, 0), this.cols - 1)];
    if (Number.isNaN(value(Math.round(u), Math.round(v)))) return NaN;
    const [col, row] = [Math.floor(u), Math.floor(v)];
    let [sum, weights] = [0, 0];
    for (const [c, r] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
      const weight = (c ? u - col : 1 - u + col) * (r ? v - row : 1 - v + row);
      const height = value(col + c, row + r);
      if (weight > 0 && !Number.isNaN(height)) [sum, weights] = [sum + weight * height, weights + weight];
    }
    return sum / weights;
  }

  // Degrees.
  slopeAt(x, y) {
    const across = (dx, dy) => (this.heightAt(x + dx, y + dy) - this.heightAt(x - dx, y - dy)) / (2 * this.cell);
    return (Math.atan(Math.hypot(across(this.cell, 0), across(0, this.cell))) * 180) / Math.PI;
  }

  // Where a ray from a place meets the ground first; null if it does not. Heights of the ray are as they are on the ground.
  hit(from, along) {
    let [first, last] = [0, Infinity];
    const low = [this.west, this.south, this.range[0] - 1];
    const high = [this.east, this.north, this.range[1] + 1];
    for (let k = 0; k < 3; k++) {
      if (Math.abs(along[k]) < 1e-12) {
        if (from[k] < low[k] || from[k] > high[k]) return null;
        continue;
      }
      const ends = [(low[k] - from[k]) / along[k], (high[k] - from[k]) / along[k]];
      first = Math.max(first, Math.min(...ends));
      last = Math.min(last, Math.max(...ends));
    }
    if (!(first < last)) return null;
    const at = (t) => [0, 1, 2].map((k) => from[k] + t * along[k]);
    const above = (t) => {
      const [x, y, z] = at(t);
      return z - this.heightAt(x, y);
    };
    const length = Math.hypot(along[0], along[1]) * (last - first);
    const count = Math.min(Math.max(Math.ceil((2 * length) / this.cell), 2), 6000);
    let before = above(first);
    for (let k = 1; k <= count; k++) {
      const t = first + ((last - first) * k) / count;
      const now = above(t);
      if (before >= 0 && now < 0) {
        let [near, far] = [t - (last - first) / count, t];
        for (let step = 0; step < 40; step++) {
          const middle = (near + far) / 2;
          if (above(middle) >= 0) near = middle;
          else far = middle;
        }
        return at((near + far) / 2);
      }
      before = now;
    }
    return null;
  }

  // Area and volume of what lies between a level and the ground: above it (side 1), or below it (side -1).
  beyond(level, side) {
    let [cells, sum] = [0, 0];
    for (const height of this.heights) {
      const off = (height - level) * side;
      if (off > 0) [cells, sum] = [cells + 1, sum + off];
    }
    const area = this.cell * this.cell;
    return { area: cells * area, volume: sum * area };
  }

  // Heights along a line, at steps of half a cell or more: { distance, x, y, height }.
  profile([x0, y0], [x1, y1]) {
    const length = Math.hypot(x1 - x0, y1 - y0);
    const count = Math.min(Math.max(Math.ceil((2 * length) / this.cell), 1), 4000);
    return Array.from({ length: count + 1 }, (_, k) => {
      const share = k / count;
      const [x, y] = [x0 + share * (x1 - x0), y0 + share * (y1 - y0)];
      return { distance: share * length, x, y, height: this.heightAt(x, y) };
    });
  }

  // Heights without gaps, for the light at the border: cells beside the ground have the mean of their neighbours.
  filled() {
    let heights = this.heights;
    for (let pass = 0; pass < 2; pass++) {
      const wider = heights.slice();
      for (let k = 0; k < heights.length; k++) {
        if (!Number.isNaN(heights[k])) continue;
        let [sum, count] = [0, 0];
        for (const n of [k % this.cols ? k - 1 : -1, (k + 1) % this.cols ? k + 1 : -1, k - this.cols, k + this.cols]) {
          if (heights[n] === heights[n] && heights[n] !== undefined) [sum, count] = [sum + heights[n], count + 1];
        }
        if (count) wider[k] = sum / count;
      }
      heights = wider;
    }
    return heights.map((height) => (Number.isNaN(height) ? -99999 : height));
  }
}
