// Starts the page.

// The printed area of a sheet of A4, in CSS pixels.
const SHEET = [1040, 712];

function northArrow() {
  const svg = shape("svg", { viewBox: "-20 -20 40 40", "aria-hidden": "true" });
  svg.append(
    shape("path", { d: "M0 -16 L7 12 L0 7 Z", fill: "#222" }),
    shape("path", { d: "M0 -16 L-7 12 L0 7 Z", fill: "#fff", stroke: "#222" }),
  );
  return element("button", { className: "north", type: "button", title: WORDS.north, ariaLabel: WORDS.north }, svg, element("b", {}, "N"));
}

async function start() {
  document.documentElement.lang = LANGUAGE;
  const data = await readData();
  const units = makeUnits(data.unit);
  const canvas = document.getElementById("terrain");
  canvas.setAttribute("aria-label", WORDS.view);
  const view = makeScene(canvas, data);
  if (!view) return drawFlat(canvas, data, units);
  const layer = element("div", { className: "marks" });
  const readout = element("output", { className: "readout" });
  const cross = element("div", { className: "cross", hidden: true });
  const north = northArrow();
  const scale = element("div", { className: "scale" }, element("div"), element("span"));
  const box = element("section", { className: "profile", hidden: true, ariaLabel: WORDS.profile });
  const said = element("p", { className: "finding", hidden: true, role: "status" });
  document.body.append(layer, cross, north, scale, readout, box, said);

  const lines = addLines(view, data);
  const choose = (k) => {
    const { place, message, severity } = data.findings[k];
    Object.assign(said, { hidden: false, textContent: `${k + 1}. ${message}`, className: `finding ${severity}` });
    const height = data.ground.heightAt(...place);
    view.goTo([...place, Number.isNaN(height) ? data.ground.range[0] : height]);
  };
  const marks = makeMarks(view, data, units, layer, choose);
  const profile = makeProfile(view, data, units, box);
  const { panel, legend } = makePanel(view, data, units, { lines, marks, profile, choose });
  const key = element("details", { className: "key-box", open: innerWidth > 640 }, element("summary", {}, WORDS.legend), legend);
  document.body.append(panel, key);
  watch(view, data, units, profile, { canvas, readout, cross, north, scale });
  // On paper, all is as large as the sheet allows, and in the same places.
  addEventListener("beforeprint", () => {
    key.open = true;
    const [width, height] = [innerWidth, innerHeight];
    const scale = Math.min(SHEET[0] / width, SHEET[1] / height);
    Object.entries({ width: `${width}px`, height: `${height}px`, scale }).forEach(([name, value]) => document.body.style.setProperty(`--${name}`, value));
    view.render();
    marks.settle();
  });
  view.resize();
  view.home();
  // For checks of the page.
  window.tokosen = { view, data, profile, marks };
}

start().catch((error) => {
  const box = element("section", { className: "fault", role: "alert" }, element("h2", {}, WORDS.cannot), element("p", {}, String(error?.message ?? error)));
  document.body.append(box);
});
