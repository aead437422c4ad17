"use strict";
// Files made in the browser: pictures, values as CSV, a video, a GIF. Nothing leaves the machine.

const FRAMES = 30;
const GIF_WIDTH = 480; // [pixels]
const GIF_DELAY = 6; // between frames [hundredths of a second]
const GIF_FRAMES = 200; // at most: of longer motions fewer frames are kept

function download(blob, name) {
  const link = element("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

class Exports {
  constructor(host, parts) {
    Object.assign(this, { host, ...parts });
    this.list = element("div", undefined, "items");
    this.list.hidden = true;
    this.opener = button("Save", "Pictures, values, video, link", undefined, () => this.open(this.list.hidden));
    this.opener.setAttribute("aria-expanded", "false");
    host.append(this.opener, this.list);
    if (this.view) this.item("Picture of the robot (PNG)", () => this.picture());
    this.item("Picture of the curves (PNG)", () => this.curvePicture());
    this.item("Values (CSV)", () => download(new Blob([this.csv()], { type: "text/csv" }), `${this.name}.csv`));
    if (this.view && typeof MediaRecorder !== "undefined") this.video = this.item("Video of the motion", () => this.record());
    if (this.view) this.gif = this.item("GIF of the motion", () => this.animate());
    this.item("Link to this moment and view", () => this.link());
    window.addEventListener("pointerdown", (event) => !host.contains(event.target) && this.open(false));
  }

  get name() {
    return document.title.split(" · ")[0].replace(/[^\w-]+/g, "_") || "motion";
  }

  item(text, act) {
    const made = button(text, text, undefined, () => {
      this.open(false);
      act();
    });
    this.list.append(made);
    return made;
  }

  open(wanted) {
    this.list.hidden = !wanted;
    this.opener.setAttribute("aria-expanded", String(wanted));
    if (wanted) this.list.querySelector("button").focus();
  }

  // The canvas keeps its pixels only until the browser has shown them, so it is drawn again first.
  picture() {
    this.view.viewer.render();
    this.view.viewer.renderer.domElement.toBlob((blob) => download(blob, `${this.name}_${this.player.now.toFixed(3)}s.png`));
  }

  // All charts that are shown, one below the other, with their titles and the legend.
  curvePicture() {
    const shown = this.charts.filter((chart) => !chart.empty);
    const [width, height, head, line, scale] = [900, 220, 24, 18, 2];
    const labels = [...new Set(shown.flatMap((chart) => chart.data.series.filter((_, k) => chart.weight(k) >= THIN).map((s) => s.label)))];
    const columns = 4;
    const canvas = element("canvas");
    canvas.width = scale * width;
    canvas.height = scale * (shown.length * (head + height) + line * Math.ceil(labels.length / columns) + 16);
    const pen = canvas.getContext("2d");
    const { theme, selection } = this.charts[0];
    pen.scale(scale, scale);
    pen.fillStyle = theme.paper;
    pen.fillRect(0, 0, width, canvas.height);
    shown.forEach((chart) => {
      pen.fillStyle = theme.ink;
      pen.font = "600 13px system-ui, sans-serif";
      [pen.textAlign, pen.textBaseline] = ["left", "alphabetic"];
      pen.fillText(chart.root.querySelector("h2 div").textContent, 12, 17);
      pen.translate(0, head);
      chart.paint(pen, width, height);
      pen.translate(0, height);
    });
    pen.font = "12px system-ui, sans-serif";
    [pen.textAlign, pen.textBaseline] = ["left", "middle"];
    labels.forEach((label, k) => {
      const [x, y] = [12 + ((width - 24) / columns) * (k % columns), 12 + line * Math.floor(k / columns)];
      const { color, dash } = selection.look(label, selection.run);
      Object.assign(pen, { strokeStyle: color, lineWidth: 2 });
      pen.setLineDash(dash);
      pen.strokeRect(x, y, 26, 0);
      pen.setLineDash([]);
      pen.fillStyle = theme.ink;
      pen.fillText(label, x + 34, y);
    });
    canvas.toBlob((blob) => download(blob, `${this.name}_curves.png`));
    shown.forEach((chart) => chart.draw());
  }

  // Every sample of the solution in focus: time, phase, then one column for each curve with its unit.
  csv() {
    const { selection } = this.charts[0];
    const run = selection.runs[selection.run];
    const columns = this.charts.flatMap(({ data }) => data.series.map((one, series) => ({ ...one, series, pieces: data.runs[selection.run] })));
    const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
    const lines = [["t [s]", "phase", ...columns.map((c) => `${c.variable}${c.unit ? ` [${c.unit}]` : ""}`)]];
    run.phases.forEach((phase, k) => {
      const owners = columns.map((column) => {
        const piece = column.pieces.find((one) => Math.abs(one.t[0] - phase.start) < 1e-9 && one.of.includes(column.series));
        return piece ? piece.y[piece.of.indexOf(column.series)] : null;
      });
      const times = run.charts[0].pieces[k].t;
      times.forEach((t, i) => lines.push([t, phase.name, ...owners.map((y) => (y === null || y[i] === null ? "" : y[i]))]));
    });
    return lines.map((cells) => cells.map((cell) => quoted(String(cell))).join(",")).join("\n") + "\n";
  }

  // Frames of the whole motion at the present speed.
  async animate() {
    const { view, player } = this;
    if (this.gif.disabled) return;
    this.gif.disabled = true;
    const source = view.viewer.renderer.domElement;
    const canvas = element("canvas");
    canvas.width = Math.min(GIF_WIDTH, source.width);
    canvas.height = Math.max(1, Math.round((canvas.width * source.height) / source.width));
    const pen = canvas.getContext("2d", { willReadFrequently: true });
    const seconds = (player.end - player.start) / player.speed;
    const delay = Math.max(GIF_DELAY, Math.ceil((100 * seconds) / GIF_FRAMES));
    const count = Math.max(2, Math.round((100 * seconds) / delay));
    const made = new Gif(canvas.width, canvas.height, delay);
    const now = player.now;
    player.play(false);
    for (let k = 0; k < count; ++k) {
      this.gif.textContent = `GIF of the motion: ${Math.round((100 * k) / count)} %`;
      await new Promise((after) => setTimeout(after));
      player.seek(player.start + ((player.end - player.start) * k) / (count - 1));
      view.viewer.render();
      pen.drawImage(source, 0, 0, canvas.width, canvas.height);
      made.add(pen.getImageData(0, 0, canvas.width, canvas.height).data);
    }
    player.seek(now);
    this.gif.textContent = "GIF of the motion";
    this.gif.disabled = false;
    download(made.blob(), `${this.name}.gif`);
  }

  // Play once from the start at the present speed, and keep what the canvas shows.
  record() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    const kinds = ["video/mp4", "video/webm;codecs=vp9", "video/webm"];
    const mimeType = kinds.find((kind) => MediaRecorder.isTypeSupported(kind));
    const stream = this.view.viewer.renderer.domElement.captureStream(FRAMES);
    const pieces = [];
    this.recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: 8e6 });
    this.recorder.ondataavailable = (event) => pieces.push(event.data);
    this.recorder.onstop = () => {
      const ending = mimeType.startsWith("video/mp4") ? "mp4" : "webm";
      this.recorder = null;
      this.player.onEnd = null;
      this.video.textContent = "Video of the motion";
      stream.getTracks().forEach((track) => track.stop());
      download(new Blob(pieces, { type: mimeType }), `${this.name}.${ending}`);
    };
    this.video.textContent = "Stop the video";
    this.player.play(false);
    this.player.seek(this.player.start);
    this.player.onEnd = () => setTimeout(() => this.recorder && this.recorder.stop(), 200);
    this.recorder.start();
    this.player.play(true);
  }
}
