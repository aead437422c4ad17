"use strict";
// Playback: one clock that moves the robot, the cursor and the values together.

const ICONS = {
  play: '<svg width="16" height="16" viewBox="0 0 16 16" aria-hidden="true"><path d="M4 2.2v11.6L13.6 8z"/></svg>',
  pause: '<svg width="16" height="16" viewBox="0 0 16 16" aria-hidden="true"><path d="M3.5 2.5h3v11h-3zM9.5 2.5h3v11h-3z"/></svg>',
};
const SAY_AFTER = 400;

class Player {
  // `follow` is called with every new time, `say` returns the values of that time in words.
  constructor(selection, speed, follow, say) {
    Object.assign(this, { selection, speed, follow, say, playing: false, held: false, onEnd: null });
    [this.start, this.end] = selection.full;
    this.now = this.start;
    this.makeBar();
    this.play(false);
  }

  run(draw) {
    let last = performance.now();
    const tick = (stamp) => {
      this.advance(Math.min(Math.max(stamp - last, 0), 250) / 1000);
      last = stamp;
      draw();
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
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
  }

  play(playing) {
    if (playing && this.now >= this.end) this.now = this.start;
    this.playing = playing;
    byId("play").innerHTML = playing ? ICONS.pause : ICONS.play;
    byId("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    if (!playing) this.announce();
  }

  advance(elapsed) {
    if (!this.playing || this.held || elapsed === 0) return;
    let next = this.now + elapsed * this.speed;
    const loops = byId("loop").checked && !this.onEnd;
    if (next > this.end) next = loops && this.now >= this.end ? this.start : this.end;
    this.now = next;
    this.show();
    if (next < this.end || loops) return;
    this.play(false);
    if (this.onEnd) this.onEnd();
  }

  seek(t) {
    this.now = Math.min(this.end, Math.max(this.start, t));
    this.show();
    this.announce();
  }

  // From a drag: seek and hold the clock, or let go of it.
  drag(t, held) {
    this.held = held;
    if (t !== null) this.seek(t);
  }

  // The values are spoken once the time rests.
  announce() {
    clearTimeout(this.saying);
    this.saying = setTimeout(() => !this.playing && (byId("said").textContent = this.words() + ". " + this.say()), SAY_AFTER);
  }

  words() {
    const phases = this.selection.runs[this.selection.run].phases;
    const phase = phases.find((one) => this.now <= one.end) || phases[phases.length - 1];
    const digits = this.end - this.start < 1 ? 3 : 2;
    return `${this.now.toFixed(digits)} of ${this.end.toFixed(digits)} s, ${phase.name}`;
  }

  show() {
    const digits = this.end - this.start < 1 ? 3 : 2;
    byId("clock").innerHTML = `${this.now.toFixed(digits)} <span>/ ${this.end.toFixed(digits)} s</span>`;
    byId("scrubber").value = this.now;
    byId("scrubber").setAttribute("aria-valuetext", this.words());
    this.follow(this.now);
  }
}
