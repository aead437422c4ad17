"use strict";
// GIF files: at most 255 colours by median cut, and only the pixels that changed since the frame before.
// Source: CompuServe, Graphics Interchange Format, version 89a (1990).

const BITS = 5; // of each colour channel that are kept
const COLOURS = 255; // the last number of a palette of 256 stands for "as before"

const keyOf = (r, g, b) => ((r >> 3) << 10) | ((g >> 3) << 5) | (b >> 3);
const partsOf = (key) => [(key >> 10) & 31, (key >> 5) & 31, key & 31];

// The palette of a histogram (32768), and the number of the colour of every key.
function medianCut(counts) {
  const used = [...counts.keys()].filter((key) => counts[key]);
  const boxOf = (keys) => {
    const parts = keys.map(partsOf);
    const sides = [0, 1, 2].map((c) => Math.max(...parts.map((p) => p[c])) - Math.min(...parts.map((p) => p[c])));
    const channel = sides.indexOf(Math.max(...sides));
    const pixels = keys.reduce((sum, key) => sum + counts[key], 0);
    return { keys, channel, pixels, merit: sides[channel] * Math.sqrt(pixels) };
  };
  const boxes = [boxOf(used)];
  while (boxes.length < COLOURS) {
    const widest = boxes.reduce((best, box, k) => (box.merit > boxes[best].merit ? k : best), 0);
    const { keys, channel, pixels, merit } = boxes[widest];
    if (merit === 0) break;
    keys.sort((a, b) => partsOf(a)[channel] - partsOf(b)[channel]);
    let [at, seen] = [0, 0];
    while (at < keys.length - 1 && seen < pixels / 2) seen += counts[keys[at++]];
    boxes.splice(widest, 1, boxOf(keys.slice(0, at)), boxOf(keys.slice(at)));
  }
  const palette = new Uint8Array(3 * 256);
  const numbers = new Uint8Array(1 << (3 * BITS));
  boxes.forEach(({ keys, pixels }, number) => {
    const mean = [0, 0, 0];
    for (const key of keys) {
      partsOf(key).forEach((part, c) => (mean[c] += (part * counts[key]) / pixels));
      numbers[key] = number;
    }
    palette.set(mean.map((part) => Math.round((part * 255) / 31)), 3 * number);
  });
  return { palette, numbers };
}

// Codes of 9 to 12 bits for strings of bytes, each one string that was seen and one more byte.
function lzw(indices) {
  const [clear, end] = [256, 257];
  const out = [];
  let [width, next, buffer, filled, known] = [9, 258, 0, 0, new Map()];
  const put = (code) => {
    buffer |= code << filled;
    filled += width;
    while (filled >= 8) {
      out.push(buffer & 255);
      buffer >>>= 8;
      filled -= 8;
    }
  };
  put(clear);
  let prefix = indices[0];
  for (let i = 1; i < indices.length; ++i) {
    const key = (prefix << 8) | indices[i];
    const found = known.get(key);
    if (found !== undefined) {
      prefix = found;
      continue;
    }
    put(prefix);
    if (next === 4096) {
      put(clear);
      [width, next, known] = [9, 258, new Map()];
    } else {
      if (next === 1 << width) ++width;
      known.set(key, next++);
    }
    prefix = indices[i];
  }
  put(prefix);
  if (next === 1 << width && width < 12) ++width;
  put(end);
  if (filled) out.push(buffer & 255);
  return out;
}

class Gif {
  // `delay` is the time of a frame in hundredths of a second.
  constructor(width, height, delay) {
    Object.assign(this, { width, height, delay, frames: [], counts: new Uint32Array(1 << (3 * BITS)) });
  }

  // Four bytes a pixel, as a canvas gives them.
  add(pixels) {
    const keys = new Uint16Array(this.width * this.height);
    for (let i = 0; i < keys.length; ++i) ++this.counts[(keys[i] = keyOf(pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2]))];
    this.frames.push(keys);
  }

  blob() {
    const { palette, numbers } = medianCut(this.counts);
    const word = (value) => [value & 255, value >> 8];
    const text = (letters) => [...letters].map((letter) => letter.charCodeAt(0));
    const size = [...word(this.width), ...word(this.height)];
    const pieces = [text("GIF89a"), size, [0xf7, 0, 0], palette, [0x21, 0xff, 11], text("NETSCAPE2.0"), [3, 1, 0, 0, 0]];
    this.frames.forEach((keys, k) => {
      const before = this.frames[k - 1];
      const indices = Uint8Array.from(keys, (key, i) => (before && numbers[before[i]] === numbers[key] ? COLOURS : numbers[key]));
      pieces.push([0x21, 0xf9, 4, 5, ...word(this.delay), COLOURS, 0], [0x2c, 0, 0, 0, 0], size, [0, 8]);
      const data = lzw(indices);
      for (let at = 0; at < data.length; at += 255) pieces.push([Math.min(255, data.length - at)], data.slice(at, at + 255));
      pieces.push([0]);
    });
    return new Blob([...pieces.map((piece) => Uint8Array.from(piece)), Uint8Array.of(0x3b)], { type: "image/gif" });
  }
}
