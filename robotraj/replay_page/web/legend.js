"use strict";
// Colours of curves, and the legend: values at the present time; a click hides or shows a curve.

const PALETTE = ["#1f6fc4", "#d9541e", "#2a8f4f", "#9a3fb5", "#c08a00", "#118f9e", "#c2335f", "#6b5a46", "#5560d8", "#7a8a12"];

// Whether two colours, #rrggbb and rgb(r, g, b), are hard to tell apart.
function alike(hex, rgb) {
  const one = [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const two = rgb.match(/\d+/g).map(Number);
  return Math.hypot(...one.map((x, k) => x - two[k])) < 55;
}

class Legend {
  constructor(host, charts, state, redraw) {
    this.cells = [];
    this.charts = charts;
    // What starts hidden comes last.
    const labels = [...state.colors.keys()].sort((a, b) => state.hidden.has(a) - state.hidden.has(b));
    const table = document.createElement("table");
    const head = table.createTHead().insertRow();
    const title = (text) => head.append(Object.assign(document.createElement("th"), { textContent: text }));
    title("");
    charts.forEach((chart) => title(chart.symbol));
    const body = table.createTBody();
    for (const label of labels) {
      const row = body.insertRow();
      row.title = "Click to hide or show";
      row.classList.toggle("off", state.hidden.has(label));
      const swatch = document.createElement("i");
      swatch.style.background = state.colors.get(label);
      row.insertCell().append(swatch, label);
      for (const chart of charts) {
        const cell = row.insertCell();
        const series = chart.series.findIndex((s) => s.label === label);
        if (series < 0) continue;
        const number = document.createElement("span");
        cell.append(number, " ", Object.assign(document.createElement("small"), { textContent: chart.series[series].unit }));
        this.cells.push({ cell, number, chart, series });
      }
      row.addEventListener("click", () => {
        state.hidden[state.hidden.has(label) ? "delete" : "add"](label);
        row.classList.toggle("off", state.hidden.has(label));
        redraw();
      });
      const mark = (value) => () => {
        state.marked = value;
        redraw();
      };
      row.addEventListener("pointerenter", mark(label));
      row.addEventListener("pointerleave", mark(null));
    }
    host.append(table);
  }

  setTime(t) {
    for (const { cell, number, chart, series } of this.cells) {
      const value = valueAt(chart, series, t);
      cell.style.visibility = value === null ? "hidden" : "";
      const text = value === null ? "" : (Math.abs(value) < 5e-4 ? 0 : value).toFixed(3).replace("-", "−");
      if (number.textContent !== text) number.textContent = text;
    }
  }
}
