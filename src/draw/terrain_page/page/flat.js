// The flat picture, for browsers that cannot draw in space.

function drawFlat(canvas, data, units) {
  const { ground } = data;
  const { cols, rows, heights, cell } = ground;
  Object.assign(canvas, { width: cols, height: rows });
  const context = canvas.getContext("2d");
  const picture = context.createImageData(cols, rows);
  const mode = data.differences ? "byDifference" : "byHeight";
  const [values, [low, high]] = [data.differences ?? heights, rangeOf(mode, data)];
  for (let k = 0; k < heights.length; k++) {
    if (Number.isNaN(heights[k])) continue;
    const off = (n, m) => (Number.isNaN(heights[n] ?? NaN) || Number.isNaN(heights[m] ?? NaN) ? 0 : (heights[n] - heights[m]) / (2 * cell));
    const [east, north] = [off(k + 1, k - 1), off(k - cols, k + cols)];
    const light = (0.5 * east - 0.5 * north + Math.SQRT1_2) / Math.hypot(east, north, 1);
    const colour = data.water?.[k] > 0 ? parts(WATER) : Number.isNaN(values[k]) ? parts(UNKNOWN) : colourAt(RAMPS[mode], (values[k] - low) / (high - low || 1));
    picture.data.set([...colour.map((part) => Math.min(part * (0.42 + 0.72 * Math.max(light, 0)), 255)), 255], 4 * k);
  }
  context.putImageData(picture, 0, 0);
  for (const [name, lines] of Object.entries(data.lines)) {
    Object.assign(context, { strokeStyle: LINES[name].colour, globalAlpha: 0.8 });
    for (const { isIndex, points } of lines) {
      context.lineWidth = (isIndex ? 1.6 : 0.8) * Math.max(1, cols / 1000);
      context.beginPath();
      for (let k = 0; k < points.length; k += 3) context.lineTo((points[k] - ground.x) / cell + 0.5, (ground.y - points[k + 1]) / cell + 0.5);
      context.stroke();
    }
  }
  document.body.classList.add("flat");
  document.body.append(element("aside", { className: "panel", role: "status" }, element("h1", {}, data.title), element("p", {}, WORDS.flat), legendOf(mode, data, units)));
}
