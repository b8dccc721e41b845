#!/usr/bin/env bash
# The good guess: baseShift of a raster-dem source with encoding "custom" is added, as the style specification says. So heights
#   that are counted from -10000 m need baseShift: -10000.
# What really happens: MapLibre GL JS subtracts it. -10000 lifts the ground by 20 km in all; right is 10000. The built-in encodings
#   use the same code with their bases as positive numbers (10000 and 32768).
# Version: maplibre-gl 6.17.0 and @maplibre/maplibre-gl-style-spec 26.6.0; bundled with esbuild 0.28.2 to run in Node.
# Source: the specification ("added") against src/data/dem_data.ts of the package.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
npm install --silent --no-fund --no-audit maplibre-gl@6.17.0 @maplibre/maplibre-gl-style-spec@26.6.0 esbuild@0.28.2
cat > run.ts <<'JS'
import {readFileSync} from 'fs';
import {DEMData} from './node_modules/maplibre-gl/src/data/dem_data.ts';

const packages = ['maplibre-gl', '@maplibre/maplibre-gl-style-spec'];
console.log(packages.map(p => `${p} ${JSON.parse(readFileSync(`node_modules/${p}/package.json`, 'utf8')).version}`).join(', '));
const specification = JSON.parse(readFileSync('node_modules/@maplibre/maplibre-gl-style-spec/dist/latest.json', 'utf8'));
const words: string = specification.source_raster_dem.baseShift.doc;
console.log('the specification says:', words);

// A tile of 4 x 4 pixels with the border of 2 pixels that the engine keeps; every pixel is 0 m in Mapbox encoding.
function height(encoding: 'mapbox' | 'custom', ...custom: number[]): number {
    const side = 8;
    const data = new Uint8Array(side * side * 4);
    for (let i = 0; i < side * side; i++) data.set([1, 134, 160, 255], i * 4);
    return Math.round(new DEMData('a', {width: side, height: side, data} as any, encoding, ...custom).get(1, 1));
}
const builtIn = height('mapbox');
const asWritten = height('custom', 6553.6, 25.6, 0.1, -10000);
const opposite = height('custom', 6553.6, 25.6, 0.1, 10000);
console.log(`mapbox: ${builtIn} m; custom with baseShift -10000: ${asWritten} m; with 10000: ${opposite} m`);

if (!(words.includes('added') && builtIn === 0 && asWritten === 20000 && opposite === 0)) {
    console.error('The behaviour has changed.');
    process.exit(1);
}
JS
npx esbuild run.ts --bundle --platform=node --format=cjs --log-level=error --outfile=run.cjs
node run.cjs
