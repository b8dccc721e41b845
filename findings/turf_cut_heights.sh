#!/usr/bin/env bash
# The good guess: cutting a 3-D line in the middle of a segment gives the new end either the interpolated height, or none.
# What really happens: @turf/line-slice-along and @turf/line-chunk give it the height of the segment's far end. A road that climbs
#   from 100 m to 180 m and is cut half way has 180 m there, and the next piece starts at 180 m as well. @turf/bbox-clip gives
#   the new ends no height and leaves the others with theirs: one line with 2-D and 3-D positions.
# Version: @turf/turf 7.4.0.
# Source: issue 3007 of Turf is open on the first; the documentation says nothing. For bbox-clip we found nothing.
set -euo pipefail
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
npm install --silent --no-fund --no-audit @turf/turf@7.4.0
cat > run.mjs <<'JS'
import {readFileSync} from 'fs';
import * as turf from '@turf/turf';

console.log('@turf/turf', JSON.parse(readFileSync('node_modules/@turf/turf/package.json', 'utf8')).version);
const road = turf.lineString([[139, 35, 100], [139.01, 35, 180], [139.02, 35, 100]]);
const half = turf.length(turf.lineString(road.geometry.coordinates.slice(0, 2))) / 2;
const sliced = turf.lineSliceAlong(road, 0, half).geometry.coordinates;
const pieces = turf.lineChunk(road, half).features.map(f => f.geometry.coordinates.map(c => c[2]));
const clipped = turf.bboxClip(road, [139.005, 34, 139.015, 36]).geometry.coordinates;
console.log('cut half way up from 100 m to 180 m:', JSON.stringify(sliced));
console.log('heights of the pieces:', JSON.stringify(pieces));
console.log('clipped to a box:', JSON.stringify(clipped));

const ok = sliced[1][2] === 180 && pieces[0][1] === 180 && pieces[1][0] === 180
  && JSON.stringify(clipped.map(c => c.length)) === '[2,3,2]';
if (!ok) { console.error('The behaviour has changed.'); process.exit(1); }
JS
node run.mjs
