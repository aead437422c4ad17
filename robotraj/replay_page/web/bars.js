"use strict";
// Above the charts: which phase runs, and which contact is held, over time; click or drag to seek.

const TINTS = ["#e6eefb", "#fdeedd", "#e4f4e8", "#f6e6f4", "#fbf6d8", "#e2f3f5", "#f1ebe2"];
const TAGS = ["#2f63a8", "#a8611a", "#2f7d49", "#8a3d80", "#8a7a10", "#1d7480", "#6b5a46"];

// Phases of one name share a colour: [fill, ink].
function tints(phases) {
  const names = [...new Set(phases.map((phase) => phase.name))];
  return phases.map((phase) => {
    const k = names.indexOf(phase.name) % TINTS.length;
    return [TINTS[k], TAGS[k]];
  });
}

class Bars {
  constructor(host, data, hold, onSeek) {
    Object.assign(this, { start: data.phases[0].start, end: data.phases[data.phases.length - 1].end });
    this.span = Math.max(this.end - this.start, 1e-12);
    this.host = host;
    host.hidden = data.phases.length < 2 && data.held.length === 0;
    if (host.hidden) return;
    if (data.phases.length > 1) this.addPhases(data.phases);
    for (const { label, spans } of data.held) this.addContact(label, spans, data.colors[label]);
    this.area = Object.assign(document.createElement("div"), { className: "area" });
    for (const t of data.impacts) {
      const mark = Object.assign(document.createElement("i"), { className: "impact", title: `impact at ${t.toFixed(3)} s` });
      mark.style.left = this.percent(t);
      this.area.append(mark);
    }
    this.cursor = Object.assign(document.createElement("div"), { className: "now" });
    this.area.append(this.cursor);
    host.append(this.area);
    this.listen(hold, onSeek);
  }

  percent(t) {
    return `${(100 * (t - this.start)) / this.span}%`;
  }

  addRow(label) {
    const row = Object.assign(document.createElement("div"), { className: "row" });
    const tag = Object.assign(document.createElement("span"), { textContent: label, title: label });
    const track = Object.assign(document.createElement("div"), { className: "track" });
    row.append(tag, track);
    this.host.append(row);
    return track;
  }

  addSpan(track, a, b, title) {
    const bar = Object.assign(document.createElement("b"), { title });
    Object.assign(bar.style, { left: this.percent(a), width: `${(100 * (b - a)) / this.span}%` });
    track.append(bar);
    return bar;
  }

  addPhases(phases) {
    const track = this.addRow("phase");
    const colors = tints(phases);
    phases.forEach((phase, k) => {
      const bar = this.addSpan(track, phase.start, phase.end, `${phase.name}: ${phase.start.toFixed(3)} to ${phase.end.toFixed(3)} s`);
      [bar.style.background, bar.style.color] = colors[k];
      bar.textContent = phase.name;
      bar.className = "phase";
    });
  }

  addContact(label, spans, color) {
    const track = this.addRow(label);
    track.dataset.contact = label;
    for (const [a, b] of spans) {
      this.addSpan(track, a, b, `${label} held: ${a.toFixed(3)} to ${b.toFixed(3)} s`).style.background = color;
    }
  }

  listen(hold, onSeek) {
    const move = (event) => {
      const box = this.area.getBoundingClientRect();
      onSeek(this.start + Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) * this.span);
    };
    let dragging = false;
    this.host.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.host.setPointerCapture(event.pointerId);
      dragging = true;
      hold(true);
      move(event);
    });
    this.host.addEventListener("pointermove", (event) => dragging && move(event));
    for (const kind of ["pointerup", "pointercancel"]) {
      this.host.addEventListener(kind, () => {
        if (dragging) hold(false);
        dragging = false;
      });
    }
  }

  setTime(t) {
    if (this.cursor) this.cursor.style.left = this.percent(t);
  }
}
