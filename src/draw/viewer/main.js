// Starts the page.

async function start() {
  document.documentElement.lang = LANGUAGE;
  if (location.protocol === "file:") return showFaults([WORDS.asFile], document.body);
  const { sets: wanted, title } = JSON.parse(document.getElementById("data").textContent);
  const opened = await Promise.allSettled(wanted.map(openSet));
  const sets = opened.filter((one) => one.status === "fulfilled").map((one) => one.value);
  const faults = opened.filter((one) => one.status === "rejected").map((one) => one.reason.message);
  if (!sets.length) return showFaults(faults, document.body);
  serveSets(sets);
  let map;
  try {
    map = makeMap("map", sets);
  } catch {
    return showFaults([WORDS.noGraphics], document.body);
  }
  map.on("error", ({ error }) => {
    faults.push(error instanceof Fault ? error.message : WORDS.tile(error?.message ?? error));
    showFaults(faults, document.querySelector(".panel") ?? document.body);
  });
  map.once("style.load", () => {
    const panel = makePanel(map, sets, title);
    document.body.append(panel);
    if (faults.length) showFaults(faults, panel);
  });
  // For checks of the page.
  window.tokosen = { map, sets, heightReader };
}

start().catch((error) => showFaults([String(error?.message ?? error)], document.body));
