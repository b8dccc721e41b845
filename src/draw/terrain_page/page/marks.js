// Texts and pins over the picture. They are elements of the page: the browser draws their texts, and pins can be pressed.

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// Marks with their places: labels of contours, spot heights, findings. `choose` is called with a finding.
function makeMarks(view, data, units, layer, choose) {
  const { ground } = data;
  const onGround = ([x, y], height) => [x, y, Number.isNaN(ground.heightAt(x, y)) ? height : ground.heightAt(x, y)];
  const make = (kind, place, made, room) => ({ kind, place, element: made, room });
  const decimals = (height) => (Math.abs(height / units.size - Math.round(height / units.size)) < 0.005 ? 0 : 1);
  const marks = [
    ...data.findings.map((finding, k) =>
      finding.place &&
      make("findings", onGround(finding.place, ground.range[0]), element("button", {
        className: `pin ${finding.severity}`, type: "button", textContent: String(k + 1), title: finding.message, onclick: () => choose(k),
      }), 18),
    ),
    ...data.spots.map((spot) =>
      make("spots", onGround(spot, spot[2]), element("span", { className: "spot", textContent: units.number(spot[2] / units.size, 1) }), 34)),
    ...data.labels.map(([x, y, z]) =>
      make("labels", [x, y, z], element("span", { className: "label", textContent: units.number(z / units.size, decimals(z)) }), 64)),
  ].filter(Boolean);
  marks.forEach((mark) => {
    mark.element.hidden = true;
    layer.append(mark.element);
  });
  const shown = { labels: true, spots: true, findings: true };

  // Marks that come first take the room of those that follow.
  const place = () => {
    const taken = new Map();
    const [width, height] = [layer.clientWidth, layer.clientHeight];
    for (const mark of marks) {
      const { x, y, isBefore } = view.pixelOf(mark.place);
      const isInside = isBefore && x > 0 && y > 0 && x < width && y < height;
      const key = `${Math.round(x / mark.room)} ${Math.round(y / (mark.room / 2))} ${mark.room}`;
      const isFree = mark.kind === "findings" || !taken.has(key);
      const level = view.uniforms.levelMode.value === 2 && mark.place[2] > view.uniforms.level.value;
      const is = shown[mark.kind] && isInside && isFree && !level && !view.isHidden(mark.place);
      mark.element.hidden = !is;
      if (!is) continue;
      taken.set(key, true);
      mark.element.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, ${mark.kind === "labels" ? "-50%" : "-100%"})`;
    }
  };
  const settle = () => {
    place();
    layer.classList.remove("moving");
  };
  let timer;
  view.changed.add(() => {
    // While the view moves, marks are out of the way.
    layer.classList.add("moving");
    clearTimeout(timer);
    timer = setTimeout(settle, 90);
  });
  return { shown, settle };
}
