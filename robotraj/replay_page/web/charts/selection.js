"use strict";
// What the charts show: the group of joints, single curves, the solution in focus and the window of time.

const [ABSENT, FAINT, THIN, STRONG] = [0, 1, 2, 3];
const FEW = 7;
const ALL = -1;

class CurveSelection {
  // Curves of at most `FEW` joints are all shown at first; otherwise one group.
  constructor(runs, palette) {
    Object.assign(this, { runs, palette, run: 0, isolated: null, marked: null, others: true, hidden: new Set() });
    this.groups = mergedGroups(runs);
    // A map, since a joint may have the name of a property that every object has.
    this.contactColors = new Map(runs.flatMap((run) => Object.entries(run.colors)));
    this.full = [Math.min(...runs.map((r) => r.start)), Math.max(...runs.map((r) => r.end))];
    this.window = [...this.full];
    const joints = this.groups.filter((group) => !group.root);
    const count = new Set(joints.flatMap((group) => group.labels)).size;
    this.group = count <= FEW || joints.length < 2 ? ALL : this.groups.indexOf(joints[0]);
    if (this.groups.length === 1) this.group = 0;
    this.few = count <= FEW;
    this.free = [...new Set(runs.flatMap((run) => run.charts.flatMap((chart) => chart.series.map((s) => s.label))))].filter(
      (label) => this.groupOf(label) < 0,
    );
    this.fewLabels = [...joints, ...this.groups.filter((group) => group.root)].flatMap((group) => group.labels).concat(this.free);
    this.listeners = [];
  }

  listen(act) {
    this.listeners.push(act);
  }

  set(changes) {
    const before = { ...this };
    Object.assign(this, changes);
    if (Object.keys(changes).some((name) => before[name] !== this[name])) this.listeners.forEach((act) => act(changes));
  }

  get span() {
    return Math.max(this.window[1] - this.window[0], 1e-12);
  }

  groupOf(label) {
    return this.groups.findIndex((group) => group.labels.includes(label));
  }

  // A curve of the page's author belongs to no group and is always shown.
  inGroup(label) {
    const own = this.groupOf(label);
    if (own < 0) return true;
    if (this.group === ALL) return !this.groups[own].root;
    return own === this.group;
  }

  // How strongly a curve is drawn.
  weight(label) {
    if (this.isolated !== null) return label === this.isolated ? STRONG : ABSENT;
    if (this.hidden.has(label)) return ABSENT;
    if (!this.inGroup(label)) {
      const own = this.groups[this.groupOf(label)];
      const apart = this.group === ALL || this.groups[this.group].root || (own && own.root) || !this.others;
      return apart ? (label === this.marked ? FAINT : ABSENT) : label === this.marked ? THIN : FAINT;
    }
    if (this.marked !== null && this.marked !== label && this.inGroup(this.marked)) return FAINT;
    return this.group === ALL && !this.few && label !== this.marked ? THIN : STRONG;
  }

  // Colour and dash tell curves apart. Where all groups are drawn, the colour is the group's and the dash the joint's,
  // unless there are few. The dash is the solution's where there are several.
  look(label, run) {
    const group = this.groupOf(label);
    const own = Math.max(0, (group < 0 ? this.free : this.groups[group].labels).indexOf(label));
    const contact = [...this.contactColors.keys()].indexOf(label);
    const few = Math.max(0, this.fewLabels.indexOf(label));
    const all = this.group === ALL && this.isolated === null;
    const [tone, dash] = contact >= 0 ? [0, contact] : this.few ? [few, few] : all ? [group, own] : [own, own];
    const color = contact >= 0 ? this.contactColors.get(label) : this.palette[tone % this.palette.length];
    return { color, dash: DASHES[(this.runs.length > 1 ? run : dash) % DASHES.length] };
  }

  toggle(label) {
    const hidden = new Set(this.hidden);
    hidden[hidden.has(label) ? "delete" : "add"](label);
    this.set({ hidden });
  }

  isolate(label) {
    this.set({ isolated: this.isolated === label ? null : label });
  }

  // Show a window of time; it keeps inside the motion and is at least a thousandth of it.
  show(from, to) {
    const whole = this.full[1] - this.full[0];
    const span = Math.min(whole, Math.max(to - from, whole / 1000));
    const middle = (from + to) / 2;
    const start = Math.min(Math.max(middle - span / 2, this.full[0]), this.full[1] - span);
    this.set({ window: [start, start + span] });
  }

  // Zoom about a time by a factor above 1 to see less.
  zoom(factor, about) {
    const [a, b] = this.window;
    this.show(about - (about - a) / factor, about + (b - about) / factor);
  }

  pan(seconds) {
    this.show(this.window[0] + seconds, this.window[1] + seconds);
  }
}

function mergedGroups(runs) {
  const found = new Map();
  for (const { groups } of runs) {
    for (const { name, root, labels } of groups) {
      const own = found.get(name) || { name, root, labels: [] };
      own.labels.push(...labels.filter((label) => !own.labels.includes(label)));
      found.set(name, own);
    }
  }
  return [...found.values()];
}

// Charts of all solutions, joined by their titles: series, and for each solution its pieces.
function mergedCharts(runs) {
  const found = new Map();
  runs.forEach((run, number) => {
    for (const { title, symbol, continuous, series, pieces } of run.charts) {
      const own = found.get(title) || { title, symbol, continuous, series: [], runs: runs.map(() => []) };
      const places = series.map((one) => {
        const known = own.series.findIndex((s) => s.label === one.label);
        return known < 0 ? own.series.push(one) - 1 : known;
      });
      own.runs[number] = pieces.map((piece) => ({ ...piece, of: piece.of.map((k) => places[k]) }));
      found.set(title, own);
    }
  });
  return [...found.values()];
}
