"use strict";
// Light or dark: as the system has it, until the button chooses.

class Theme {
  constructor(changed) {
    this.changed = changed;
    this.system = window.matchMedia("(prefers-color-scheme: dark)");
    this.choice = "auto";
    this.system.addEventListener("change", () => this.apply());
    byId("theme").addEventListener("click", () => this.next());
    this.apply();
  }

  get dark() {
    return this.choice === "auto" ? this.system.matches : this.choice === "dark";
  }

  // Two states are enough: the system's, and the other one.
  next() {
    this.choice = this.choice === "auto" ? (this.system.matches ? "light" : "dark") : "auto";
    this.apply();
  }

  apply() {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    byId("theme").textContent = this.dark ? "Light" : "Dark";
    byId("theme").setAttribute("aria-label", this.dark ? "Light colours" : "Dark colours");
    this.read();
    this.changed();
  }

  // The colours of the style sheet, for canvases and the 3D view.
  read() {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["ink", "soft", "grid", "zero", "limit", "impact", "paper", "bad", "good", "accent", "edge", "sky", "earth", "mesh-grid"]) {
      this[name.replace("-g", "G")] = style.getPropertyValue(`--${name}`).trim();
    }
  }
}
