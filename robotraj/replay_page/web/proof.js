"use strict";
// The proof: figures with their goals, violated rows that seek to their times, meshes and convergence.

const element = (kind, text, style) => {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  if (style) made.className = style;
  return made;
};
const scientific = (value) => (value === null ? "–" : value !== 0 && Math.abs(value) < 1e-2 ? value.toExponential(1) : String(Number(value.toPrecision(5))));

class Proof {
  constructor(host, data, seek) {
    this.data = data;
    const strip = element("div", undefined, "figures");
    for (const figure of data.figures) {
      const chip = element("span", `${figure.name} `, `figure ${figure.colour}`);
      chip.append(element("b", scientific(figure.value)));
      if (figure.goal) chip.append(` ≤ ${scientific(figure.goal)}`);
      strip.append(chip);
    }
    // The first limit that must give is the largest one.
    for (const conflict of data.conflicts.slice(0, 1)) strip.append(element("span", conflict, "figure bad"));
    const more = element("details");
    more.append(element("summary", "Proof, meshes, convergence, problem"));
    const sheet = element("div", undefined, "sheet");
    this.addViolations(sheet, seek);
    this.addMeshes(sheet);
    this.addText(sheet, "Settings", data.settings);
    this.addText(sheet, "Problem", data.problem);
    more.append(sheet);
    host.append(strip, more);
  }

  section(sheet, title) {
    const section = element("section");
    section.append(element("h3", title));
    sheet.append(section);
    return section;
  }

  addViolations(sheet, seek) {
    const { violations, conflicts, message } = this.data;
    const section = this.section(sheet, "Violated rows");
    if (!violations.length) section.append(element("p", "None."));
    const list = element("ol");
    for (const violation of violations) {
      const button = element("button", violation.text);
      button.type = "button";
      button.title = "Go to this time";
      button.addEventListener("click", () => violation.t !== null && seek(violation.t));
      const item = element("li");
      item.append(button);
      list.append(item);
    }
    section.append(list);
    for (const conflict of conflicts) section.append(element("p", `Must be relaxed: ${conflict}`));
    if (message) section.append(element("p", `Solver: ${message}`));
  }

  addMeshes(sheet) {
    const { meshes, stages, times, goal } = this.data;
    const section = this.section(sheet, "Meshes and convergence");
    for (const stage of stages) section.append(element("p", stage));
    const table = element("table");
    const head = table.createTHead().insertRow();
    const names = ["mesh", "intervals", "points", "error", "objective", "iterations", "seconds"];
    for (const name of names) head.append(element("th", name));
    const body = table.createTBody();
    meshes.forEach((mesh, k) => {
      const row = body.insertRow();
      row.insertCell().textContent = k + 1;
      for (const name of names.slice(1)) row.insertCell().textContent = mesh[name] === null ? "–" : scientific(mesh[name]);
    });
    section.append(table);
    const errors = meshes.map((mesh) => mesh.error);
    if (errors.length > 1 && errors.some((error) => error > 0)) section.append(this.convergence(errors, goal));
    const parts = Object.entries(times).map(([name, seconds]) => `${name} ${scientific(seconds)} s`);
    if (parts.length) section.append(element("p", `Time: ${parts.join(", ")}`));
  }

  // The error of each mesh over its number, logarithmic, with the goal as a dashed line.
  convergence(errors, goal) {
    const [width, height, left, bottom] = [360, 130, 52, 20];
    const canvas = element("canvas");
    const ratio = window.devicePixelRatio || 1;
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    Object.assign(canvas.style, { width: `${width}px`, height: `${height}px` });
    const pen = canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const logs = errors.map((error) => (error > 0 ? Math.log10(error) : null));
    const known = [...logs.filter((log) => log !== null), ...(goal ? [Math.log10(goal)] : [])];
    const [low, high] = [Math.floor(Math.min(...known) - 0.2), Math.ceil(Math.max(...known) + 0.2)];
    const x = (k) => left + 14 + (k / (errors.length - 1)) * (width - left - 28);
    const y = (log) => 8 + ((high - log) / (high - low)) * (height - bottom - 12);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = "#5a6675";
    for (let log = low; log <= high; log += Math.max(1, Math.ceil((high - low) / 4))) {
      pen.strokeStyle = "#e4e9ee";
      pen.strokeRect(left, y(log), width - left, 0);
      pen.fillText(`1e${log}`.replace("-", "−"), 8, y(log) + 4);
    }
    errors.forEach((_, k) => pen.fillText(String(k + 1), x(k) - 3, height - 4));
    if (goal) {
      pen.setLineDash([6, 4]);
      pen.strokeStyle = "#146c3c";
      pen.strokeRect(left, y(Math.log10(goal)), width - left, 0);
      pen.setLineDash([]);
    }
    [pen.strokeStyle, pen.fillStyle, pen.lineWidth] = ["#1f5fbf", "#1f5fbf", 1.7];
    pen.beginPath();
    logs.forEach((log, k) => log !== null && pen.lineTo(x(k), y(log)));
    pen.stroke();
    logs.forEach((log, k) => log !== null && pen.fillRect(x(k) - 3, y(log) - 3, 6, 6));
    return canvas;
  }

  addText(sheet, title, text) {
    if (text) this.section(sheet, title).append(element("pre", text));
  }
}
