// Lines on the ground: contours, ridge and canyon lines, streams.

// Lines are drawn a little nearer to the eye than they are, so that the triangles under them do not hide them.
const NEARER = 0.0006;

function lineObject(lines, style, isIndex) {
  const own = lines.filter((line) => line.isIndex === isIndex);
  const count = own.reduce((sum, line) => sum + Math.max(line.points.length / 3 - 1, 0), 0);
  if (!count) return null;
  const ends = new Float32Array(6 * count);
  let at = 0;
  for (const { points } of own) {
    for (let k = 3; k < points.length; k += 3) {
      ends.set(points.subarray(k - 3, k + 3), at);
      at += 6;
    }
  }
  const geometry = new THREE.LineSegmentsGeometry();
  geometry.setPositions(ends);
  const material = new THREE.LineMaterial({ color: style.colour, linewidth: (isIndex && style.indexWidth) || style.width });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace("#include <fog_vertex>", `gl_Position.z -= ${NEARER} * gl_Position.w;`);
  };
  return new THREE.LineSegments2(geometry, material);
}

// How clear new contours are in the whole view; from nearer, they become as clear as the others.
const FAINT = 0.3;

// Adds all lines to the scene. Gives the group of each kind, to be shown or not.
function addLines(view, data) {
  const groups = {};
  // The order is that of the colours.
  for (const name of Object.keys(LINES).filter((name) => data.lines[name])) {
    groups[name] = new THREE.Group();
    groups[name].add(...[false, true].map((isIndex) => lineObject(data.lines[name], LINES[name], isIndex)).filter(Boolean));
    view.group.add(groups[name]);
  }
  const faint = (groups.added?.children ?? []).map((child) => Object.assign(child.material, { transparent: true }));
  view.before.add((distance) => faint.forEach((material) => (material.opacity = Math.min((FAINT * view.size) / distance, 1))));
  return groups;
}
