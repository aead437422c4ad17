"use strict";
// Curves with limits and a time cursor. Canvas only.

const MARGIN = { left: 68, right: 10, top: 6, bottom: 20 };

function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((f) => f * power).find((s) => s >= rough * 0.999);
  const list = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) list.push(k * step);
  const digits = Math.max(0, Math.min(8, -Math.floor(Math.log10(step) + 1e-9) + (step / power === 2.5 ? 1 : 0)));
  return list.map((value) => [value, (Math.abs(value) < 1e-12 * step ? 0 : value).toFixed(digits)]);
}

function valueAt(chart, series, t) {
  for (let k = chart.pieces.length - 1; k >= 0; k--) {
    const { t: times, of, y } = chart.pieces[k];
    const row = of.indexOf(series);
    if (row < 0 || t < times[0] - 1e-9 || t > times[times.length - 1] + 1e-9) continue;
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle;
      else high = middle;
    }
    const share = times[high] > times[low] ? Math.min(1, Math.max(0, (t - times[low]) / (times[high] - times[low]))) : 1;
    const [a, b] = [y[row][low], y[row][high]];
    return a === null || b === null ? null : share === 0 ? a : a + share * (b - a);
  }
  return null;
}

class Chart {
  constructor(host, data, { phases, impacts, proof }, state, onSeek) {
    Object.assign(this, { data, phases, impacts, violations: proof.violations, state, fit: false });
    // Limits far from the curves would compress them, so they are shown on demand. Zero curves need no limits.
    const all = this.range();
    this.fit = true;
    const own = this.range();
    const share = (own[1] - own[0]) / (all[1] - all[0]);
    this.fit = share > 1e-4 && share < 0.3;
    this.tints = tints(phases);
    this.start = phases[0].start;
    this.end = phases[phases.length - 1].end;
    const units = [...new Set(data.series.map((s) => s.unit).filter(Boolean))].join(", ");
    this.root = document.createElement("div");
    this.root.className = "chart";
    this.root.innerHTML = '<h2><div></div></h2><div class="plot"><canvas></canvas><div class="cursor"></div></div>';
    const name = this.root.querySelector("h2 div");
    name.textContent = data.title;
    if (units) name.append(" ", Object.assign(document.createElement("span"), { textContent: `[${units}]` }));
    if (data.pieces.some((p) => [...p.lower, ...p.upper].some((x) => x !== null))) this.addLimitButton();
    this.plot = this.root.querySelector(".plot");
    this.canvas = this.root.querySelector("canvas");
    this.cursor = this.root.querySelector(".cursor");
    host.append(this.root);
    this.listen(onSeek);
    new ResizeObserver(() => this.draw()).observe(this.plot);
  }

  addLimitButton() {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: "limits", title: "Show the limits, or fit the curves" });
    button.setAttribute("aria-pressed", String(!this.fit));
    button.addEventListener("click", () => {
      this.fit = !this.fit;
      button.setAttribute("aria-pressed", String(!this.fit));
      this.draw();
    });
    this.root.querySelector("h2").append(button);
  }

  listen(onSeek) {
    const move = (event) => {
      const box = this.plot.getBoundingClientRect();
      const share = (event.clientX - box.left - MARGIN.left) / (box.width - MARGIN.left - MARGIN.right);
      onSeek(this.start + Math.min(1, Math.max(0, share)) * (this.end - this.start));
    };
    this.plot.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.plot.setPointerCapture(event.pointerId);
      this.dragging = true;
      this.state.hold(true);
      move(event);
    });
    this.plot.addEventListener("pointermove", (event) => this.dragging && move(event));
    for (const kind of ["pointerup", "pointercancel"]) {
      this.plot.addEventListener(kind, () => {
        if (this.dragging) this.state.hold(false);
        this.dragging = false;
      });
    }
  }

  shown(series) {
    return !this.state.hidden.has(this.data.series[series].label);
  }

  color(series) {
    return this.state.colors.get(this.data.series[series].label);
  }

  range() {
    let [low, high] = [Infinity, -Infinity];
    const take = (value) => {
      if (value === null) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    };
    for (const piece of this.data.pieces) {
      piece.of.forEach((series, row) => {
        if (!this.shown(series)) return;
        piece.y[row].forEach(take);
        if (!this.fit) [piece.lower[row], piece.upper[row]].forEach(take);
      });
    }
    if (!(low <= high)) return [-1, 1];
    const least = 1e-6 * Math.max(1, Math.abs(low), Math.abs(high));
    const pad = Math.max(0.07 * (high - low), least);
    return [low - pad, high + pad];
  }

  draw() {
    const [width, height] = [this.plot.clientWidth, this.plot.clientHeight];
    if (width < 80 || height < 40) return;
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const pen = this.canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const frame = { x0: MARGIN.left, x1: width - MARGIN.right, y0: height - MARGIN.bottom, y1: MARGIN.top };
    const [low, high] = this.range();
    const span = Math.max(this.end - this.start, 1e-12);
    this.x = (t) => frame.x0 + ((t - this.start) / span) * (frame.x1 - frame.x0);
    this.y = (value) => frame.y0 - ((value - low) / (high - low)) * (frame.y0 - frame.y1);
    this.drawBands(pen, frame);
    this.drawAxes(pen, frame, low, high);
    pen.save();
    pen.beginPath();
    pen.rect(frame.x0, frame.y1 - 1, frame.x1 - frame.x0, frame.y0 - frame.y1 + 2);
    pen.clip();
    this.drawLimits(pen);
    this.drawCurves(pen);
    this.drawViolations(pen);
    pen.restore();
    this.drawImpacts(pen, frame);
    this.drawKnots(pen, frame);
    this.setTime(this.time ?? this.start);
  }

  drawBands(pen, frame) {
    if (this.phases.length < 2) return;
    this.phases.forEach((phase, k) => {
      const [a, b] = [this.x(phase.start), this.x(phase.end)];
      pen.fillStyle = this.tints[k][0];
      pen.globalAlpha = 0.65;
      pen.fillRect(a, frame.y1, b - a, frame.y0 - frame.y1);
    });
    pen.globalAlpha = 1;
  }

  // Knots of the mesh as ticks on the time axis, unless they are too dense.
  drawKnots(pen, frame) {
    pen.strokeStyle = "#8894a2";
    pen.lineWidth = 1;
    for (const { knots } of this.phases) {
      if (knots.length * 3 > this.x(knots[knots.length - 1]) - this.x(knots[0])) continue;
      for (const t of knots) {
        pen.beginPath();
        pen.moveTo(this.x(t), frame.y0);
        pen.lineTo(this.x(t), frame.y0 - 4);
        pen.stroke();
      }
    }
  }

  // Violated rows: a red ring on the curve of the variable that a row bounds.
  drawViolations(pen) {
    pen.strokeStyle = "#c8201a";
    pen.lineWidth = 2;
    for (const { t, variable } of this.violations) {
      const series = this.data.series.findIndex((s) => s.variable === variable);
      if (series < 0 || !this.shown(series) || t === null) continue;
      const value = valueAt(this.data, series, t);
      if (value === null) continue;
      pen.beginPath();
      pen.arc(this.x(t), this.y(value), 5, 0, 2 * Math.PI);
      pen.stroke();
    }
  }

  // Impacts as dotted lines.
  drawImpacts(pen, frame) {
    pen.strokeStyle = "#6a1fb0";
    pen.lineWidth = 1.2;
    pen.setLineDash([2, 3]);
    for (const t of this.impacts) {
      pen.beginPath();
      pen.moveTo(this.x(t), frame.y1);
      pen.lineTo(this.x(t), frame.y0);
      pen.stroke();
    }
    pen.setLineDash([]);
  }

  drawAxes(pen, frame, low, high) {
    pen.font = "11px system-ui, sans-serif";
    pen.lineWidth = 1;
    pen.fillStyle = "#5a6675";
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const [value, text] of ticks(low, high, Math.max(2, (frame.y0 - frame.y1) / 32))) {
      const y = Math.round(this.y(value)) + 0.5;
      pen.strokeStyle = value === 0 ? "#b3bdc8" : "#e4e9ee";
      pen.beginPath();
      pen.moveTo(frame.x0, y);
      pen.lineTo(frame.x1, y);
      pen.stroke();
      pen.fillText(text.replace("-", "−"), frame.x0 - 7, y);
    }
    pen.textBaseline = "top";
    for (const [value, text] of ticks(this.start, this.end, Math.max(2, (frame.x1 - frame.x0) / 80))) {
      const x = Math.round(this.x(value)) + 0.5;
      pen.strokeStyle = "#e4e9ee";
      pen.beginPath();
      pen.moveTo(x, frame.y1);
      pen.lineTo(x, frame.y0);
      pen.stroke();
      const last = x > frame.x1 - 14;
      pen.textAlign = last ? "right" : "center";
      pen.fillText(text.replace("-", "−") + (value === 0 || last ? " s" : ""), last ? frame.x1 + 6 : x, frame.y0 + 5);
    }
  }

  // Limits that several curves share are drawn once, in grey; a curve's own limit has its colour. Many are drawn
  // faint; pointing at a name in the legend brings out its own.
  drawLimits(pen) {
    const { marked } = this.state;
    const many = this.data.series.filter((_, series) => this.shown(series)).length > 8;
    for (const piece of this.data.pieces) {
      const lines = new Map();
      piece.of.forEach((series, row) => {
        if (!this.shown(series)) return;
        const mine = marked === this.data.series[series].label;
        for (const value of [piece.lower[row], piece.upper[row]]) {
          if (value === null || (lines.has(value) && lines.get(value).mine)) continue;
          lines.set(value, { mine, color: lines.has(value) && !mine ? "#6b7684" : this.color(series) });
        }
      });
      const [a, b] = [this.x(piece.t[0]), this.x(piece.t[piece.t.length - 1])];
      pen.setLineDash([6, 4]);
      for (const [value, { mine, color }] of lines) {
        pen.globalAlpha = mine ? 1 : marked ? 0.18 : many ? 0.35 : 1;
        pen.lineWidth = mine ? 2 : many ? 1 : 1.4;
        pen.strokeStyle = color;
        pen.beginPath();
        pen.moveTo(a, this.y(value));
        pen.lineTo(b, this.y(value));
        pen.stroke();
      }
      pen.setLineDash([]);
      pen.globalAlpha = 1;
    }
  }

  drawCurves(pen) {
    pen.lineJoin = "round";
    for (const piece of this.data.pieces) {
      piece.of.forEach((series, row) => {
        if (!this.shown(series)) return;
        const marked = this.state.marked;
        const mine = marked === this.data.series[series].label;
        pen.globalAlpha = marked && !mine ? 0.22 : 1;
        pen.lineWidth = mine ? 2.6 : 1.7;
        pen.strokeStyle = this.color(series);
        pen.beginPath();
        let gap = true;
        piece.y[row].forEach((value, k) => {
          if (value !== null) pen[gap ? "moveTo" : "lineTo"](this.x(piece.t[k]), this.y(value));
          gap = value === null;
        });
        pen.stroke();
      });
    }
    pen.globalAlpha = 1;
  }

  setTime(t) {
    this.time = t;
    if (this.x) this.cursor.style.transform = `translateX(${this.x(t) - 0.75}px)`;
  }
}
