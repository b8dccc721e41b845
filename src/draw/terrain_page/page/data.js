// The data of the page: numbers that were packed as differences, in variable-length integers, deflated.

class Numbers {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  get isAtEnd() {
    return this.at >= this.bytes.length;
  }

  // The next whole number that is not negative: seven bits a byte, the lowest first.
  next() {
    let value = 0;
    let scale = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      if (byte === undefined) throw new Error(WORDS.damaged);
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }

  // The next whole number with a sign.
  signed() {
    return signed(this.next());
  }
}

function signed(value) {
  return value % 2 ? -(value + 1) / 2 : value / 2;
}

async function unpack(text) {
  if (typeof DecompressionStream === "undefined") throw new Error(WORDS.tooOld);
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  try {
    return new Numbers(new Uint8Array(await new Response(stream).arrayBuffer()));
  } catch {
    throw new Error(WORDS.damaged);
  }
}

// A value for each cell; NaN where there is none. A cell is told as the difference from what its neighbours let expect.
function cellsOf(numbers, { cols, rows }, step) {
  const cells = new Int32Array(cols * rows);
  const values = new Float32Array(cols * rows).fill(NaN);
  const isKnown = (k) => !Number.isNaN(values[k]);
  for (let k = 0; k < values.length; k++) {
    const code = numbers.next();
    if (code === 0) continue;
    const left = k % cols > 0 && isKnown(k - 1);
    const up = k >= cols && isKnown(k - cols);
    const corner = left && up && isKnown(k - cols - 1);
    const expected = corner ? cells[k - 1] + cells[k - cols] - cells[k - cols - 1] : left ? cells[k - 1] : up ? cells[k - cols] : 0;
    cells[k] = expected + signed(code - 1);
    values[k] = cells[k] * step;
  }
  return values;
}

// Lines: an array of { isIndex, points: [x, y, z, x, y, z, …] }.
function linesOf(numbers, step) {
  const lines = [];
  const at = [0, 0, 0];
  while (!numbers.isAtEnd) {
    const code = numbers.next();
    const points = new Float32Array(3 * (code >> 1));
    for (let k = 0; k < points.length; k++) points[k] = (at[k % 3] += numbers.signed()) * step;
    lines.push({ isIndex: (code & 1) === 1, points });
  }
  return lines;
}

// The triangles: positions and corners.
function meshOf(vertices, corners, step) {
  const positions = [];
  const at = [0, 0, 0];
  while (!vertices.isAtEnd) positions.push((at[positions.length % 3] += vertices.signed()) * step);
  const index = [];
  let last = 0;
  while (!corners.isAtEnd) index.push((last += corners.signed()));
  return { positions: new Float32Array(positions), index: new Uint32Array(index) };
}

// All of it. Places are relative to the origin, in metres.
async function readData() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const open = async (name) => unpack(data.packed[name]);
  const names = Object.keys(data.lines);
  const [heights, vertices, corners, ...lines] = await Promise.all([
    open("heights"), open("vertices"), open("corners"), ...names.map((name) => unpack(data.lines[name])),
  ]);
  data.ground = new Ground(data.grid, cellsOf(heights, data.grid, data.step.height));
  data.mesh = meshOf(vertices, corners, data.step.place);
  data.lines = Object.fromEntries(names.map((name, k) => [name, linesOf(lines[k], data.step.place)]));
  if (data.packed.differences) data.differences = cellsOf(await open("differences"), data.grid, data.step.error);
  if (data.packed.errors) data.errors = cellsOf(await open("errors"), data.grid, data.step.error);
  if (data.packed.water) data.water = cellsOf(await open("water"), data.grid, 1);
  return data;
}
