// The map: its sources and layers.

const INK = "#7a4a1e";
const PAPER = "#f6f3ea";

// The smallest box around several.
function around(boxes) {
  const side = (k, choose) => choose(...boxes.map((box) => box[k]));
  return [side(0, Math.min), side(1, Math.min), side(2, Math.max), side(3, Math.max)];
}

// The source of a set. Terrain has two: shading and relief load tiles of different zooms.
function sourceOf(set, number) {
  const common = { tiles: [`set://${number}/{z}/{x}/{y}`], minzoom: set.zooms[0], maxzoom: set.zooms[1], bounds: set.bounds };
  if (set.kind === "contours") return { type: "vector", ...common };
  const colours =
    set.about.encoding === "gsi"
      ? { encoding: "custom", redFactor: 655.36, greenFactor: 2.56, blueFactor: 0.01, baseShift: 83886.08 }
      : { encoding: set.about.encoding };
  return { type: "raster-dem", tileSize: set.side, ...common, ...colours };
}

// The layers of a set of contours.
function contourLayers(id) {
  const common = { source: id, "source-layer": "contours" };
  const width = (index, other) => ["case", ["get", "idx"], index, other];
  return [
    {
      id: `${id} lines`,
      type: "line",
      ...common,
      layout: { "line-join": "round" },
      paint: {
        "line-color": INK,
        "line-opacity": ["case", ["get", "idx"], 0.95, 0.75],
        "line-width": ["interpolate", ["linear"], ["zoom"], 8, width(0.9, 0.35), 14, width(1.8, 0.7), 18, width(2.6, 1.1)],
      },
    },
    {
      id: `${id} labels`,
      type: "symbol",
      ...common,
      filter: ["get", "idx"],
      layout: {
        "symbol-placement": "line",
        "symbol-spacing": 260,
        "text-field": ["get", "label"],
        // The style has no glyphs, so that the browser draws the text with its own font.
        "text-font": ["sans-serif"],
        "text-size": 11,
        "text-padding": 4,
        "text-max-angle": 35,
      },
      paint: { "text-color": "#5b3410", "text-halo-color": PAPER, "text-halo-width": 1.6 },
    },
  ];
}

// The style for all sets. Layers of the first set of each kind are visible.
function styleOf(sets) {
  const sources = {};
  const layers = [{ id: "paper", type: "background", paint: { "background-color": PAPER } }];
  sets.forEach((set, number) => {
    set.id = `set ${number}`;
    sources[set.id] = sourceOf(set, number);
    if (set.kind === "terrain") {
      sources[`${set.id} relief`] = sourceOf(set, number);
      layers.push({
        id: `${set.id} shade`,
        type: "hillshade",
        source: set.id,
        paint: { "hillshade-exaggeration": 0.4, "hillshade-shadow-color": "#4a4336", "hillshade-highlight-color": "#ffffff", "hillshade-accent-color": "#6b6350" },
      });
    }
  });
  sets.filter((set) => set.kind === "contours").forEach((set) => layers.push(...contourLayers(set.id)));
  return { version: 8, sources, layers };
}

// The map, which begins with all of its sets in view.
function makeMap(container, sets) {
  const zooms = sets.flatMap((set) => set.zooms);
  return new maplibregl.Map({
    container,
    style: styleOf(sets),
    bounds: around(sets.map((set) => set.bounds)),
    fitBoundsOptions: { padding: 24 },
    minZoom: Math.max(0, Math.min(...zooms) - 2),
    maxZoom: Math.min(22, Math.max(...zooms) + 4),
    maxPitch: 80,
    hash: true,
    renderWorldCopies: false,
    attributionControl: false,
    locale: WORDS.locale,
  });
}
