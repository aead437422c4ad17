"use strict";
// The page of a plan that is being made: it takes iterates from its server and shows one after the other.

const LEAST_TIME = 120;
const FAR = 30;
const EVENTS = "events";

class Live {
  constructor(view, curves, charts) {
    Object.assign(this, { view, curves, charts, iterates: [], shown: -1, latest: true, count: 0, since: 0, ended: null });
    byId("scrubber").addEventListener("input", () => this.go(Number(byId("scrubber").value), false));
    byId("latest").addEventListener("click", () => this.setLatest(!this.latest));
    if (view) byId("home").addEventListener("click", () => view.camera.home());
    const tick = (stamp) => {
      this.advance(stamp);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  // An event of the server: iterate or end.
  take(event) {
    if (event.kind === "end") {
      this.ended = event;
      this.finish();
      return;
    }
    const starts = event.number === 0;
    this.charts.residuals.add(event.infeasibility, starts);
    this.charts.objectives.add(event.objective, starts);
    if (event.poses || event.charts) this.iterates.push({ ...event, place: this.count });
    this.count += 1;
    byId("scrubber").max = Math.max(0, this.iterates.length - 1);
    this.stale = true;
  }

  setLatest(wanted) {
    this.latest = wanted;
    byId("latest").setAttribute("aria-pressed", String(wanted));
  }

  // Show an iterate; a choice of the user stops the run towards the latest one.
  go(number, latest) {
    if (!this.iterates[number]) return;
    this.setLatest(latest);
    this.shown = number;
    const iterate = this.iterates[number];
    byId("scrubber").value = number;
    byId("scrubber").setAttribute("aria-valuetext", `iteration ${iterate.number} of solve ${iterate.solve}`);
    byId("number").textContent = number + 1;
    byId("solve").textContent = `${iterate.solve}, ${iterate.intervals} intervals`;
    byId("iteration").textContent = iterate.number;
    byId("objective").textContent = iterate.objective === null ? "–" : minus(Number(iterate.objective.toPrecision(6)).toString());
    byId("infeasibility").textContent = iterate.infeasibility === null ? "–" : minus(iterate.infeasibility.toExponential(1));
    if (!this.ended) byId("status").textContent = "planning";
    for (const chart of Object.values(this.charts)) chart.marked = iterate.place;
    if (iterate.poses && this.view) this.view.take(iterate);
    if (iterate.charts) this.curves.take(iterate);
    this.stale = true;
  }

  // Iterates are seen for a moment, also where the solver is faster than the eye; far behind, some are skipped.
  advance(stamp) {
    const behind = this.iterates.length - 1 - this.shown;
    if (this.latest && behind > 0 && stamp - this.since > LEAST_TIME) {
      this.since = stamp;
      this.go(this.shown + Math.ceil(behind / FAR), true);
      this.finish();
    }
    if (this.stale) for (const chart of Object.values(this.charts)) chart.draw();
    this.stale = false;
    if (!this.view || this.shown < 0) return;
    const { duration } = this.iterates[this.shown];
    this.view.show(((stamp / 1000) % (duration + 0.6)) / Math.max(duration, 1e-9));
    this.view.draw();
  }

  // The verdict, once the last iterate is shown.
  finish() {
    if (!this.ended || this.shown < this.iterates.length - 1) return;
    byId("status").textContent = this.ended.text;
    byId("status").className = `status ${this.ended.colour}`;
    byId("message").textContent = this.ended.message;
  }
}

async function startLive() {
  const data = JSON.parse(new TextDecoder().decode(await unpack("data")));
  const parts = {};
  const theme = new Theme(() => parts.redraw && parts.redraw());
  let view = null;
  try {
    view = data.scene && new LiveView(byId("pane"), data.scene, await unpack("commands"), theme);
  } catch (error) {
    showFailure(`The 3D view needs WebGL, which this browser does not offer here (${error.message}).`);
  }
  const charts = { residuals: new MeasureChart(byId("residuals"), theme, true), objectives: new MeasureChart(byId("objectives"), theme, false) };
  const curves = new IterateCharts(byId("iterate"), theme, data.palette);
  const live = new Live(view, curves, charts);
  parts.redraw = () => {
    curves.draw();
    for (const chart of Object.values(charts)) chart.draw();
    if (view) view.recolor();
  };
  window.robotraj = { live, view };
  const source = new EventSource(EVENTS);
  source.onmessage = ({ data: text }) => {
    const event = JSON.parse(text);
    if (event.kind === "end") source.close();
    live.take(event);
  };
  source.onerror = () => {
    source.close();
    if (!live.ended) live.take({ kind: "end", text: "the plan was left", colour: "bad", message: "The process that plans is gone." });
  };
}

startLive();
