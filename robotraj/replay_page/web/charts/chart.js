"use strict";
// One chart: its frame, its range of values and its time cursor. drawing.js draws, pointing.js reacts.

const MARGIN = { left: 62, right: 12, top: 7, bottom: 20 };

class Chart {
  constructor(host, data, selection, theme, onSeek) {
    Object.assign(this, { data, selection, theme, fit: false, time: selection.full[0] });
    this.root = element("div", undefined, "chart");
    const head = element("h2");
    const name = element("div", data.title);
    this.units = element("span");
    name.append(" ", this.units);
    head.append(name);
    this.plot = element("div", undefined, "plot");
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    this.cursor = element("div", undefined, "cursor");
    this.hair = element("div", undefined, "hair");
    this.tip = element("div", undefined, "tip");
    this.hair.hidden = this.tip.hidden = true;
    this.plot.append(this.canvas, this.cursor, this.hair, this.tip);
    this.root.append(head, this.plot);
    this.chooseFit();
    if (this.hasLimits()) head.append(this.limitButton());
    host.append(this.root);
    new Pointing(this, onSeek);
    new ResizeObserver(() => this.draw()).observe(this.plot);
  }

  hasLimits() {
    return this.data.runs.flat().some((piece) => [...piece.lower, ...piece.upper].some((x) => x !== null));
  }

  // Limits far from the curves would compress them, so they are shown on demand. Zero curves need no limits.
  chooseFit() {
    const all = this.range(true);
    this.fit = true;
    const own = this.range(true);
    const share = (own[1] - own[0]) / (all[1] - all[0]);
    this.fit = share > 1e-4 && share < 0.3;
  }

  limitButton() {
    const made = button("limits", "Show the limits, or fit the curves", !this.fit, () => {
      this.fit = !this.fit;
      made.setAttribute("aria-pressed", String(!this.fit));
      this.draw();
    });
    return made;
  }

  weight(series) {
    return this.selection.weight(this.data.series[series].label);
  }

  // Every curve that is drawn: [pieces, row, series, number of the solution].
  *curves() {
    for (const [run, pieces] of this.data.runs.entries()) {
      for (const piece of pieces) {
        for (const [row, series] of piece.of.entries()) if (this.weight(series) > ABSENT) yield { run, piece, row, series };
      }
    }
  }

  // The lowest and highest value in the window of time, with a margin; of the whole motion if asked for.
  range(whole) {
    let [low, high] = [Infinity, -Infinity];
    const [from, to] = whole ? this.selection.full : this.selection.window;
    const take = (value) => {
      if (value === null) return;
      if (value < low) low = value;
      if (value > high) high = value;
    };
    for (const { piece, row } of this.curves()) {
      const { t, y } = piece;
      if (t[t.length - 1] < from || t[0] > to) continue;
      for (let k = Math.max(later(t, from) - 1, 0); k < t.length; k++) {
        take(y[row][k]);
        if (t[k] > to) break;
      }
      if (!this.fit) [piece.lower[row], piece.upper[row]].forEach(take);
    }
    if (!(low <= high)) return [-1, 1];
    const least = 1e-6 * Math.max(1, Math.abs(low), Math.abs(high));
    const pad = Math.max(0.07 * (high - low), least);
    return [low - pad, high + pad];
  }

  get empty() {
    return this.curves().next().done;
  }

  draw() {
    this.root.hidden = this.empty;
    const units = new Set(this.data.series.filter((_, k) => this.weight(k) > ABSENT).map((s) => s.unit));
    this.units.textContent = [...units].join("") ? `[${[...units].filter(Boolean).join(", ")}]` : "";
    const [width, height] = [this.plot.clientWidth, this.plot.clientHeight];
    if (width < 80 || height < 40) return;
    this.paint(penOf(this.canvas, width, height), width, height);
    this.setTime(this.time);
    this.canvas.setAttribute("aria-label", this.description());
  }

  // Draw into any pen; also used for pictures.
  paint(pen, width, height) {
    this.frame = { x0: MARGIN.left, x1: width - MARGIN.right, y0: height - MARGIN.bottom, y1: MARGIN.top };
    const { frame, selection } = this;
    [this.low, this.high] = this.range();
    this.x = (t) => frame.x0 + ((t - selection.window[0]) / selection.span) * (frame.x1 - frame.x0);
    this.y = (value) => frame.y0 - ((value - this.low) / (this.high - this.low)) * (frame.y0 - frame.y1);
    drawChart(this, pen, frame);
  }

  timeAt(pixels) {
    const share = (pixels - this.frame.x0) / (this.frame.x1 - this.frame.x0);
    return this.selection.window[0] + Math.min(1, Math.max(0, share)) * this.selection.span;
  }

  // For screen readers: what the chart shows, and the range of each strong curve.
  description() {
    const strong = this.data.series.filter((_, k) => this.weight(k) >= THIN);
    const [from, to] = this.selection.window;
    const parts = strong.slice(0, 12).map((one) => {
      const series = this.data.series.indexOf(one);
      const values = this.data.runs[this.selection.run].flatMap((piece) => {
        const row = piece.of.indexOf(series);
        return row < 0 ? [] : piece.y[row].filter((value) => value !== null);
      });
      const [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
      return values.length ? `${one.label} from ${valueText(low)} to ${valueText(high)} ${one.unit}` : `${one.label} has no values`;
    });
    return `${this.data.title} from ${valueText(from)} to ${valueText(to)} s. ${parts.join("; ")}.`;
  }

  setTime(t) {
    this.time = t;
    if (!this.x) return;
    const [from, to] = this.selection.window;
    this.cursor.hidden = t < from - 1e-9 || t > to + 1e-9;
    this.cursor.style.transform = `translateX(${this.x(t) - 0.75}px)`;
  }
}
