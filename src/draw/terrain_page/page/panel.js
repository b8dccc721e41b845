// The panel: what is shown and how, the level, the legend.

// A row of the panel.
function row(words, input, value) {
  return element("label", {}, element("span", {}, words), input, value ?? "");
}

function slider(words, { min, max, step, value }, say, change) {
  const input = element("input", { type: "range", min, max, step, value });
  const output = element("output", {}, say(Number(input.value)));
  input.addEventListener("input", () => {
    output.value = say(Number(input.value));
    change(Number(input.value));
  });
  return { input, row: row(words, input, output), set: (v) => { input.value = v; input.dispatchEvent(new Event("input")); } };
}

function select(words, options, change) {
  const input = element("select", {}, ...options.map(([value, text]) => element("option", { value }, text)));
  input.addEventListener("change", () => change(input.value));
  return { input, row: row(words, input) };
}

function button(words, press) {
  return element("button", { type: "button", textContent: words, onclick: press });
}

// What the colours mean.
function legendOf(mode, data, units) {
  const box = element("div", { className: "legend" });
  if (mode !== "plain") {
    const [low, high] = rangeOf(mode, data);
    const say = mode === "bySlope" ? (v) => `${units.number(v, 0)}°` : mode === "byDifference" ? (v) => units.difference(v, data.limit) : (v) => units.height(v, mode === "byError" ? 2 : 0);
    const bar = element("div", { className: "bar" });
    const stops = coloursOf(mode, data, 128).map((colour, k) => `rgb(${colour.map(Math.round)}) ${k / 1.28}% ${(k + 1) / 1.28}%`);
    bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    box.append(element("strong", {}, WORDS[mode]), bar, element("div", { className: "ends" }, ...[low, (low + high) / 2, high].map((v) => element("span", {}, say(v)))));
  }
  const key = (colour, width, words) => {
    const line = element("i");
    line.style.borderTop = `${width}px solid ${colour}`;
    return element("div", { className: "key" }, line, words);
  };
  Object.keys(LINES).filter((name) => data.lines[name]).forEach((name) => box.append(key(LINES[name].colour, Math.max(LINES[name].width, 2), WORDS[name])));
  if (data.water) box.append(key(WATER, 8, WORDS.water));
  if (mode === "byDifference" && data.differences.some((d, k) => Number.isNaN(d) && !Number.isNaN(data.ground.heights[k]))) box.append(key(UNKNOWN, 8, WORDS.noDifference));
  return box;
}

function makePanel(view, data, units, { lines, marks, profile, choose }) {
  const { uniforms } = view;
  const modes = [...(data.differences ? ["byDifference"] : []), "byHeight", "byBand", "plain", "bySlope", ...(data.errors ? ["byError"] : [])];
  const wordsOf = (kind) => (kind === "findings" && data.differences ? WORDS.largest : WORDS[kind]);
  const legend = element("div");
  const setMode = (mode) => {
    uniforms.mode.value = SHADES[mode];
    uniforms.ramp.value = rampTexture(mode, data);
    uniforms.range.value.set(...rangeOf(mode, data));
    legend.replaceChildren(legendOf(mode, data, units));
    view.ask();
  };
  const toggle = (words, isOn, change) => {
    const input = element("input", { type: "checkbox", checked: isOn, onchange: () => { change(input.checked); view.ask(); } });
    return element("label", { className: "switch" }, input, element("span", {}, words));
  };
  const switches = [
    ...Object.entries(lines).map(([name, group]) => toggle(WORDS[name], true, (is) => (group.visible = is))),
    data.water && toggle(WORDS.water, true, (is) => (uniforms.showsWater.value = is)),
    ...["labels", "spots", "findings"].filter((kind) => data[kind].length).map((kind) => toggle(wordsOf(kind), true, (is) => (marks.shown[kind] = is))),
  ].filter(Boolean);

  const setSun = () => {
    const [turn, up] = [azimuth.input.value, altitude.input.value].map((degrees) => (degrees * Math.PI) / 180);
    uniforms.sun.value.set(Math.sin(turn) * Math.cos(up), Math.cos(turn) * Math.cos(up), Math.sin(up));
    view.ask();
  };
  const degrees = (value) => `${value}°`;
  const azimuth = slider(WORDS.sun, { min: 0, max: 360, step: 5, value: 315 }, degrees, setSun);
  const altitude = slider(WORDS.sunHeight, { min: 5, max: 90, step: 5, value: 45 }, degrees, setSun);
  const times = slider(WORDS.exaggeration, { min: 0.5, max: 5, step: 0.1, value: data.times }, (value) => `× ${value}`, (value) => {
    view.controls.target.z *= value / view.group.scale.z;
    view.group.scale.z = uniforms.times.value = value;
    view.controls.update();
    view.ask();
  });

  const said = element("output", { className: "said" });
  const [low, high] = data.ground.range.map((height) => height / units.size);
  const setLevel = () => {
    const metres = Number(level.input.value) * units.size;
    const mode = ["none", "flood", "cut"].indexOf(levelMode.input.value);
    uniforms.levelMode.value = mode;
    uniforms.level.value = metres;
    view.flood.visible = mode === 1;
    view.setFlood(metres);
    level.row.hidden = mode === 0;
    const { area, volume } = mode ? data.ground.beyond(metres, mode === 2 ? 1 : -1) : {};
    said.value = mode ? (mode === 2 ? WORDS.above : WORDS.below)(units.area(area), units.volume(volume)) : "";
    view.ask();
  };
  const levelMode = select(WORDS.level, [["none", WORDS.noLevel], ["flood", WORDS.flood], ["cut", WORDS.cut]], setLevel);
  const step = Math.max((high - low) / 1000, 0.01);
  const level = slider(WORDS.level, { min: low, max: high, step, value: (low + high) / 2 }, (value) => units.height(value * units.size), setLevel);

  const picture = () => {
    view.render();
    view.renderer.domElement.toBlob((blob) => save("terrain.png", blob));
  };
  const findings = element("ol", {}, ...data.findings.map((finding, k) =>
    element("li", { className: finding.severity }, finding.place ? button(finding.message, () => choose(k)) : finding.message)));
  const [east, north] = data.origin;
  const about = element("details", {}, element("summary", {}, WORDS.about),
    element("p", {}, data.crs ? WORDS.crs(data.crs, `${east} ${north}`) : WORDS.noCrs(`${east} ${north}`)),
    element("p", {}, WORDS.cells(units.length(data.grid.cell), units.height(data.tolerance, 2))),
    element("details", {}, element("summary", {}, WORDS.licences), element("pre", {}, document.getElementById("licences").textContent)));

  const colours = select(WORDS.colours, modes.map((mode) => [mode, WORDS[mode]]), setMode);
  const panel = element("details", { className: "panel", open: innerWidth > 640 },
    element("summary", {}, element("h1", {}, data.title)),
    colours.row, element("div", { className: "switches" }, ...switches),
    times.row, azimuth.row, altitude.row, levelMode.row, level.row, said,
    element("div", { className: "buttons" },
      button(WORDS.profile, () => profile.switch(!profile.isOn)), button(WORDS.home, view.home), button(WORDS.picture, picture), button(WORDS.print, () => print())),
    data.findings.length ? element("details", { className: "findings" }, element("summary", {}, `${wordsOf("findings")} (${data.findings.length + data.leftOut})`), findings, data.leftOut ? element("p", {}, WORDS.more(data.leftOut)) : "") : "",
    about);
  view.group.scale.z = uniforms.times.value = data.times;
  setMode(modes[0]);
  setSun();
  setLevel();
  return { panel, legend, findings };
}
