"use strict";
// The row above the charts: one button for each group of joints, and the window of time.

class Groups {
  constructor(host, selection, now) {
    Object.assign(this, { host, selection, now });
    const chips = element("div", undefined, "chips");
    this.chips = [];
    if (selection.groups.length > 1) {
      this.addChip(chips, "all", ALL);
      selection.groups.forEach((group, k) => this.addChip(chips, group.name, k));
      this.others = button("others", "Show the other groups faintly (o)", selection.others, () => this.toggleOthers());
      chips.append(this.others);
    }
    this.back = button("show all curves", "Leave the isolated curve (Esc)", undefined, () => selection.set({ isolated: null, hidden: new Set() }));
    chips.append(this.back);
    const tools = element("div", undefined, "chips");
    tools.append(
      button("−", "Zoom out in time (−)", undefined, () => this.zoom(0.5)),
      button("+", "Zoom in in time (+)", undefined, () => this.zoom(2)),
      (this.whole = button("whole", "The whole time (0)", undefined, () => selection.show(...selection.full))),
    );
    tools.children[0].setAttribute("aria-label", "Zoom out in time");
    tools.children[1].setAttribute("aria-label", "Zoom in in time");
    host.append(chips, tools);
    this.refresh();
  }

  addChip(host, name, group) {
    const chip = button(name, `Draw ${name === "all" ? "all groups alike" : `the curves of ${name} strongly`} (g)`, false, () => this.choose(group));
    host.append(chip);
    this.chips.push({ chip, group });
  }

  choose(group) {
    this.selection.set({ group, isolated: null });
  }

  // The next or previous group, after the last one all of them.
  step(by) {
    const { groups, group } = this.selection;
    if (groups.length < 2) return;
    const count = groups.length + 1;
    this.choose(((group + 1 + by + count) % count) - 1);
  }

  toggleOthers() {
    this.selection.set({ others: !this.selection.others });
  }

  // Zoom about the present time where it is in view, else about the middle.
  zoom(factor) {
    const [a, b] = this.selection.window;
    const t = this.now();
    this.selection.zoom(factor, t >= a && t <= b ? t : (a + b) / 2);
  }

  refresh() {
    const { selection } = this;
    for (const { chip, group } of this.chips) chip.setAttribute("aria-pressed", String(group === selection.group));
    if (this.others) this.others.setAttribute("aria-pressed", String(selection.others));
    this.back.hidden = selection.isolated === null && selection.hidden.size === 0;
    this.whole.disabled = selection.window[0] <= selection.full[0] && selection.window[1] >= selection.full[1];
  }
}
