// The terrain in space: triangles, their light and colours, and the camera. Heights are in metres; the group raises them.

const VERTEX = `
out vec3 place;
void main() {
  place = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
// Heights at a place, from the cells around it.
const CELLS = `
precision highp float;
precision highp sampler2D;
in vec3 place;
out vec4 colour;
uniform sampler2D heights;
uniform vec2 first;
uniform float cell;
float value(sampler2D cells, vec2 at) {
  ivec2 most = textureSize(cells, 0) - 1;
  ivec2 c = ivec2(floor(at));
  vec2 w = at - floor(at);
  float a = texelFetch(cells, clamp(c, ivec2(0), most), 0).r;
  float b = texelFetch(cells, clamp(c + ivec2(1, 0), ivec2(0), most), 0).r;
  float d = texelFetch(cells, clamp(c + ivec2(0, 1), ivec2(0), most), 0).r;
  float e = texelFetch(cells, clamp(c + ivec2(1, 1), ivec2(0), most), 0).r;
  return mix(mix(a, b, w.x), mix(d, e, w.x), w.y);
}
vec2 cellOf(vec2 p) { return vec2(p.x - first.x, first.y - p.y) / cell; }
`;
const GROUND = `${CELLS}
uniform sampler2D values;
uniform sampler2D water;
uniform sampler2D ramp;
uniform int mode;
uniform vec2 range;
uniform vec3 sun;
uniform float times;
uniform int levelMode;
uniform float level;
uniform vec3 waterColour;
uniform vec3 floodColour;
uniform vec3 unknownColour;
uniform bool showsWater;
void main() {
  if (levelMode == 2 && place.z > level) discard;
  vec2 at = cellOf(place.xy);
  vec2 rise = vec2(value(heights, at + vec2(1, 0)) - value(heights, at - vec2(1, 0)), value(heights, at - vec2(0, 1)) - value(heights, at + vec2(0, 1))) / (2.0 * cell);
  float shown = mode == 2 ? degrees(atan(length(rise))) : mode == 3 ? value(values, at) : place.z;
  vec3 own = texture(ramp, vec2((shown - range.x) / max(range.y - range.x, 1e-6), 0.5)).rgb;
  // One cell around without a value makes a mean far below all of them.
  if (mode == 3 && shown < -9000.0) own = unknownColour;
  if (showsWater && texelFetch(water, clamp(ivec2(at + 0.5), ivec2(0), textureSize(water, 0) - 1), 0).r > 0.5) own = waterColour;
  if (levelMode == 1 && place.z < level) own = mix(own, floodColour, 0.55);
  float light = dot(normalize(vec3(-rise * times, 1.0)), sun);
  colour = vec4(own * (0.42 + 0.72 * max(light, 0.0)), 1.0);
}`;
// The level of a flood, where the ground is below it.
const FLOODED = `${CELLS}
uniform vec3 floodColour;
void main() {
  vec2 at = cellOf(place.xy);
  ivec2 most = textureSize(heights, 0) - 1;
  for (int k = 0; k < 4; k++) {
    if (texelFetch(heights, clamp(ivec2(floor(at)) + ivec2(k & 1, k >> 1), ivec2(0), most), 0).r < -90000.0) discard;
  }
  if (value(heights, at) > place.z) discard;
  colour = vec4(floodColour, 0.5);
}`;

// The value of cells that have none: a quarter of it is still below all others.
const MISSING = -1e6;

function cellTexture(values, ground) {
  const texture = new THREE.DataTexture(values, ground.cols, ground.rows, THREE.RedFormat, THREE.FloatType);
  texture.needsUpdate = true;
  return texture;
}

function rampTexture(mode, data) {
  const count = 2048;
  const pixels = new Uint8Array(coloursOf(mode, data, count).flatMap((colour) => [...colour, 255]));
  const texture = new THREE.DataTexture(pixels, count, 1, THREE.RGBAFormat, THREE.UnsignedByteType);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

// Null if the browser cannot draw it.
function makeScene(canvas, data) {
  const { ground, mesh } = data;
  const trial = document.createElement("canvas").getContext("webgl2");
  if (!trial || Math.max(ground.cols, ground.rows) > trial.getParameter(trial.MAX_TEXTURE_SIZE)) return null;
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#eef1f3");
  const group = new THREE.Group();
  scene.add(group);
  const none = new Float32Array(1);
  const one = { cols: 1, rows: 1 };
  const rgb = (colour) => new THREE.Vector3(...parts(colour).map((part) => part / 255));
  const uniforms = {
    heights: { value: cellTexture(ground.filled(), ground) },
    values: { value: data.differences ? cellTexture(data.differences.map((d) => (Number.isNaN(d) ? MISSING : d)), ground) : data.errors ? cellTexture(data.errors.map((e) => e || 0), ground) : cellTexture(none, one) },
    water: { value: data.water ? cellTexture(data.water.map((w) => w || 0), ground) : cellTexture(none, one) },
    ramp: { value: null },
    mode: { value: 0 },
    range: { value: new THREE.Vector2(...ground.range) },
    sun: { value: new THREE.Vector3(0, 0, 1) },
    times: { value: 1 },
    first: { value: new THREE.Vector2(ground.x, ground.y) },
    cell: { value: ground.cell },
    levelMode: { value: 0 },
    level: { value: 0 },
    waterColour: { value: rgb(WATER) },
    floodColour: { value: rgb(FLOOD) },
    unknownColour: { value: rgb(UNKNOWN) },
    showsWater: { value: Boolean(data.water) },
  };
  const material = (fragmentShader, options) =>
    new THREE.ShaderMaterial({ glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader, uniforms, side: THREE.DoubleSide, ...options });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(mesh.positions, 3));
  geometry.setIndex(new THREE.BufferAttribute(mesh.index, 1));
  // Lines on the ground are drawn before it.
  group.add(new THREE.Mesh(geometry, material(GROUND, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })));
  const flood = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material(FLOODED, { transparent: true, depthWrite: false }));
  flood.visible = false;
  // The plane has its size in its positions, which the shader reads.
  const corners = [[ground.west, ground.north], [ground.east, ground.north], [ground.west, ground.south], [ground.east, ground.south]];
  const setFlood = (level) => {
    corners.forEach(([x, y], k) => flood.geometry.attributes.position.setXYZ(k, x, y, level));
    flood.geometry.attributes.position.needsUpdate = true;
    flood.geometry.computeBoundingSphere();
  };
  group.add(flood);

  const camera = new THREE.PerspectiveCamera(38, 1, 1, 1e7);
  camera.up.set(0, 0, 1);
  const controls = new THREE.MapControls(camera, canvas);
  controls.screenSpacePanning = false;
  controls.maxPolarAngle = Math.PI * 0.495;
  const size = Math.max(Math.hypot(ground.east - ground.west, ground.north - ground.south), ground.cell);
  controls.minDistance = size / 400;
  controls.maxDistance = size * 4;

  const view = { renderer, scene, group, camera, controls, uniforms, flood, setFlood, size, before: new Set(), changed: new Set() };
  let isAsked = false;
  view.render = () => {
    isAsked = false;
    const distance = camera.position.distanceTo(controls.target);
    camera.near = distance / 60;
    camera.far = distance + 3 * size;
    camera.updateProjectionMatrix();
    view.before.forEach((prepare) => prepare(distance));
    renderer.render(scene, camera);
    view.changed.forEach((tell) => tell());
  };
  view.ask = () => {
    if (!isAsked) requestAnimationFrame(view.render);
    isAsked = true;
  };
  view.home = () => {
    const middle = [(ground.west + ground.east) / 2, (ground.south + ground.north) / 2, ((ground.range[0] + ground.range[1]) / 2) * group.scale.z];
    // A narrow view needs more distance.
    const distance = 1.15 * size * Math.max(1, 1.1 / camera.aspect);
    // A wide view has the panel at its left.
    if (canvas.clientWidth > 900) middle[0] -= 0.11 * size;
    controls.target.set(...middle);
    const tilt = (48 * Math.PI) / 180;
    camera.position.set(middle[0], middle[1] - distance * Math.cos(tilt), middle[2] + distance * Math.sin(tilt));
    controls.update();
    view.ask();
  };
  view.goTo = ([x, y, z]) => {
    const offset = camera.position.clone().sub(controls.target).setLength(size / 5);
    controls.target.set(x, y, z * group.scale.z);
    camera.position.copy(controls.target).add(offset);
    controls.update();
    view.ask();
  };
  view.resize = () => {
    const [width, height] = [canvas.clientWidth || 1, canvas.clientHeight || 1];
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    view.ask();
  };
  // The place on the ground under a pixel of the canvas; null beside it.
  view.placeAt = (x, y) => {
    const pixel = new THREE.Vector3((2 * x) / canvas.clientWidth - 1, 1 - (2 * y) / canvas.clientHeight, 0.5);
    camera.updateMatrixWorld();
    const along = pixel.unproject(camera).sub(camera.position);
    const scale = group.scale.z;
    return ground.hit([camera.position.x, camera.position.y, camera.position.z / scale], [along.x, along.y, along.z / scale]);
  };
  // Where a place is on the canvas: pixels, and whether the ground hides it.
  view.pixelOf = (place) => {
    const at = new THREE.Vector3(place[0], place[1], place[2] * group.scale.z).project(camera);
    return { x: ((at.x + 1) / 2) * canvas.clientWidth, y: ((1 - at.y) / 2) * canvas.clientHeight, isBefore: at.z < 1 };
  };
  view.isHidden = ([x, y, z]) => {
    const eye = [camera.position.x, camera.position.y, camera.position.z / group.scale.z];
    const along = [x - eye[0], y - eye[1], z - eye[2]];
    const met = ground.hit(eye, along);
    return met !== null && Math.hypot(met[0] - x, met[1] - y) > Math.max(4 * ground.cell, size / 200);
  };
  controls.addEventListener("change", view.ask);
  new ResizeObserver(view.resize).observe(canvas);
  return view;
}
