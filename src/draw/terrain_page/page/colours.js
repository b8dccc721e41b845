// Colours of the ground and of lines. A ramp has its colours at even steps.

const RAMPS = {
  byHeight: ["#5f8f6a", "#9dba7c", "#d9d39a", "#c9a973", "#a9805c", "#8f6f63", "#f2eeea"],
  plain: ["#d8d2c6", "#d8d2c6"],
  bySlope: ["#f4f1e6", "#f6d98a", "#ee9a4d", "#cf4a3a", "#7d1d4c", "#2c0f35"],
  byError: ["#f1eef6", "#c3b6dc", "#9a86c4", "#7a4fa8", "#5b1f86", "#37094f"],
  // Those of the report: the middle is 0.
  byDifference: ["#184182", "#4382be", "#a0c8e0", "#f6f6f4", "#f5b08e", "#d45e4a", "#821428"],
};
// Each band between two contours in one colour.
RAMPS.byBand = RAMPS.byHeight;
const LINES = {
  input: { colour: "#4a2b10", width: 1, indexWidth: 2 },
  contours: { colour: "#4a2b10", width: 0.9, indexWidth: 1.6 },
  added: { colour: "#b4500f", width: 0.9, indexWidth: 1.6 },
  ridges: { colour: "#a01446", width: 1.4 },
  canyons: { colour: "#0d4f9e", width: 1.4 },
  streams: { colour: "#0a66c2", width: 2.2 },
  breaks: { colour: "#111111", width: 2 },
};
// The colours of the ground that a page can show, and how the shader knows them. Errors and differences are values of cells.
const SHADES = { byHeight: 0, byBand: 0, plain: 1, bySlope: 2, byError: 3, byDifference: 3 };
// Where the difference is not known.
const UNKNOWN = "#8d8d88";
const WATER = "#7fb2d6";
const FLOOD = "#2f74b5";

// The slope at the end of its ramp, degrees.
const STEEPEST = 60;

// What a ramp means, from its first colour to its last: metres, or degrees for slopes.
function rangeOf(mode, data) {
  if (mode === "bySlope") return [0, STEEPEST];
  if (mode === "byError") return [0, data.errors.reduce((most, error) => (error > most ? error : most), 0) || 1];
  if (mode === "byDifference") return [-data.limit, data.limit];
  return data.ground.range;
}

function parts(colour) {
  return [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
}

// The colour at a share of a ramp, as numbers from 0 to 255.
function colourAt(ramp, share) {
  const place = Math.min(Math.max(share, 0), 1) * (ramp.length - 1);
  const k = Math.min(Math.floor(place), ramp.length - 2);
  const [from, to] = [parts(ramp[k]), parts(ramp[k + 1])];
  return from.map((part, n) => part + (place - k) * (to[n] - part));
}

// The levels of all contours inside the range of the heights, with its ends.
function levelsOf(data) {
  const [low, high] = data.ground.range;
  const levels = new Set(["input", "contours", "added"].flatMap((name) => (data.lines[name] ?? []).map((line) => line.points[2])));
  return [low, ...[...levels].filter((level) => low < level && level < high).sort((a, b) => a - b), high];
}

// The colours of a mode at even steps of its range.
function coloursOf(mode, data, count) {
  const shares = Array.from({ length: count }, (_, k) => k / (count - 1));
  if (mode !== "byBand") return shares.map((share) => colourAt(RAMPS[mode], share));
  const levels = levelsOf(data);
  const [low, high] = data.ground.range;
  let k = 1;
  return shares.map((share) => {
    while (k < levels.length - 1 && levels[k] <= low + share * (high - low)) k++;
    return colourAt(RAMPS.byBand, ((levels[k - 1] + levels[k]) / 2 - low) / (high - low || 1));
  });
}
