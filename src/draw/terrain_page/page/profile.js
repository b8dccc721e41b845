// The profile between two places: a chart, and a table for other programs.

const SVG = "http://www.w3.org/2000/svg";

function shape(tag, attributes, text) {
  const made = document.createElementNS(SVG, tag);
  Object.entries(attributes).forEach(([name, value]) => made.setAttribute(name, value));
  if (text !== undefined) made.textContent = text;
  return made;
}

function chart(points, units) {
  const [width, height, left, right, top, bottom] = [560, 170, 56, 12, 10, 26];
  const known = points.filter((point) => !Number.isNaN(point.height));
  const heights = known.map((point) => point.height / units.size);
  const [low, high] = [Math.min(...heights), Math.max(...heights)];
  const length = points.at(-1).distance;
  const rise = high - low || 1;
  const x = (distance) => left + (distance / (length || 1)) * (width - left - right);
  const y = (value) => height - bottom - ((value - low) / rise) * (height - top - bottom);
  const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  for (let k = 0; k <= 2; k++) {
    const value = low + (rise * k) / 2;
    svg.append(
      shape("line", { x1: left, x2: width - right, y1: y(value), y2: y(value), stroke: "#c9c2b6" }),
      shape("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, units.number(value, rise < 10 ? 1 : 0)),
      shape("text", { x: x((length * k) / 2), y: height - 8, "text-anchor": ["start", "middle", "end"][k] }, units.length((length * k) / 2)),
    );
  }
  let path = "";
  let isOn = false;
  for (const point of points) {
    const is = !Number.isNaN(point.height);
    if (is) path += `${isOn ? "L" : "M"}${x(point.distance).toFixed(1)} ${y(point.height / units.size).toFixed(1)}`;
    isOn = is;
  }
  svg.append(shape("path", { d: path, fill: "none", stroke: "#7a2a0c", "stroke-width": 2 }));
  return { svg, low: low * units.size, high: high * units.size, length };
}

function save(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function csvOf(points, data, units) {
  const [east, north] = data.origin;
  const row = ({ distance, x, y, height }) =>
    [distance / units.size, x + east, y + north, Number.isNaN(height) ? "" : height / units.size].map((v) => (v === "" ? v : v.toFixed(3))).join(",");
  return [`distance_${units.name},x,y,height_${units.name}`, ...points.map(row)].join("\n") + "\n";
}

// The box of the profile; it asks for two places, then shows their profile.
function makeProfile(view, data, units, box) {
  const state = { isOn: false, ends: [], points: null };
  const line = new THREE.Group();
  view.group.add(line);
  const clear = () => {
    line.children.forEach((child) => child.geometry.dispose());
    line.clear();
  };
  const show = () => {
    box.hidden = !state.isOn;
    clear();
    const close = element("button", { type: "button", textContent: WORDS.close, onclick: () => state.switch(false) });
    if (state.ends.length < 2) {
      box.replaceChildren(element("p", {}, WORDS.profileHint), close);
    } else {
      state.points = data.ground.profile(...state.ends);
      const { svg, low, high, length } = chart(state.points, units);
      const csv = element("button", {
        type: "button", textContent: WORDS.csv, onclick: () => save("profile.csv", new Blob([csvOf(state.points, data, units)], { type: "text/csv" })),
      });
      const words = WORDS.profileLength(units.length(length), units.height(low), units.height(high));
      svg.setAttribute("aria-label", words);
      box.replaceChildren(svg, element("p", {}, words), csv, close);
      const points = state.points.filter((point) => !Number.isNaN(point.height)).flatMap((point) => [point.x, point.y, point.height]);
      const drawn = lineObject([{ isIndex: false, points: new Float32Array(points) }], { colour: "#d0006f", width: 3 }, false);
      if (drawn) line.add(drawn);
    }
    view.ask();
  };
  state.switch = (isOn) => {
    Object.assign(state, { isOn, ends: [], points: null });
    show();
  };
  // Takes a place. A third one begins anew.
  state.take = (place) => {
    if (!state.isOn || !place) return;
    state.ends = state.ends.length === 2 ? [place] : [...state.ends, place];
    show();
  };
  return state;
}
