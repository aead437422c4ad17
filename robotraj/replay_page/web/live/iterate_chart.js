"use strict";
// Curves of one iterate of a system, without a robot: a chart of its states, of its controls, of its other variables.

class IterateChart {
  constructor(host, title, theme, palette) {
    Object.assign(this, { title, theme, palette, curves: [] });
    this.legend = element("span", undefined, "labels");
    const head = element("h2", title);
    this.canvas = element("canvas");
    this.canvas.setAttribute("role", "img");
    head.append(" ", this.legend);
    host.append(head, this.canvas);
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  // Take the curves of an iterate; a variable of several phases has one curve in each.
  take(curves) {
    this.curves = curves;
    const labels = [...new Set(curves.map(({ label, unit }) => (unit ? `${label} [${unit}]` : label)))];
    this.names = [...new Set(curves.map(({ label }) => label))];
    if (labels.join() === this.shown) return;
    this.shown = labels.join();
    this.canvas.setAttribute("aria-label", `${this.title} of the present iterate over time: ${labels.join(", ")}`);
    this.legend.replaceChildren(
      ...labels.map((label, k) => {
        const item = element("span", label);
        item.style.setProperty("--own", this.palette[k % this.palette.length]);
        return item;
      }),
    );
  }

  // The lowest and highest number, with a margin.
  static range(lists, pad) {
    let [low, high] = [Infinity, -Infinity];
    for (const list of lists) for (const value of list) if (value !== null) [low, high] = [Math.min(low, value), Math.max(high, value)];
    if (!(low <= high)) return [0, 1];
    const margin = Math.max(pad * (high - low), 1e-6 * Math.max(1, Math.abs(low), Math.abs(high)));
    return [low - margin, high + margin];
  }

  draw() {
    const { canvas, theme, curves } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width < 80 || height < 40 || !curves.length) return;
    const pen = penOf(canvas, width, height);
    const frame = { x0: 62, x1: width - 8, y0: height - 18, y1: 6 };
    const [from, to] = IterateChart.range(curves.map(({ t }) => t), 0);
    const [low, high] = IterateChart.range(curves.map(({ y }) => y), 0.07);
    const x = (t) => frame.x0 + ((t - from) / (to - from)) * (frame.x1 - frame.x0);
    const y = (value) => frame.y0 - ((value - low) / (high - low)) * (frame.y0 - frame.y1);
    pen.font = "11px system-ui, sans-serif";
    [pen.textAlign, pen.textBaseline, pen.fillStyle] = ["right", "middle", theme.soft];
    for (const [value, text] of ticks(low, high, (frame.y0 - frame.y1) / 34)) {
      pen.fillText(text, frame.x0 - 6, y(value));
      drawLine(pen, frame.x0, y(value), frame.x1, y(value), Math.abs(value) < 1e-12 ? theme.zero : theme.grid);
    }
    [pen.textAlign, pen.textBaseline] = ["center", "top"];
    ticks(from, to, (frame.x1 - frame.x0) / 90).forEach(([value, text], k) => pen.fillText(k ? text : `${text} s`, x(value), frame.y0 + 4));
    pen.lineWidth = 1.8;
    for (const curve of curves) {
      const k = this.names.indexOf(curve.label);
      pen.strokeStyle = this.palette[k % this.palette.length];
      pen.setLineDash(DASHES[k % DASHES.length]);
      pen.beginPath();
      curve.y.forEach((value, i) => value !== null && pen[i ? "lineTo" : "moveTo"](x(curve.t[i]), y(value)));
      pen.stroke();
    }
    pen.setLineDash([]);
  }
}

// The charts of the present iterate, made when the first one arrives.
class IterateCharts {
  constructor(host, theme, palette) {
    Object.assign(this, { host, theme, palette, charts: new Map() });
  }

  take({ charts }) {
    for (const { title, curves } of charts) {
      if (!this.charts.has(title)) this.charts.set(title, new IterateChart(this.host, title, this.theme, this.palette));
      this.charts.get(title).take(curves);
    }
    this.draw();
  }

  draw() {
    for (const chart of this.charts.values()) chart.draw();
  }
}
