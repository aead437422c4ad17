"use strict";
// The pointer on a chart: drag to seek, hover for a value, double click to isolate, wheel and pinch to zoom.

const NEAR = 16;

class Pointing {
  constructor(chart, onSeek) {
    Object.assign(this, { chart, onSeek, fingers: new Map(), mode: null });
    const { plot } = chart;
    plot.addEventListener("pointerdown", (event) => this.down(event));
    plot.addEventListener("pointermove", (event) => this.move(event));
    for (const kind of ["pointerup", "pointercancel"]) plot.addEventListener(kind, (event) => this.up(event));
    plot.addEventListener("pointerleave", () => this.clear());
    plot.addEventListener("dblclick", (event) => this.isolate(event));
    plot.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
  }

  at(event) {
    const box = this.chart.plot.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // A plain drag moves the time, one with Shift or along the axis moves the window.
  down(event) {
    if (event.button !== 0 || !this.chart.frame) return;
    const [x, y] = this.at(event);
    this.fingers.set(event.pointerId, x);
    if (event.pointerType !== "touch") this.chart.plot.setPointerCapture(event.pointerId);
    if (this.fingers.size === 2) this.mode = "pinch";
    else this.mode = event.shiftKey || y > this.chart.frame.y0 ? "pan" : "seek";
    this.last = x;
    if (this.mode === "seek") this.onSeek(this.chart.timeAt(x), true);
  }

  move(event) {
    const [x, y] = this.at(event);
    const { chart } = this;
    const seconds = (pixels) => (pixels / (chart.frame.x1 - chart.frame.x0)) * chart.selection.span;
    if (this.mode === null) this.hover(x, y);
    else if (this.mode === "seek") this.onSeek(chart.timeAt(x), true);
    else if (this.mode === "pan") chart.selection.pan(-seconds(x - this.last));
    else if (this.fingers.has(event.pointerId)) {
      const [a, b] = this.fingers.values();
      this.fingers.set(event.pointerId, x);
      const [c, d] = this.fingers.values();
      if (Math.abs(b - a) > 8 && Math.abs(d - c) > 8) chart.selection.zoom(Math.abs(d - c) / Math.abs(b - a), chart.timeAt((c + d) / 2));
      chart.selection.pan(-seconds((c + d - a - b) / 2));
    }
    this.last = x;
  }

  up(event) {
    if (this.mode === "seek") this.onSeek(null, false);
    this.fingers.delete(event.pointerId);
    this.mode = null;
  }

  // The curve nearest to the pointer: {label, unit, value, y, run}; strong curves win over faint ones.
  nearest(x, y) {
    const { chart } = this;
    const t = chart.timeAt(x);
    let best = null;
    for (const { run, piece, row, series } of chart.curves()) {
      if (t < piece.t[0] || t > piece.t[piece.t.length - 1]) continue;
      const value = valueAt([piece], piece.of[row], t);
      if (value === null) continue;
      const off = Math.abs(chart.y(value) - y) + (chart.weight(series) < THIN ? NEAR / 2 : 0);
      if (off < NEAR && (best === null || off < best.off)) best = { ...chart.data.series[series], value, off, run, t };
    }
    return best;
  }

  hover(x, y) {
    const { chart } = this;
    if (!chart.frame || x < chart.frame.x0 || x > chart.frame.x1) return this.clear();
    const found = this.nearest(x, y);
    chart.plot.classList.toggle("near", found !== null);
    chart.hair.hidden = false;
    chart.hair.style.transform = `translateX(${x}px)`;
    const { selection } = chart;
    const time = `${valueText(chart.timeAt(x))} s`;
    const who = found && selection.runs.length > 1 ? `, ${selection.runs[found.run].label}` : "";
    chart.tip.textContent = found ? `${found.label}${who}: ${valueText(found.value)} ${found.unit} at ${time}` : time;
    chart.tip.hidden = false;
    const left = x + chart.tip.offsetWidth + 14 > chart.plot.clientWidth ? x - chart.tip.offsetWidth - 10 : x + 10;
    chart.tip.style.transform = `translate(${Math.max(0, left)}px, ${Math.max(0, y - chart.tip.offsetHeight - 8)}px)`;
    selection.set({ marked: found ? found.label : null });
  }

  clear() {
    this.chart.hair.hidden = true;
    this.chart.tip.hidden = true;
    this.chart.plot.classList.remove("near");
    this.chart.selection.set({ marked: null });
  }

  isolate(event) {
    const { selection } = this.chart;
    const found = this.nearest(...this.at(event));
    if (selection.isolated !== null) selection.set({ isolated: null });
    else if (found) selection.isolate(found.label);
    else selection.show(...selection.full);
  }

  // With Ctrl the wheel zooms, as a pinch on a touchpad does; sideways it moves. Without, the charts scroll.
  wheel(event) {
    const { chart } = this;
    const sideways = Math.abs(event.deltaX) > Math.abs(event.deltaY) ? event.deltaX : event.shiftKey ? event.deltaY : 0;
    if (!event.ctrlKey && sideways === 0) return;
    event.preventDefault();
    if (event.ctrlKey) chart.selection.zoom(Math.exp(-0.004 * event.deltaY), chart.timeAt(this.at(event)[0]));
    else chart.selection.pan((sideways / chart.plot.clientWidth) * chart.selection.span);
  }
}
