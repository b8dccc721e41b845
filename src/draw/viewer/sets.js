// Sets of tiles beside the page: what the server says about them, and their tiles.

// What the user must know. Its message is a sentence of the page.
class Fault extends Error {}

const HEADER_BYTES = 127;

// The address of something beside the page. Names may have any character.
function address(...names) {
  return new URL(names.map(encodeURIComponent).join("/"), new URL(".", document.baseURI)).href;
}

// Asks the server; what it refuses is a fault.
async function ask(name, url, options) {
  let answer;
  try {
    answer = await fetch(url, options);
  } catch (cause) {
    if (cause.name === "AbortError") throw cause;
    throw new Fault(WORDS.unreachable(name));
  }
  if (answer.status === 404) throw new Fault(WORDS.missing(name));
  if (!answer.ok) throw new Fault(WORDS.status(name, answer.status));
  return answer;
}

// Opens a set: `name` is that of a .pmtiles, or of a folder whose tiles have this extension.
async function openSet({ name, extension }) {
  const set = await (extension ? openFolder(name, extension) : openArchive(name));
  const layers = set.about.vector_layers;
  if (Array.isArray(layers) && layers.some((layer) => layer.id === "contours")) {
    set.kind = "contours";
    // The description of the layer ends with the unit.
    const words = String(layers.find((layer) => layer.id === "contours").description);
    set.isInFeet = words.endsWith("feet");
    set.unit = words.endsWith("US survey feet") ? "US ft" : set.isInFeet ? "ft" : "m";
  } else if (["terrarium", "mapbox", "gsi"].includes(set.about.encoding)) {
    set.kind = "terrain";
    set.side = Number(set.about.tile_size) || 512;
  } else {
    throw new Fault(WORDS.otherContents(name));
  }
  return set;
}

async function openArchive(name) {
  const url = address(name);
  const stop = new AbortController();
  const range = { headers: { Range: `bytes=0-${HEADER_BYTES - 1}` }, cache: "no-store", signal: stop.signal };
  const answer = await ask(name, url, range);
  const isPacked = answer.headers.has("Content-Encoding");
  // The whole archive may come; it is not waited for.
  if (answer.status !== 206) stop.abort();
  if (isPacked) throw new Fault(WORDS.packed(name));
  if (answer.status !== 206) throw new Fault(WORDS.noRanges(name));
  const archive = new pmtiles.PMTiles(url);
  try {
    const header = await archive.getHeader();
    return {
      name,
      about: await archive.getMetadata(),
      zooms: [header.minZoom, header.maxZoom],
      bounds: [header.minLon, header.minLat, header.maxLon, header.maxLat],
      tile: async (z, x, y, signal) => (await archive.getZxy(z, x, y, signal))?.data ?? null,
    };
  } catch (cause) {
    throw new Fault(WORDS.damaged(name, cause.message));
  }
}

async function openFolder(name, extension) {
  const answer = await ask(`${name}/metadata.json`, address(name, "metadata.json"), { cache: "no-store" });
  let about;
  try {
    about = await answer.json();
  } catch (cause) {
    throw new Fault(WORDS.damaged(`${name}/metadata.json`, cause.message));
  }
  const bounds = String(about.bounds).split(",").map(Number);
  const zooms = [about.minzoom, about.maxzoom].map(Number);
  if (bounds.length !== 4 || ![...bounds, ...zooms].every(Number.isFinite)) {
    throw new Fault(WORDS.damaged(`${name}/metadata.json`, "bounds, minzoom, maxzoom"));
  }
  return {
    name,
    about,
    zooms,
    bounds,
    tile: async (z, x, y, signal) => {
      const answer = await fetch(address(name, String(z), String(x), `${y}.${extension}`), { signal });
      // There is no tile where there is no ground, and none where no contour is.
      if (answer.status === 404) return null;
      if (!answer.ok) throw new Fault(WORDS.status(name, answer.status));
      return answer.arrayBuffer();
    },
  };
}

// Gives tiles to the map, under the addresses set://NUMBER/z/x/y.
function serveSets(sets) {
  maplibregl.addProtocol("set", async ({ url }, { signal }) => {
    const [number, z, x, y] = url.slice("set://".length).split("/").map(Number);
    const set = sets[number];
    let data = await set.tile(z, x, y, signal);
    if (set.kind === "contours") return { data: data ?? new ArrayBuffer(0) };
    if (data && set.about.encoding === "gsi") data = await withoutSign(data);
    return { data };
  });
}

// Tiles of GSI have heights below 0 as a complement. With the highest bit turned, heights grow with the number.
async function withoutSign(data) {
  const { canvas, context, pixels } = await pixelsOf(data);
  for (let k = 0; k < pixels.data.length; k += 4) pixels.data[k] ^= 0x80;
  context.putImageData(pixels, 0, 0);
  return (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer();
}

// The colours of a picture, unchanged.
async function pixelsOf(data) {
  const exact = { premultiplyAlpha: "none", colorSpaceConversion: "none" };
  const picture = await createImageBitmap(new Blob([data]), exact);
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(picture, 0, 0);
  return { canvas, context, pixels: context.getImageData(0, 0, picture.width, picture.height) };
}
