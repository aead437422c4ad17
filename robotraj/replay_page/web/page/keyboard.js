"use strict";
// Keys, whatever has the focus. A button that was clicked gives the focus back, so that Space plays again.

const KEYS = [
  ["space, k", "play or pause"],
  ["← →", "a hundredth of the time; with Shift a tenth"],
  [", .", "a thirtieth of a second"],
  ["Home End", "start, end"],
  ["g, G", "next, previous group of joints"],
  ["o", "other groups faintly, or not at all"],
  ["+ − 0", "zoom in time, the whole time"],
  ["Esc", "leave an isolated curve"],
  ["r", "frame the robot again"],
  ["f", "follow the robot"],
  ["1 … 4", "solution in focus"],
  ["p", "next panel"],
  ["d", "light or dark"],
  ["?", "this list"],
];

class Keyboard {
  // `acts` maps keys to functions; what a key does to the focused control comes first.
  constructor(acts) {
    this.acts = acts;
    this.dialog = byId("keys");
    this.fill();
    byId("help").addEventListener("click", () => this.help());
    window.addEventListener("keydown", (event) => this.press(event));
    window.addEventListener("click", (event) => {
      const own = event.target.closest && event.target.closest("button, select, input[type=checkbox], summary");
      // A click by a key has no place; that control keeps the focus.
      if (own && event.detail > 0 && own.tagName !== "SELECT") own.blur();
    });
    byId("speed").addEventListener("change", () => byId("speed").blur());
  }

  fill() {
    const title = element("h2", "Keys");
    title.id = "keys-title";
    const list = element("table");
    for (const [keys, meaning] of KEYS) {
      const row = list.insertRow();
      row.append(Object.assign(element("th", keys), { scope: "row" }));
      row.insertCell().textContent = meaning;
    }
    const more = element("p", "On a chart: drag to move the time, Shift and drag to move the window, Ctrl and wheel or a pinch to zoom, double click on a curve to see it alone.");
    this.dialog.append(title, list, more, button("Close", "Close (Esc)", undefined, () => this.dialog.close()));
  }

  help() {
    if (this.dialog.open) this.dialog.close();
    else this.dialog.showModal();
  }

  // Keys that a focused control needs for itself.
  owned(event) {
    const target = event.target;
    const kind = target.tagName;
    if (kind === "SELECT") return ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "Home", "End", " "].includes(event.key);
    if (kind === "BUTTON" || kind === "SUMMARY" || target.type === "checkbox") return event.key === " ";
    if (target.getAttribute && target.getAttribute("role") === "tab") return ["ArrowLeft", "ArrowRight"].includes(event.key);
    return false;
  }

  press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.dialog.open && event.key !== "?") return;
    const tab = event.target.getAttribute && event.target.getAttribute("role") === "tab";
    if (this.owned(event) || (tab && ["ArrowLeft", "ArrowRight", "Home", "End"].includes(event.key))) return;
    const act = event.key === "?" ? () => this.help() : this.acts[event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
  }
}
