"use strict";
// Playback: one clock that moves the robot, the cursor and the values together.

const ICONS = {
  play: '<svg width="16" height="16" viewBox="0 0 16 16"><path d="M4 2.2v11.6L13.6 8z"/></svg>',
  pause: '<svg width="16" height="16" viewBox="0 0 16 16"><path d="M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z"/></svg>',
};
const byId = (id) => document.getElementById(id);

async function unpack(id) {
  const text = byId(id).textContent.trim();
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class Player {
  constructor(data, view) {
    Object.assign(this, { data, view, playing: false, held: false });
    this.start = data.phases[0].start;
    this.end = data.phases[data.phases.length - 1].end;
    this.now = this.start;
    this.speed = data.speed;
    this.makeCharts();
    this.makeBar();
    this.show();
    let last = performance.now();
    const tick = (stamp) => {
      this.advance(Math.min(Math.max(stamp - last, 0), 250) / 1000);
      last = stamp;
      if (this.view) this.view.draw();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  makeCharts() {
    const labels = [...new Set(this.data.charts.flatMap((chart) => chart.series.map((s) => s.label)))];
    const hold = (held) => (this.held = held);
    const state = { colors: new Map(), hidden: new Set(this.data.hidden), marked: null, hold };
    // Contacts have the colour of the view; joints get other colours, hidden ones last.
    const free = PALETTE.filter((color) => Object.values(this.data.colors).every((other) => !alike(color, other)));
    const joints = labels.filter((label) => !this.data.colors[label]);
    joints.sort((a, b) => this.data.hidden.includes(a) - this.data.hidden.includes(b));
    for (const label of labels) state.colors.set(label, this.data.colors[label] || free[joints.indexOf(label) % free.length]);
    new Proof(byId("proof"), this.data.proof, (t) => (this.play(false), this.seek(t)));
    this.bars = new Bars(byId("bars"), this.data, hold, (t) => this.seek(t));
    const host = byId("charts");
    this.charts = this.data.charts.map((chart) => new Chart(host, chart, this.data, state, (t) => this.seek(t)));
    const redraw = () => this.charts.forEach((chart) => chart.draw());
    this.legend = new Legend(byId("legend"), this.data.charts, state, redraw);
  }

  makeBar() {
    const choices = [...new Set([0.1, 0.25, 0.5, 1, 2, 4, this.speed])].sort((a, b) => a - b);
    for (const speed of choices) byId("speed").add(new Option(`${speed}×`, speed, false, speed === this.speed));
    byId("speed").addEventListener("change", (event) => (this.speed = Number(event.target.value)));
    byId("play").addEventListener("click", () => this.play(!this.playing));
    const scrubber = byId("scrubber");
    [scrubber.min, scrubber.max] = [this.start, this.end];
    scrubber.addEventListener("input", () => this.seek(Number(scrubber.value)));
    scrubber.addEventListener("pointerdown", () => (this.held = true));
    for (const kind of ["pointerup", "pointercancel", "change"]) scrubber.addEventListener(kind, () => (this.held = false));
    if (this.view) {
      byId("home").addEventListener("click", () => this.view.home());
      byId("follow").hidden = !this.data.scene.body;
      byId("follow").addEventListener("click", () => this.view.follow(!this.view.followed));
    }
    window.addEventListener("keydown", (event) => this.key(event));
    this.play(false);
  }

  key(event) {
    if (["SELECT", "INPUT", "BUTTON"].includes(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = (this.end - this.start) / 100;
    const actions = {
      " ": () => this.play(!this.playing),
      ArrowRight: () => this.seek(this.now + step),
      ArrowLeft: () => this.seek(this.now - step),
      Home: () => this.view && this.view.home(),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }

  play(playing) {
    if (playing && this.now >= this.end) this.now = this.start;
    this.playing = playing;
    byId("play").innerHTML = playing ? ICONS.pause : ICONS.play;
  }

  advance(elapsed) {
    if (!this.playing || this.held || elapsed === 0) return;
    let next = this.now + elapsed * this.speed;
    if (next > this.end) {
      if (byId("loop").checked && this.now >= this.end) next = this.start;
      else next = this.end;
    }
    this.now = next;
    this.show();
    if (next === this.end && !byId("loop").checked) this.play(false);
  }

  seek(t) {
    this.now = Math.min(this.end, Math.max(this.start, t));
    this.show();
  }

  show() {
    const digits = this.end - this.start < 1 ? 3 : 2;
    byId("clock").innerHTML = `${this.now.toFixed(digits)} <span>/ ${this.end.toFixed(digits)} s</span>`;
    byId("scrubber").value = this.now;
    this.charts.forEach((chart) => chart.setTime(this.now));
    this.legend.setTime(this.now);
    this.bars.setTime(this.now);
    if (this.view) this.view.seek(this.now);
  }
}

function complain(text) {
  byId("complaint").textContent = text;
  byId("complaint").hidden = false;
}

async function makeView(scene, colors) {
  const packets = await unpack("commands");
  try {
    const view = new View(byId("pane"), scene, packets, colors);
    for (const trace of scene.traces) {
      const item = document.createElement("li");
      item.innerHTML = `<i style="background: rgb(${trace.color})"></i>`;
      item.append(`path of ${trace.frame}`);
      byId("marks").append(item);
    }
    for (const [sign, color, text] of view.contacts.marks()) {
      const item = document.createElement("li");
      const icon = Object.assign(document.createElement("em"), { textContent: sign });
      icon.style.color = color;
      item.append(icon, text);
      byId("marks").append(item);
    }
    return view;
  } catch (error) {
    complain(`The 3D view needs WebGL, which this browser does not offer here (${error.message}).`);
    return null;
  }
}

(async () => {
  if (typeof DecompressionStream === "undefined") {
    complain("This page needs a browser with DecompressionStream: Chrome 80, Firefox 113, Safari 16.4 or newer.");
    return;
  }
  const data = JSON.parse(new TextDecoder().decode(await unpack("data")));
  const view = data.scene ? await makeView(data.scene, data.colors) : null;
  const player = new Player(data, view);
  window.robotraj = {
    seek: (t) => {
      player.play(false);
      player.seek(t);
    },
    time: () => player.now,
    poses: () => (view ? view.poses() : {}),
    view,
    viewer: view && view.viewer,
  };
  player.play(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
