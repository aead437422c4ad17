"use strict";
// The legend: values at the present time. A click hides or shows a curve, a double click isolates it.

class Legend {
  constructor(host, charts, selection) {
    Object.assign(this, { host, charts, selection, cells: [], rows: [] });
    const table = element("table");
    const head = table.createTHead().insertRow();
    head.append(element("th", "curve"));
    this.columns = charts.map((chart) => {
      const unit = this.unitOf(chart);
      const cell = element("th", unit ? `${chart.symbol} [${unit}]` : chart.symbol);
      cell.title = chart.title;
      head.append(cell);
      return cell;
    });
    for (const cell of head.cells) cell.scope = "col";
    this.body = table.createTBody();
    const labels = [...new Set(selection.groups.flatMap((group) => group.labels)), ...selection.free];
    for (const label of labels) this.addRow(label);
    host.append(table);
    this.refresh();
  }

  // The unit that all curves of a chart share; it stands in the head of the column then.
  unitOf(chart) {
    const own = this.selection.groups.filter((group) => !group.root).flatMap((group) => group.labels).concat(this.selection.free);
    const units = new Set(chart.series.filter((s) => own.includes(s.label)).map((s) => s.unit));
    return units.size === 1 ? [...units][0] : "";
  }

  addRow(label) {
    const { selection } = this;
    const row = this.body.insertRow();
    const head = element("th");
    head.scope = "row";
    const name = button("", "Click to hide or show, double click to isolate", true, () => selection.toggle(label));
    name.append(this.swatch(label), element("span", label));
    name.addEventListener("dblclick", () => {
      // Two clicks have hidden and shown it.
      selection.isolate(label);
    });
    head.append(name);
    row.append(head);
    for (const chart of this.charts) {
      const cell = row.insertCell();
      const series = chart.series.findIndex((s) => s.label === label);
      if (series < 0) continue;
      const number = element("span");
      const { unit } = chart.series[series];
      cell.append(number);
      if (unit !== this.unitOf(chart)) cell.append(" ", element("small", unit));
      this.cells.push({ cell, number, chart, series, row });
    }
    row.addEventListener("pointerenter", () => selection.set({ marked: label }));
    row.addEventListener("pointerleave", () => selection.set({ marked: null }));
    this.rows.push({ row, label, name });
  }

  // A short piece of the curve with its colour and dash.
  swatch(label) {
    const { color, dash } = this.selection.look(label, 0);
    const space = "http://www.w3.org/2000/svg";
    const drawing = document.createElementNS(space, "svg");
    const line = document.createElementNS(space, "line");
    Object.entries({ width: 26, height: 8, "aria-hidden": "true" }).forEach(([name, value]) => drawing.setAttribute(name, value));
    const marks = { x1: 0, y1: 4, x2: 26, y2: 4, stroke: color, "stroke-width": 2.2 };
    if (this.selection.runs.length === 1) marks["stroke-dasharray"] = dash.join(" ");
    Object.entries(marks).forEach(([name, value]) => line.setAttribute(name, value));
    drawing.append(line);
    return drawing;
  }

  // Rows of the selected group only, so that the legend stays short.
  refresh() {
    const { selection } = this;
    for (const { row, label, name } of this.rows) {
      const shown = selection.isolated === label || (selection.isolated === null && selection.inGroup(label));
      row.hidden = !shown;
      row.classList.toggle("off", selection.hidden.has(label));
      row.classList.toggle("marked", selection.marked === label);
      name.firstChild.replaceWith(this.swatch(label));
      name.setAttribute("aria-pressed", String(!selection.hidden.has(label)));
    }
    this.columns.forEach((column, k) => {
      const used = this.cells.some(({ chart, row }) => chart === this.charts[k] && !row.hidden);
      column.hidden = !used;
      for (const { row } of this.rows) row.cells[k + 1].hidden = !used;
    });
    if (this.time !== undefined) this.setTime(this.time);
  }

  setTime(t) {
    this.time = t;
    const { run } = this.selection;
    for (const { cell, number, chart, series, row } of this.cells) {
      if (row.hidden) continue;
      const value = valueAt(chart.runs[run], series, t);
      cell.style.visibility = value === null ? "hidden" : "";
      const text = valueText(value);
      if (number.textContent !== text) number.textContent = text;
    }
  }

  // The values of the shown rows in words.
  spoken() {
    const shown = this.rows.filter(({ row }) => !row.hidden && !row.classList.contains("off")).slice(0, 8);
    return shown.map(({ row, label }) => {
      const own = this.cells.filter((one) => one.row === row && one.number.textContent);
      return `${label} ${own.map(({ chart, number, series }) => `${chart.symbol} ${number.textContent} ${chart.series[series].unit}`).join(", ")}`;
    }).join("; ");
  }
}
