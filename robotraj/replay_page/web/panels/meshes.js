"use strict";
// The meshes: a table of every solve, the convergence over them, the earlier stages and the time spent.

const COLUMNS = ["intervals", "points", "error", "objective", "iterations", "seconds"];

class MeshPanel {
  constructor(host, theme) {
    Object.assign(this, { host, theme });
  }

  fill({ meshes, stages, times, goal }) {
    this.last = { meshes, goal };
    this.host.replaceChildren(element("h2", "Meshes"), this.table(meshes));
    const errors = meshes.map((mesh) => mesh.error);
    this.curves = [];
    if (errors.length > 1) {
      this.host.append(element("h2", "Convergence"));
      if (errors.some((error) => error > 0)) this.addCurve("Error between knots, by mesh", errors, goal);
      this.addCurve("Change of the objective to the last mesh", changes(meshes.map((mesh) => mesh.objective)), null);
    }
    if (stages.length) this.host.append(element("h2", "Earlier problems"), ...stages.map((stage) => element("p", stage)));
    if (Object.keys(times).length) this.host.append(element("h2", "Time"), this.timeTable(times));
  }

  table(meshes) {
    const table = element("table");
    const head = table.createTHead().insertRow();
    for (const name of ["mesh", ...COLUMNS]) head.append(Object.assign(element("th", name), { scope: "col" }));
    const body = table.createTBody();
    meshes.forEach((mesh, k) => {
      const row = body.insertRow();
      row.append(Object.assign(element("th", String(k + 1)), { scope: "row" }));
      for (const name of COLUMNS) row.insertCell().textContent = mesh[name] === null ? "–" : scientific(mesh[name]);
    });
    const scroller = Object.assign(element("div", undefined, "scroller"), { tabIndex: 0 });
    scroller.append(table);
    return scroller;
  }

  // Parts of building and solving, each a bar of its share.
  timeTable(times) {
    const table = element("table", undefined, "times");
    const longest = Math.max(...Object.values(times), 1e-12);
    for (const [name, seconds] of Object.entries(times)) {
      const row = table.insertRow();
      row.append(Object.assign(element("th", name), { scope: "row" }));
      row.insertCell().textContent = `${scientific(seconds)} s`;
      const bar = element("span", undefined, "share");
      bar.style.width = `${(100 * seconds) / longest}px`;
      row.insertCell().append(bar);
    }
    return table;
  }

  addCurve(title, values, goal) {
    const known = values.filter((value) => value > 0);
    if (known.length < 2) return;
    const canvas = element("canvas", undefined, "convergence");
    canvas.setAttribute("role", "img");
    const texts = values.map((value) => scientific(value)).join(", ");
    canvas.setAttribute("aria-label", `${title}: ${texts}${goal ? `; goal ${scientific(goal)}` : ""}`);
    this.host.append(element("h3", title), canvas);
    this.curves.push({ canvas, values, goal });
    this.draw(this.curves[this.curves.length - 1]);
  }

  redraw() {
    for (const curve of this.curves || []) this.draw(curve);
  }

  // Logarithmic over the number of the mesh, the goal as a dashed line.
  draw({ canvas, values, goal }) {
    const { theme } = this;
    const [width, height, left, bottom] = [360, 140, 52, 20];
    const pen = penOf(canvas, width, height);
    const logs = values.map((value) => (value > 0 ? Math.log10(value) : null));
    const known = [...logs.filter((log) => log !== null), ...(goal ? [Math.log10(goal)] : [])];
    const [low, high] = [Math.floor(Math.min(...known) - 0.2), Math.ceil(Math.max(...known) + 0.2)];
    const x = (k) => left + 14 + (k / (values.length - 1)) * (width - left - 28);
    const y = (log) => 8 + ((high - log) / (high - low)) * (height - bottom - 12);
    const line = (level) => {
      pen.beginPath();
      pen.moveTo(left, y(level));
      pen.lineTo(width, y(level));
      pen.stroke();
    };
    pen.font = "11px system-ui, sans-serif";
    pen.strokeStyle = theme.grid;
    pen.fillStyle = theme.soft;
    for (let log = low; log <= high; log += Math.max(1, Math.ceil((high - low) / 4))) {
      line(log);
      pen.fillText(minus(`1e${log}`), 8, y(log) + 4);
    }
    values.forEach((_, k) => pen.fillText(String(k + 1), x(k) - 3, height - 4));
    if (goal) {
      pen.setLineDash([6, 4]);
      pen.strokeStyle = theme.good;
      line(Math.log10(goal));
      pen.setLineDash([]);
    }
    [pen.strokeStyle, pen.fillStyle, pen.lineWidth] = [theme.accent, theme.accent, 1.7];
    pen.beginPath();
    logs.forEach((log, k) => log !== null && pen.lineTo(x(k), y(log)));
    pen.stroke();
    logs.forEach((log, k) => log !== null && pen.fillRect(x(k) - 3, y(log) - 3, 6, 6));
  }
}

// The relative difference of each value to the last one.
function changes(values) {
  const last = values[values.length - 1];
  return values.slice(0, -1).map((value) => Math.abs(value - last) / Math.max(Math.abs(last), 1e-12));
}
