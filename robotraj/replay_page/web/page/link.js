"use strict";
// Links to a moment and a view, which may be small enough to embed: #embed&t=0.42&group=FL&solution=2&window=0,1&panel=proof&camera=...

class Link {
  constructor(player, selection, tabs, view) {
    Object.assign(this, { player, selection, tabs, view });
    window.addEventListener("hashchange", () => this.read());
  }

  // Follow the address; returns whether it names a moment.
  read() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const numbers = (name, count) => {
      const list = (wanted.get(name) || "").split(",").map(Number);
      return wanted.has(name) && list.length === count && list.every(Number.isFinite) ? list : null;
    };
    document.body.classList.toggle("embedded", wanted.has("embed"));
    const group = this.selection.groups.findIndex((one) => one.name === wanted.get("group"));
    const run = numbers("solution", 1);
    if (group >= 0 || wanted.get("group") === "all") this.selection.set({ group, isolated: null });
    if (run && this.selection.runs[run[0] - 1]) this.selection.set({ run: run[0] - 1 });
    if (numbers("window", 2)) this.selection.show(...numbers("window", 2));
    if (wanted.has("panel")) this.tabs.showNamed(wanted.get("panel"));
    if (this.view && numbers("camera", 6)) this.view.camera.placed = numbers("camera", 6);
    const t = numbers("t", 1);
    if (!t) return false;
    this.player.play(false);
    this.player.seek(t[0]);
    return true;
  }

  get text() {
    const { selection, player } = this;
    const parts = { t: player.now.toFixed(4).replace(/\.?0+$/, "") };
    if (selection.groups.length > 1) parts.group = selection.group === ALL ? "all" : selection.groups[selection.group].name;
    if (selection.run > 0) parts.solution = selection.run + 1;
    if (selection.span < 0.999 * (selection.full[1] - selection.full[0])) parts.window = selection.window.map((t) => t.toFixed(4)).join(",");
    if (this.tabs.name !== "curves") parts.panel = this.tabs.name;
    if (this.view && this.view.camera.moved) parts.camera = this.view.camera.placed.map((x) => x.toFixed(3)).join(",");
    return "#" + Object.entries(parts).map(([name, value]) => `${name}=${encodeURIComponent(value).replace(/%2C/g, ",")}`).join("&");
  }

  // Put the link into the address and, where the browser allows it, into the clipboard.
  async write() {
    this.player.play(false);
    const text = this.text;
    try {
      history.replaceState(null, "", text);
      await navigator.clipboard.writeText(location.href);
      byId("said").textContent = "The link was copied.";
    } catch {
      // A page inside a notebook has no address, and some browsers give no clipboard to files.
      byId("said").textContent = `The link ends in ${text}.`;
    }
    return text;
  }
}
