// Heights at places, from the pixels of terrain tiles.

const KEPT_TILES = 24;

// A function from a place to the height of its pixel in metres, at the highest zoom; null where the set has none.
function heightReader(set) {
  const tiles = new Map();
  const load = async (x, y) => {
    const data = await set.tile(set.zooms[1], x, y);
    return data && (await pixelsOf(data)).pixels;
  };
  const tileAt = (x, y) => {
    const key = `${x}/${y}`;
    // The tile that was used last is the last one.
    const tile = tiles.get(key) ?? load(x, y);
    tiles.delete(key);
    tiles.set(key, tile);
    if (tiles.size > KEPT_TILES) tiles.delete(tiles.keys().next().value);
    tile.catch(() => tiles.delete(key));
    return tile;
  };
  return async ({ lng, lat }) => {
    const [west, south, east, north] = set.bounds;
    if (lng < west || lng > east || lat < south || lat > north) return null;
    const { x, y } = maplibregl.MercatorCoordinate.fromLngLat({ lng, lat });
    const count = 2 ** set.zooms[1];
    const pixels = await tileAt(Math.floor(x * count), Math.floor(y * count));
    if (!pixels) return null;
    const [column, row] = [x, y].map((part) => Math.floor(((part * count) % 1) * pixels.width));
    return heightOf(set.about.encoding, pixels.data.subarray(4 * (row * pixels.width + column)));
  };
}

function heightOf(encoding, [red, green, blue]) {
  const number = 65536 * red + 256 * green + blue;
  if (encoding === "terrarium") return number / 256 - 32768;
  if (encoding === "mapbox") return number / 10 - 10000;
  return (number < 2 ** 23 ? number : number - 2 ** 24) / 100;
}
