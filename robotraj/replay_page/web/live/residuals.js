"use strict";
// A measure of every iteration as a curve; solves follow one another, separated by lines.

class MeasureChart {
  // With `powers` the axis is logarithmic.
  constructor(canvas, theme, powers) {
    Object.assign(this, { canvas, theme, powers, values: [], starts: [], marked: null });
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  add(value, starts) {
    if (starts) this.starts.push(this.values.length);
    const known = value !== null && Number.isFinite(value) && (!this.powers || value > 0);
    this.values.push(!known ? null : this.powers ? Math.log10(Math.max(value, 1e-16)) : value);
  }

  range() {
    const known = this.values.filter((value) => value !== null);
    if (!known.length) return [0, 1];
    // The last two thirds decide, since first iterates may be far off.
    const late = this.powers ? known : known.slice(Math.floor(known.length / 3));
    const [low, high] = [Math.min(...late), Math.max(...late)];
    const pad = Math.max(0.08 * (high - low), this.powers ? 0.3 : 1e-6 * Math.max(1, Math.abs(high)));
    return [low - pad, high + pad];
  }

  draw() {
    const { canvas, theme } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width < 80 || height < 40) return;
    const pen = penOf(canvas, width, height);
    const frame = { x0: 62, x1: width - 8, y0: height - 18, y1: 6 };
    const [low, high] = this.range();
    const last = Math.max(this.values.length - 1, 1);
    const x = (k) => frame.x0 + (k / last) * (frame.x1 - frame.x0);
    const y = (value) => frame.y0 - ((value - low) / (high - low)) * (frame.y0 - frame.y1);
    pen.font = "11px system-ui, sans-serif";
    [pen.textAlign, pen.textBaseline, pen.lineWidth] = ["right", "middle", 1];
    for (const [value, text] of ticks(low, high, (frame.y0 - frame.y1) / 34)) {
      drawLine(pen, frame.x0, y(value), frame.x1, y(value), theme.grid);
      pen.fillStyle = theme.soft;
      pen.fillText(this.powers ? `1e${minus(String(Math.round(value * 10) / 10))}` : text, frame.x0 - 6, y(value));
    }
    for (const start of this.starts) drawLine(pen, x(start), frame.y1, x(start), frame.y0, theme.zero);
    pen.save();
    pen.beginPath();
    pen.rect(frame.x0, frame.y1, frame.x1 - frame.x0, frame.y0 - frame.y1);
    pen.clip();
    [pen.strokeStyle, pen.lineWidth] = [theme.accent, 1.8];
    pen.beginPath();
    this.values.forEach((value, k) => value !== null && pen[this.starts.includes(k) ? "moveTo" : "lineTo"](x(k), y(value)));
    pen.stroke();
    pen.restore();
    if (this.marked !== null) drawLine(pen, x(this.marked), frame.y1, x(this.marked), frame.y0, theme.ink);
    pen.fillStyle = theme.soft;
    [pen.textAlign, pen.textBaseline] = ["center", "top"];
    for (const [value, text] of ticks(0, last, (frame.x1 - frame.x0) / 90)) pen.fillText(text, x(value), frame.y0 + 4);
  }
}
