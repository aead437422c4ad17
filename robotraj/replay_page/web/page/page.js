"use strict";
// The start: unpack the data, make the parts and join them.

function addMarks(view, runs) {
  const add = (sign, color, text) => {
    const item = element("li");
    const icon = element("em", sign);
    icon.setAttribute("aria-hidden", "true");
    icon.style.color = color;
    item.append(icon, text);
    byId("marks").append(item);
  };
  if (runs.length > 1) runs.forEach((run) => add("●", run.tint, run.label));
  const drawnPaths = new Set();
  for (const { trace } of view.traces) {
    if (runs.length === 1 && !drawnPaths.has(trace.frame)) add("━", `rgb(${trace.color})`, `path of ${trace.frame}`);
    drawnPaths.add(trace.frame);
  }
  for (const mark of (view.contacts.find(Boolean) || { marks: () => [] }).marks()) add(...mark);
}

async function makeView(runs, theme) {
  const packets = await unpack("commands");
  try {
    return new View(byId("pane"), runs, packets, theme);
  } catch (error) {
    showFailure(`The 3D view needs WebGL, which this browser does not offer here (${error.message}).`);
    return null;
  }
}

// The solution in focus, and how several are set beside each other.
function addSolutions(host, selection, view) {
  host.hidden = selection.runs.length < 2;
  if (host.hidden) return;
  const chips = selection.runs.map((run, k) => {
    const chip = button(run.label, `Bars, values and panels of ${run.label} (${k + 1})`, k === 0, () => selection.set({ run: k }));
    chip.prepend(element("i"));
    chip.firstChild.style.background = run.tint;
    return chip;
  });
  host.append(...chips);
  selection.listen(() => chips.forEach((chip, k) => chip.setAttribute("aria-pressed", String(k === selection.run))));
  if (!view) return;
  const apart = button("side by side", "Set the robots side by side, or one in the other", false, () => {
    view.setApart(!view.apart);
    view.camera.home();
    apart.setAttribute("aria-pressed", String(view.apart));
  });
  byId("layers").append(apart);
}

async function start() {
  if (typeof DecompressionStream === "undefined") {
    showFailure("This page needs a browser with DecompressionStream: Chrome 80, Firefox 113, Safari 16.4 or newer.");
    return;
  }
  const data = JSON.parse(new TextDecoder().decode(await unpack("data")));
  const { runs } = data;
  const parts = { charts: [] };
  const theme = new Theme(() => parts.redraw && parts.redraw());
  const selection = new CurveSelection(runs, data.palette);
  const view = runs.some((run) => run.scene) ? await makeView(runs, theme) : null;
  const seek = (t, held) => player.drag(t, held);
  const charts = mergedCharts(runs).map((chart) => new Chart(byId("charts"), chart, selection, theme, seek));
  const bars = new Bars(byId("bars"), selection, seek);
  const legend = new Legend(byId("legend"), charts.map((chart) => chart.data), selection);
  const follow = (t) => {
    charts.forEach((chart) => chart.setTime(t));
    legend.setTime(t);
    bars.setTime(t);
    if (view) view.seek(t);
  };
  const player = new Player(selection, data.speed, follow, () => legend.spoken());
  const groups = new Groups(byId("groups"), selection, () => player.now);
  const tabs = new Tabs(byId("tabs"), byId("side"));
  const stop = (t) => (player.play(false), player.seek(t));
  tabs.add("curves", "Curves", byId("curves"));
  const proof = new ProofPanel(tabs.add("proof", "Proof"), stop);
  const meshes = new MeshPanel(tabs.add("meshes", "Meshes"), theme);
  const [problem, settings] = [tabs.add("problem", "Problem"), tabs.add("settings", "Settings")];
  const fillPanels = () => {
    const run = runs[selection.run];
    proof.fill(run.proof, run.status);
    if (runs.length > 1) {
      byId("status").textContent = `${run.label}: ${run.status.text}`;
      byId("status").className = `status ${run.status.colour}`;
    }
    meshes.fill(run.proof);
    problem.replaceChildren(Object.assign(element("pre", run.proof.problem), { tabIndex: 0 }));
    settings.replaceChildren(settingsTable(run.proof.settings));
  };
  fillPanels();
  tabs.show(0);
  if (view) {
    addMarks(view, runs);
    new Layers(byId("layers"), view, runs);
    new Picker(view, selection, byId("marks"));
    byId("home").addEventListener("click", () => view.camera.home());
    byId("follow").hidden = !view.camera.body;
    byId("follow").addEventListener("click", () => view.camera.follow(view.camera.followed === null));
  }
  addSolutions(byId("solutions"), selection, view);
  parts.redraw = () => {
    charts.forEach((chart) => chart.draw());
    meshes.redraw();
    if (view) view.recolor();
  };
  selection.listen((changes) => {
    charts.forEach((chart) => chart.draw());
    legend.refresh();
    if (Object.keys(changes).join() === "marked") return;
    groups.refresh();
    bars.refresh();
    if ("run" in changes) fillPanels();
  });
  const link = new Link(player, selection, tabs, view);
  const exports = new Exports(byId("saving"), { view, charts, player, link: () => link.write() });
  const step = (share) => player.seek(player.now + share * (player.end - player.start));
  new Keyboard({
    " ": () => player.play(!player.playing),
    k: () => player.play(!player.playing),
    ArrowRight: (event) => step(event.shiftKey ? 0.1 : 0.01),
    ArrowLeft: (event) => step(event.shiftKey ? -0.1 : -0.01),
    ".": () => player.seek(player.now + 1 / 30),
    ",": () => player.seek(player.now - 1 / 30),
    Home: () => player.seek(player.start),
    End: () => player.seek(player.end),
    g: () => groups.step(1),
    G: () => groups.step(-1),
    o: () => groups.toggleOthers(),
    "+": () => groups.zoom(2),
    "=": () => groups.zoom(2),
    "-": () => groups.zoom(0.5),
    0: () => selection.show(...selection.full),
    Escape: () => (exports.open(false), selection.set({ isolated: null, marked: null })),
    r: () => view && view.camera.home(),
    f: () => view && view.camera.follow(view.camera.followed === null),
    p: () => tabs.step(1),
    d: () => theme.next(),
    ...Object.fromEntries(runs.map((_, k) => [String(k + 1), () => selection.set({ run: k })])),
  });
  player.show();
  player.run(() => view && view.draw());
  window.robotraj = {
    seek: stop,
    time: () => player.now,
    poses: (solution = 1) => (view ? view.poses(solution - 1) : {}),
    view,
    viewer: view && view.viewer,
    player,
    selection,
    charts,
    exports,
    link,
  };
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (!link.read()) player.play(!still);
}

start();
