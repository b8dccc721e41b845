// What happens over the picture: the pointer, keys, the north arrow, the scale bar, printing.

// The scale bar: a round length near a width in pixels, at the middle of the view.
function scaleOf(view, units, canvas) {
  const metresPerPixel = (2 * view.camera.position.distanceTo(view.controls.target) * Math.tan((view.camera.fov * Math.PI) / 360)) / canvas.clientHeight;
  const most = (110 * metresPerPixel) / units.size;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((k) => k * power).find((candidate) => candidate <= most) ?? power;
  return { pixels: (length * units.size) / metresPerPixel, words: units.length(length * units.size) };
}

// Turns the view round its middle, and tilts it.
function turn(view, east, up) {
  const offset = view.camera.position.clone().sub(view.controls.target);
  const distance = offset.length();
  const azimuth = Math.atan2(offset.y, offset.x) + east;
  const altitude = Math.min(Math.max(Math.asin(offset.z / distance) + up, 0.02), 1.57);
  offset.set(Math.cos(azimuth) * Math.cos(altitude), Math.sin(azimuth) * Math.cos(altitude), Math.sin(altitude)).multiplyScalar(distance);
  view.camera.position.copy(view.controls.target).add(offset);
  view.controls.update();
  view.ask();
}

// Moves the view by shares of its distance, to the right and forward.
function move(view, right, forward) {
  const offset = view.camera.position.clone().sub(view.controls.target);
  const way = new THREE.Vector3(-offset.x, -offset.y, 0).normalize();
  const step = new THREE.Vector3(way.x * forward + way.y * right, way.y * forward - way.x * right, 0).multiplyScalar(offset.length());
  view.camera.position.add(step);
  view.controls.target.add(step);
  view.controls.update();
  view.ask();
}

function zoom(view, factor) {
  const offset = view.camera.position.clone().sub(view.controls.target).multiplyScalar(factor);
  view.camera.position.copy(view.controls.target).add(offset);
  view.controls.update();
  view.ask();
}

function watch(view, data, units, profile, { canvas, readout, cross, north, scale }) {
  const tell = (place) => {
    if (!place) {
      readout.value = WORDS.noHeight;
      return;
    }
    const [x, y, z] = place;
    const slope = data.ground.slopeAt(x, y);
    const difference = data.differences ? data.ground.read(data.differences, x, y) : NaN;
    const decimals = Math.abs(data.origin[0]) < 1000 && data.grid.cell < 1 ? 2 : 1;
    readout.value = `${WORDS.height} ${units.height(z, 2)}${Number.isNaN(slope) ? "" : `, ${WORDS.slope} ${units.number(slope, 0)}°`}${Number.isNaN(difference) ? "" : `, ${WORDS.difference} ${units.difference(difference)}`} · ${(x + data.origin[0]).toFixed(decimals)} ${(y + data.origin[1]).toFixed(decimals)}`;
  };
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return view.placeAt(event.clientX - box.left, event.clientY - box.top);
  };
  let down = null;
  canvas.addEventListener("pointermove", (event) => {
    cross.hidden = true;
    if (!event.buttons) tell(at(event));
  });
  canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  canvas.addEventListener("pointerup", (event) => {
    // Where the view was moved, nothing was chosen.
    if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5) return;
    const place = at(event);
    tell(place);
    profile.take(place);
  });
  const middle = () => view.placeAt(canvas.clientWidth / 2, canvas.clientHeight / 2);
  const keys = {
    ArrowLeft: (is) => (is ? turn(view, -0.1, 0) : move(view, -0.06, 0)),
    ArrowRight: (is) => (is ? turn(view, 0.1, 0) : move(view, 0.06, 0)),
    ArrowUp: (is) => (is ? turn(view, 0, 0.08) : move(view, 0, 0.06)),
    ArrowDown: (is) => (is ? turn(view, 0, -0.08) : move(view, 0, -0.06)),
    "+": () => zoom(view, 0.85),
    "=": () => zoom(view, 0.85),
    "-": () => zoom(view, 1 / 0.85),
    Home: view.home,
    Enter: () => profile.take(middle()),
  };
  canvas.addEventListener("keydown", (event) => {
    const key = keys[event.key];
    if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    key(event.shiftKey);
    cross.hidden = false;
    tell(middle());
  });
  north.addEventListener("click", () => {
    const offset = view.camera.position.clone().sub(view.controls.target);
    turn(view, -Math.PI / 2 - Math.atan2(offset.y, offset.x), 0);
  });
  view.changed.add(() => {
    const offset = view.camera.position.clone().sub(view.controls.target);
    north.firstElementChild.style.transform = `rotate(${((-Math.PI / 2 - Math.atan2(offset.y, offset.x)) * -180) / Math.PI}deg)`;
    const { pixels, words } = scaleOf(view, units, canvas);
    scale.firstElementChild.style.width = `${pixels.toFixed(0)}px`;
    scale.lastElementChild.textContent = words;
  });
}
