"use strict";
// The 3D view: meshcat's viewer fed from recorded commands, lit for the robot. camera.js frames it.

// Whether a mesh belongs to the robot; obstacles, ground and paths keep their colours.
function isLink(mesh) {
  for (let node = mesh; node; node = node.parent) if (/^visual \d/.test(node.name)) return true;
  return false;
}

class View {
  constructor(pane, runs, packets, theme) {
    Object.assign(this, { pane, runs, theme, apart: false });
    this.scenes = runs.map((run) => run.scene);
    this.viewer = new MeshCat.Viewer(pane, false);
    const own = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => own(pane.clientWidth || 1, pane.clientHeight || 1);
    // A finger that moves up or down scrolls the page past the robot; sideways it turns the camera.
    pane.style.touchAction = "pan-y";
    replayCommands(this.viewer, packets);
    // An action follows seek() only once it was played; the page keeps its own clock.
    for (const action of this.viewer.animator.actions) action.play();
    const find = (path) => this.viewer.scene_tree.find(path).object;
    this.roots = this.scenes.map((scene) => scene && find(scene.root));
    this.joints = this.scenes.map((scene) => {
      const nodes = Object.create(null);
      for (const [name, path] of Object.entries(scene ? scene.joints : {})) nodes[name] = find(path);
      return nodes;
    });
    this.traces = this.scenes.flatMap((scene) => (scene ? scene.traces : [])).map((trace) => ({ trace, past: find([...trace.path, "<object>"]) }));
    for (const { trace } of this.traces) find(trace.path.slice(0, -1)).traverse((node) => (node.castShadow = false));
    this.start = Math.min(...runs.map((run) => run.start));
    this.addGhosts();
    this.camera = new Camera(this);
    this.extra = addLight(this.viewer, this.camera.box());
    this.grid = addGround(this.extra, this.camera.box(), this.scenes.find(Boolean).ground);
    this.contacts = this.scenes.map((scene, k) => (scene ? new ContactsView(this.roots[k], scene, runs[k].colors) : null));
    this.recolor();
    new ResizeObserver(() => this.resize()).observe(pane);
    this.resize();
  }

  recolor() {
    colorStage(this.viewer, this.grid, this.theme);
  }

  // Every solution after the first is tinted; as a ghost it is translucent as well.
  addGhosts() {
    const tint = new MeshCat.THREE.Color();
    this.ghosts = [];
    this.roots.forEach((root, k) => {
      if (!root || k === 0) return;
      tint.set(this.runs[k].tint);
      root.traverse((node) => {
        if (!node.isMesh || node.material.opacity < 0.5 || !isLink(node)) return;
        node.material.color.lerp(tint, 0.6);
        this.ghosts.push(node);
      });
    });
    this.setApart(false);
  }

  // Side by side, or one in the other.
  setApart(apart) {
    this.apart = apart;
    for (const { material } of this.ghosts) {
      // Pushed back, so that a ghost in the same place does not shine through.
      Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 });
      Object.assign(material, { transparent: !apart, opacity: apart ? 1 : 0.38, depthWrite: apart, needsUpdate: true });
    }
    const known = this.scenes.filter(Boolean);
    const axis = this.camera ? this.camera.across() : [1, 0, 0];
    const width = (scene) => axis.reduce((sum, a, i) => sum + Math.abs(a) * extentOf(scene.hull, i), 0);
    let place = 0;
    this.offsets = this.scenes.map((scene, k) => {
      const offset = axis.map((a) => (apart ? a * place : 0));
      if (scene) place += 1.15 * (width(scene) / 2 + width(known[k + 1] || scene) / 2);
      return offset;
    });
    this.roots.forEach((root, k) => root && root.position.set(...this.offsets[k]));
    this.viewer.set_dirty();
  }

  resize() {
    this.viewer.camera.fov = 38;
    this.viewer.set_3d_pane_size();
    if (!this.camera.moved) this.camera.home();
    this.draw();
  }

  seek(t) {
    this.viewer.animator.seek(t - this.start);
    this.viewer.animator.display_progress(t - this.start);
    for (const { trace, past } of this.traces) {
      const rings = trace.times.length;
      const perRing = past.geometry.index.count / (rings - 1);
      const passed = trace.times.filter((stamp) => stamp <= t + 1e-9).length - 1;
      past.geometry.setDrawRange(0, Math.max(passed, 0) * perRing);
    }
    this.contacts.forEach((contacts, k) => contacts && contacts.seek(Math.min(t, this.runs[k].end), this.scenes[k].clearance));
    if (this.onSeek) this.onSeek(t);
    this.camera.keepUp();
    this.viewer.set_dirty();
  }

  draw() {
    if (this.viewer.needs_render) this.viewer.render();
  }

  // World positions [m] and quaternions (x, y, z, w) of the joints of one solution.
  poses(run) {
    const T = MeshCat.THREE;
    this.viewer.scene.updateMatrixWorld(true);
    const back = this.viewer.scene.matrixWorld.clone().invert();
    const result = Object.create(null);
    for (const [name, node] of Object.entries(this.joints[run])) {
      const [p, q, s] = [new T.Vector3(), new T.Quaternion(), new T.Vector3()];
      back.clone().multiply(node.matrixWorld).decompose(p, q, s);
      result[name] = { position: p.toArray(), quaternion: q.toArray() };
    }
    return result;
  }
}
