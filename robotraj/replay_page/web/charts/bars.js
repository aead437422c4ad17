"use strict";
// Above the charts: which phase runs, and which contact is held, over time; click or drag to seek.

class Bars {
  constructor(host, selection, onSeek) {
    Object.assign(this, { host, selection, onSeek });
    this.rows = element("div", undefined, "rows");
    this.names = Object.assign(element("ul", undefined, "phase-names"), { tabIndex: 0 });
    host.append(this.rows, this.names);
    this.build();
    this.listen();
    new ResizeObserver(() => this.fitNames()).observe(host);
  }

  build() {
    const run = this.selection.runs[this.selection.run];
    this.shown = this.selection.run;
    this.bars = [];
    this.rows.replaceChildren();
    this.host.hidden = run.phases.length < 2 && run.held.length === 0;
    if (this.host.hidden) return;
    if (run.phases.length > 1) this.addPhases(run.phases);
    for (const { label, spans } of run.held) this.addContact(label, spans, run.colors[label]);
    this.area = element("div", undefined, "area");
    this.impacts = run.impacts.map((t) => {
      const mark = element("i", undefined, "impact");
      mark.title = `impact at ${t.toFixed(3)} s`;
      this.area.append(mark);
      return [mark, t];
    });
    this.cursor = element("div", undefined, "now");
    this.area.append(this.cursor);
    this.rows.append(this.area);
    this.place();
  }

  addRow(label) {
    const row = element("div", undefined, "row");
    const tag = element("span", label.replace(/_(link|frame)$/, ""));
    tag.title = label;
    const track = element("div", undefined, "track");
    row.append(tag, track);
    this.rows.append(row);
    return track;
  }

  addSpan(track, start, end, title) {
    const bar = element("b");
    bar.title = title;
    track.append(bar);
    this.bars.push({ bar, start, end });
    return bar;
  }

  addPhases(phases) {
    const track = this.addRow("phase");
    const colors = phaseColors(phases, this.selection.palette);
    const names = [...new Set(phases.map((phase) => phase.name))];
    this.phases = phases.map((phase, k) => {
      const title = `${phase.name}: ${phase.start.toFixed(3)} to ${phase.end.toFixed(3)} s`;
      const bar = this.addSpan(track, phase.start, phase.end, title);
      bar.className = "phase";
      bar.style.setProperty("--own", colors[k]);
      return { bar, name: phase.name, number: String(names.indexOf(phase.name) + 1) };
    });
    this.names.replaceChildren(
      ...names.map((name, k) => {
        const item = element("li");
        const tag = element("i", String(k + 1));
        tag.style.setProperty("--own", colors[phases.findIndex((phase) => phase.name === name)]);
        item.append(tag, name);
        return item;
      }),
    );
  }

  addContact(label, spans, color) {
    const track = this.addRow(label);
    track.dataset.contact = label;
    for (const [a, b] of spans) {
      this.addSpan(track, a, b, `${label} held: ${a.toFixed(3)} to ${b.toFixed(3)} s`).style.background = color;
    }
  }

  percent(t) {
    return (100 * (t - this.selection.window[0])) / this.selection.span;
  }

  // Bars follow the window of time of the charts.
  place() {
    if (this.host.hidden) return;
    for (const { bar, start, end } of this.bars) {
      const [a, b] = [Math.max(0, this.percent(start)), Math.min(100, this.percent(end))];
      bar.hidden = b <= a;
      Object.assign(bar.style, { left: `${a}%`, width: `${b - a}%` });
    }
    for (const [mark, t] of this.impacts) mark.style.left = `${this.percent(t)}%`;
    this.fitNames();
  }

  // Where one name does not fit its bar, bars carry numbers and a list below explains them.
  fitNames() {
    if (!this.phases || this.host.hidden) return;
    const show = (numbered) => this.phases.forEach(({ bar, name, number }) => (bar.textContent = numbered ? number : name));
    show(false);
    const tight = this.phases.some(({ bar }) => !bar.hidden && bar.scrollWidth > bar.clientWidth + 1);
    this.names.hidden = !tight;
    if (!tight) return;
    show(true);
    for (const { bar } of this.phases) if (bar.clientWidth < 16) bar.textContent = "";
  }

  listen() {
    const move = (event) => {
      const box = this.area.getBoundingClientRect();
      const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      this.onSeek(this.selection.window[0] + share * this.selection.span, true);
    };
    let dragging = false;
    this.rows.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.rows.setPointerCapture(event.pointerId);
      dragging = true;
      move(event);
    });
    this.rows.addEventListener("pointermove", (event) => dragging && move(event));
    for (const kind of ["pointerup", "pointercancel"]) {
      this.rows.addEventListener(kind, () => {
        if (dragging) this.onSeek(null, false);
        dragging = false;
      });
    }
  }

  refresh() {
    if (this.shown !== this.selection.run) this.build();
    else this.place();
    this.setTime(this.time);
  }

  setTime(t) {
    this.time = t;
    if (!this.cursor) return;
    const place = this.percent(t);
    this.cursor.hidden = place < -1e-6 || place > 100 + 1e-6;
    this.cursor.style.left = `${place}%`;
  }
}
