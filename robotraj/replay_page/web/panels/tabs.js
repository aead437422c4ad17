"use strict";
// The tabs of the right half: curves, proof, meshes, problem, settings.

class Tabs {
  constructor(host, side) {
    Object.assign(this, { host, side, tabs: [] });
    host.addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      event.preventDefault();
      this.step(step);
      this.tabs[this.shown].tab.focus();
    });
  }

  // Add a tab with a panel, which is made here unless it stands in the page.
  add(name, title, panel) {
    const number = this.tabs.length;
    const tab = button(title, title, undefined, () => this.show(number));
    Object.assign(tab, { id: `tab-${name}`, role: "tab" });
    const own = panel || element("div", undefined, "panel");
    if (!panel) {
      own.id = `panel-${name}`;
      own.setAttribute("role", "tabpanel");
      own.setAttribute("aria-labelledby", tab.id);
      own.tabIndex = 0;
      this.side.append(own);
    }
    tab.setAttribute("role", "tab");
    tab.setAttribute("aria-controls", own.id);
    this.host.append(tab);
    this.tabs.push({ name, tab, panel: own });
    return own;
  }

  show(number) {
    this.shown = number;
    this.tabs.forEach(({ tab, panel }, k) => {
      tab.setAttribute("aria-selected", String(k === number));
      tab.tabIndex = k === number ? 0 : -1;
      panel.hidden = k !== number;
    });
    if (this.onShow) this.onShow(this.tabs[number].name);
  }

  showNamed(name) {
    const number = this.tabs.findIndex((tab) => tab.name === name);
    if (number >= 0) this.show(number);
  }

  step(by) {
    this.show((this.shown + by + this.tabs.length) % this.tabs.length);
  }

  get name() {
    return this.tabs[this.shown].name;
  }
}
