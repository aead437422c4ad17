"use strict";
// Scales of the axes, dashes, and values of curves between their samples.

const STEPS = [10, 5, 2.5, 2, 1];
const LEAST_LABELS = 3;
const DASHES = [[], [9, 4], [3, 3], [12, 3, 3, 3], [6, 2.5], [12, 3, 3, 3, 3, 3], [1.5, 3]];

// Round values between two bounds with their texts: about `count` of them, and never fewer than three.
function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, LEAST_LABELS);
  let power = 10 ** Math.floor(Math.log10(rough));
  let step = [...STEPS].reverse().map((f) => f * power).find((s) => s >= rough * 0.999);
  let values = multiples(step, low, high);
  // A coarser step may leave two labels or one, so finer ones are tried.
  for (let finer = 0; values.length < LEAST_LABELS && finer < 8; finer++) {
    const smaller = [power, power / 10].flatMap((p) => STEPS.map((f) => f * p)).find((s) => s < step * 0.999);
    step = smaller;
    power = 10 ** Math.floor(Math.log10(step) + 1e-9);
    values = multiples(step, low, high);
  }
  return values.map((value) => [value, tickText(value, step, Math.max(Math.abs(low), Math.abs(high)))]);
}

function multiples(step, low, high) {
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function tickText(value, step, largest) {
  if (Math.abs(value) < 1e-9 * step) return "0";
  const power = Math.floor(Math.log10(step) + 1e-9);
  const half = Math.abs(step / 10 ** power - 2.5) < 1e-6 ? 1 : 0;
  if (largest < 1e-3 || largest >= 1e5) {
    const own = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
    return minus(value.toExponential(Math.max(0, Math.min(6, own - power + half))).replace("e+", "e"));
  }
  return minus(value.toFixed(Math.max(0, half - power)));
}

function minus(text) {
  return text.replace(/-/g, "−");
}

// A value as the legend shows it.
function valueText(value) {
  if (value === null) return "";
  const size = Math.abs(value);
  if (size >= 1e5 || (size > 1e-9 && size < 5e-4)) return minus(value.toExponential(2).replace("e+", "e"));
  return minus((size < 5e-4 ? 0 : value).toFixed(3));
}

// The value of a curve at a time, linear between samples; null where it has none. At a knot the later side counts.
function valueAt(pieces, series, t) {
  for (let k = pieces.length - 1; k >= 0; k--) {
    const { t: times, of, y } = pieces[k];
    const row = of.indexOf(series);
    if (row < 0 || t < times[0] - 1e-9 || t > times[times.length - 1] + 1e-9) continue;
    const high = later(times, t);
    const low = high - 1;
    const share = times[high] > times[low] ? Math.min(1, Math.max(0, (t - times[low]) / (times[high] - times[low]))) : 1;
    const [a, b] = [y[row][low], y[row][high]];
    return a === null || b === null ? null : share === 0 ? a : a + share * (b - a);
  }
  return null;
}

// The first sample after a time, from 1 to the last one.
function later(times, t) {
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle;
  }
  return high;
}
