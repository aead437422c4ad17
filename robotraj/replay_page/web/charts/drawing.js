"use strict";
// What a chart draws into its canvas: bands of phases, axes, limits, curves, violations, impacts and knots.

const JUMP = 0.01; // least jump that is marked, as a share of the height of a chart
const LINE = { [FAINT]: [1, 0.32], [THIN]: [1.2, 0.9], [STRONG]: [2, 1] };

function drawChart(chart, pen, frame) {
  const { theme, selection } = chart;
  const run = selection.runs[selection.run];
  drawBands(chart, pen, frame, run.phases);
  drawAxes(chart, pen, frame);
  pen.save();
  pen.beginPath();
  pen.rect(frame.x0, frame.y1 - 1, frame.x1 - frame.x0, frame.y0 - frame.y1 + 2);
  pen.clip();
  drawLimits(chart, pen);
  drawCurves(chart, pen);
  drawJumps(chart, pen);
  drawViolations(chart, pen, run);
  drawImpacts(chart, pen, frame, run.impacts);
  drawKnots(chart, pen, frame, run.phases);
  pen.restore();
  pen.strokeStyle = theme.edge;
  pen.lineWidth = 1;
  pen.strokeRect(frame.x0 + 0.5, frame.y1 + 0.5, frame.x1 - frame.x0, frame.y0 - frame.y1);
}

// Phases of one name share a colour.
function phaseColors(phases, palette) {
  const names = [...new Set(phases.map((phase) => phase.name))];
  return phases.map((phase) => palette[names.indexOf(phase.name) % palette.length]);
}

function drawBands(chart, pen, frame, phases) {
  if (phases.length < 2) return;
  const colors = phaseColors(phases, chart.selection.palette);
  pen.globalAlpha = 0.09;
  phases.forEach((phase, k) => {
    const a = Math.max(chart.x(phase.start), frame.x0);
    const b = Math.min(chart.x(phase.end), frame.x1);
    pen.fillStyle = colors[k];
    if (b > a) pen.fillRect(a, frame.y1, b - a, frame.y0 - frame.y1);
  });
  pen.globalAlpha = 1;
}

function drawAxes(chart, pen, frame) {
  const { theme } = chart;
  pen.font = "11px system-ui, sans-serif";
  pen.lineWidth = 1;
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  chart.labels = { y: [], x: [] };
  for (const [value, text] of ticks(chart.low, chart.high, (frame.y0 - frame.y1) / 32)) {
    const y = Math.round(chart.y(value)) + 0.5;
    drawLine(pen, frame.x0, y, frame.x1, y, value === 0 ? theme.zero : theme.grid);
    pen.fillStyle = theme.soft;
    pen.fillText(text, frame.x0 - 6, y);
    chart.labels.y.push(text);
  }
  pen.textBaseline = "top";
  const [from, to] = chart.selection.window;
  const marks = ticks(from, to, (frame.x1 - frame.x0) / 80);
  marks.forEach(([value, text], k) => {
    const x = Math.round(chart.x(value)) + 0.5;
    drawLine(pen, x, frame.y1, x, frame.y0, theme.grid);
    const last = x > frame.x1 - 18;
    pen.textAlign = last ? "right" : "center";
    pen.fillStyle = theme.soft;
    pen.fillText(text + (k === 0 || last ? " s" : ""), last ? frame.x1 + 8 : x, frame.y0 + 5);
    chart.labels.x.push(text);
  });
}

// Limits that several curves share are drawn once, in grey; a curve's own limit has its colour.
function drawLimits(chart, pen) {
  const { selection, theme } = chart;
  const lines = new Map();
  for (const { run, piece, row, series } of chart.curves()) {
    if (run !== selection.run) continue;
    const { label } = chart.data.series[series];
    const strong = chart.weight(series) >= THIN;
    for (const value of [piece.lower[row], piece.upper[row]]) {
      if (value === null) continue;
      const key = `${piece.t[0]} ${value}`;
      const known = lines.get(key);
      const color = known && known.label !== label ? theme.limit : selection.look(label, run).color;
      lines.set(key, { piece, value, color, label, strong: strong || Boolean(known && known.strong) });
    }
  }
  pen.setLineDash([2, 2]);
  for (const { piece, value, color, strong } of lines.values()) {
    pen.globalAlpha = strong ? 1 : 0.25;
    pen.lineWidth = strong ? 1.2 : 1;
    drawLine(pen, chart.x(piece.t[0]), chart.y(value), chart.x(piece.t[piece.t.length - 1]), chart.y(value), color);
  }
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}

// Faint curves first, so that strong ones lie above them; solutions out of focus are paler.
function drawCurves(chart, pen) {
  const { selection } = chart;
  const ordered = [...chart.curves()].sort((a, b) => chart.weight(a.series) - chart.weight(b.series) || b.run - a.run);
  pen.lineJoin = "round";
  for (const { run, piece, row, series } of ordered) {
    const { color, dash } = selection.look(chart.data.series[series].label, run);
    const [width, alpha] = LINE[chart.weight(series)];
    pen.globalAlpha = run === selection.run ? alpha : 0.65 * alpha;
    pen.lineWidth = width;
    pen.strokeStyle = color;
    pen.setLineDash(dash);
    pen.beginPath();
    let gap = true;
    piece.y[row].forEach((value, k) => {
      if (value !== null) pen[gap ? "moveTo" : "lineTo"](chart.x(piece.t[k]), chart.y(value));
      gap = value === null;
    });
    pen.stroke();
  }
  pen.setLineDash([]);
  pen.globalAlpha = 1;
}

// States are continuous within a phase: where one jumps at a knot, the motion does not obey its equations.
function drawJumps(chart, pen) {
  pen.strokeStyle = chart.theme.bad;
  pen.lineWidth = 3;
  for (const [t, from, to] of jumpsOf(chart)) drawLine(pen, chart.x(t), chart.y(from), chart.x(t), chart.y(to), chart.theme.bad);
}

// Time and both values of every jump that can be seen, of the curves in focus.
function jumpsOf(chart) {
  if (!chart.data.continuous) return [];
  const least = JUMP * (chart.high - chart.low);
  return [...chart.curves()].flatMap(({ run, piece, row, series }) => {
    if (run !== chart.selection.run || chart.weight(series) === ABSENT) return [];
    const y = piece.y[row];
    return piece.t.flatMap((t, k) => (k && t === piece.t[k - 1] && Math.abs(y[k] - y[k - 1]) > least ? [[t, y[k - 1], y[k]]] : []));
  });
}

// Violated rows: a ring on the curve of the variable that a row bounds.
function drawViolations(chart, pen, run) {
  pen.strokeStyle = chart.theme.bad;
  pen.lineWidth = 2;
  for (const { t, variable } of run.proof.violations) {
    const series = chart.data.series.findIndex((s) => s.variable === variable);
    if (series < 0 || chart.weight(series) === ABSENT || t === null) continue;
    const value = valueAt(chart.data.runs[chart.selection.run], series, t);
    if (value === null) continue;
    pen.beginPath();
    pen.arc(chart.x(t), chart.y(value), 5, 0, 2 * Math.PI);
    pen.stroke();
  }
}

function drawImpacts(chart, pen, frame, impacts) {
  pen.strokeStyle = chart.theme.impact;
  pen.lineWidth = 1.2;
  pen.setLineDash([2, 3]);
  for (const t of impacts) {
    drawLine(pen, chart.x(t), frame.y1, chart.x(t), frame.y0);
  }
  pen.setLineDash([]);
}

// Knots of the mesh as ticks on the time axis, unless they are too dense.
function drawKnots(chart, pen, frame, phases) {
  pen.strokeStyle = chart.theme.edge;
  pen.lineWidth = 1;
  for (const { knots } of phases) {
    if (knots.length * 3 > chart.x(knots[knots.length - 1]) - chart.x(knots[0])) continue;
    for (const t of knots) {
      drawLine(pen, chart.x(t), frame.y0, chart.x(t), frame.y0 - 4);
    }
  }
}
