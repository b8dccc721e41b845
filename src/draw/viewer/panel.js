// The panel: switches, units, the height under the pointer, and faults.

const METRES_PER_FOOT = 0.3048;

// An element with properties and children. Texts are texts: nothing in them is read as HTML.
function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// How to start a web server.
function instructions() {
  const commands = WITH_RANGES.map((command) => element("code", {}, command));
  return [
    element("p", {}, WORDS.howTo),
    ...commands,
    element("p", {}, WORDS.thenOpen),
    element("p", {}, WORDS.folders),
    element("code", {}, WITHOUT_RANGES),
  ];
}

// Shows faults: over everything if there is no map, otherwise in the panel.
function showFaults(faults, place) {
  const isAll = place === document.body;
  const heading = element("h2", {}, isAll ? WORDS.cannot : WORDS.partly);
  const box = element("section", { className: isAll ? "faults all" : "faults", role: "alert" }, heading);
  [...new Set(faults)].forEach((fault) => box.append(element("p", {}, fault)));
  if (isAll) box.append(...instructions());
  place.querySelector(".faults")?.remove();
  place.append(box);
}

// A switch with its words.
function switchFor(words, isOn, change) {
  const box = element("input", { type: "checkbox", checked: isOn });
  box.addEventListener("change", () => change(box.checked));
  return element("label", {}, box, element("span", {}, words));
}

// A choice of one.
function choice(words, options, chosen, change) {
  const select = element("select", {}, ...options.map(([value, text]) => element("option", { value }, text)));
  select.value = chosen;
  select.addEventListener("change", () => change(select.value));
  return element("label", {}, element("span", {}, `${words} `), select);
}

// A number with the decimals that its unit deserves.
function inUnit(metres, unit) {
  return unit === "ft" ? `${(metres / METRES_PER_FOOT).toFixed(1)} ft` : `${metres.toFixed(1)} m`;
}

function makePanel(map, sets, title) {
  const [contours, terrain] = ["contours", "terrain"].map((kind) => sets.filter((set) => set.kind === kind));
  const state = { contours: contours[0], terrain: terrain[0], labels: true, shade: true, relief: false, times: 1, unit: contours[0]?.isInFeet ? "ft" : "m" };
  const scale = new maplibregl.ScaleControl({ maxWidth: 120 });
  const interval = element("small", {});
  const readout = element("output", { className: "height" });
  const panel = element("aside", { className: "panel" }, element("h1", {}, title));

  const apply = () => {
    const show = (id, isShown) => map.setLayoutProperty(id, "visibility", isShown ? "visible" : "none");
    contours.forEach((set) => {
      show(`${set.id} lines`, set === state.contours);
      show(`${set.id} labels`, set === state.contours && state.labels);
    });
    terrain.forEach((set) => show(`${set.id} shade`, set === state.terrain && state.shade));
    const relief = state.relief && state.terrain;
    map.setTerrain(relief ? { source: `${state.terrain.id} relief`, exaggeration: state.times } : null);
    scale.setUnit(state.unit === "ft" ? "imperial" : "metric");
    describe();
  };
  // The interval at the zoom of the view.
  const describe = () => {
    const set = state.contours;
    if (!set) return interval.replaceChildren();
    const zoom = Math.min(Math.max(Math.floor(map.getZoom()), 0), set.zooms[1]);
    const step = set.about.intervals?.[zoom];
    interval.replaceChildren(zoom < set.zooms[0] ? WORDS.closer : step === undefined ? "" : WORDS.every(step, set.unit));
  };

  if (contours.length === 1) {
    const line = switchFor(WORDS.contours, true, (isOn) => apply((state.contours = isOn ? contours[0] : undefined)));
    line.append(interval);
    panel.append(line);
  } else if (contours.length > 1) {
    const options = [["", WORDS.none], ...contours.map((set, k) => [String(k), set.name])];
    panel.append(choice(WORDS.contours, options, "0", (k) => apply((state.contours = contours[k]))), interval);
  }
  if (contours.length) panel.append(switchFor(WORDS.labels, true, (isOn) => apply((state.labels = isOn))));
  if (terrain.length > 1) {
    const options = terrain.map((set, k) => [String(k), set.name]);
    panel.append(choice(WORDS.height, options, "0", (k) => apply((state.terrain = terrain[k]))));
  }
  if (terrain.length) {
    panel.append(switchFor(WORDS.hillshade, true, (isOn) => apply((state.shade = isOn))));
    panel.append(
      switchFor(WORDS.relief, false, (isOn) => {
        apply((state.relief = isOn));
        slider.hidden = !isOn;
        map.easeTo({ pitch: isOn ? 60 : 0 });
      }),
    );
    const range = element("input", { type: "range", min: "1", max: "5", step: "0.5", value: "1" });
    const times = element("span", {}, "1");
    const slider = element("label", { hidden: true }, element("span", {}, `${WORDS.exaggeration} `), times, range);
    range.addEventListener("input", () => {
      times.textContent = range.value;
      apply((state.times = Number(range.value)));
    });
    panel.append(slider);
  }
  const units = [["m", WORDS.metres], ["ft", WORDS.feet]];
  panel.append(choice(WORDS.unit, units, state.unit, (unit) => apply((state.unit = unit))), readout);
  const licences = document.getElementById("licences").textContent;
  const more = element("details", {}, element("summary", {}, WORDS.licences), element("pre", {}, licences));
  panel.append(element("details", { className: "help" }, element("summary", {}, WORDS.help), ...instructions(), more));

  map.addControl(new maplibregl.NavigationControl({ visualizePitch: true }), "top-right");
  map.addControl(scale, "bottom-left");
  map.addControl(new maplibregl.AttributionControl({ compact: false, customAttribution: sources(sets) }), "bottom-right");
  map.on("zoom", describe);
  followPointer(map, state, terrain, readout);
  apply();
  return panel;
}

// The sources that the sets name, each once. Metadata may hold HTML; only its text is shown.
function sources(sets) {
  const texts = sets.map((set) => set.about.attribution).filter((text) => typeof text === "string");
  const plain = texts.map((text) => {
    const parsed = new DOMParser().parseFromString(text, "text/html");
    parsed.querySelectorAll("script, style").forEach((part) => part.remove());
    return parsed.body.textContent.trim();
  });
  const named = [...new Set(plain.filter(Boolean))].map((text) => element("span", {}, WORDS.source + text).innerHTML);
  return [...named, "MapLibre"];
}

// Shows the height under the pointer, or without heights the contour.
function followPointer(map, state, terrain, readout) {
  const readers = new Map(terrain.map((set) => [set, heightReader(set)]));
  let last = 0;
  const show = async ({ lngLat, point }) => {
    const call = ++last;
    let text = "";
    if (state.terrain) {
      const height = await readers.get(state.terrain)(lngLat).catch(() => null);
      text = `${WORDS.height} ${height === null ? `– (${WORDS.noHeight})` : inUnit(height, state.unit)}`;
    } else if (state.contours) {
      const box = [[point.x - 4, point.y - 4], [point.x + 4, point.y + 4]];
      const [line] = map.queryRenderedFeatures(box, { layers: [`${state.contours.id} lines`] });
      if (line) text = `${WORDS.contour} ${line.properties.label} ${state.contours.unit}`;
    }
    // A later place may be known earlier.
    if (call === last) readout.value = text;
  };
  map.on("mousemove", show);
  map.on("click", show);
}
