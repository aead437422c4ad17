"use strict";
// The 3D view: meshcat's viewer fed from recorded commands, lit for the robot. camera.js frames it.

class View {
  constructor(pane, runs, packets, theme) {
    Object.assign(this, { pane, runs, theme, apart: false });
    this.scenes = runs.map((run) => run.scene);
    this.viewer = new MeshCat.Viewer(pane, false);
    const own = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => own(pane.clientWidth || 1, pane.clientHeight || 1);
    // A finger that moves up or down scrolls the page past the robot; sideways it turns the camera.
    pane.style.touchAction = "pan-y";
    this.replayCommands(packets);
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
    this.addLight();
    this.addGround();
    this.contacts = this.scenes.map((scene, k) => (scene ? new ContactsView(this.roots[k], scene, runs[k].colors) : null));
    this.recolor();
    new ResizeObserver(() => this.resize()).observe(pane);
    this.resize();
  }

  // Colours of background and grid; lights of the viewer that the page replaces.
  recolor() {
    const set = (path, key, value) => this.viewer.set_property(path, key, value);
    const parts = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
    set(["Background"], "top_color", parts(this.theme.sky));
    set(["Background"], "bottom_color", parts(this.theme.earth));
    for (const name of ["Grid", "Axes"]) set([name], "visible", false);
    for (const name of ["PointLightNegativeX", "PointLightPositiveX"]) set(["Lights", name], "visible", false);
    set(["Lights", "AmbientLight", "<object>"], "intensity", 0.47);
    set(["Lights", "FillLight", "<object>"], "intensity", 0.14);
    this.viewer.show_background();
    if (this.grid) this.grid.material.color.set(this.theme.meshGrid);
    this.viewer.set_dirty();
  }

  // Packets: length (4 bytes, little endian), then msgpack. A geometry sent before comes back by its uuid.
  replayCommands(packets) {
    const shared = new Map();
    const handle = this.viewer.handle_command.bind(this.viewer);
    this.viewer.handle_command = (command) => {
      if (command.type === "set_object") {
        const list = command.object.geometries;
        list.forEach((g, i) => {
          if (g.type === "shared") list[i] = shared.get(g.uuid);
          else shared.set(g.uuid, g);
        });
      }
      handle(command);
    };
    const words = new DataView(packets.buffer, packets.byteOffset, packets.byteLength);
    for (let at = 0; at < packets.byteLength; ) {
      const length = words.getUint32(at, true);
      this.viewer.handle_command_bytearray(packets.subarray(at + 4, at + 4 + length));
      at += 4 + length;
    }
  }

  // Every solution after the first is tinted; as a ghost it is translucent as well.
  addGhosts() {
    const tint = new MeshCat.THREE.Color();
    this.ghosts = [];
    this.roots.forEach((root, k) => {
      if (!root || k === 0) return;
      tint.set(this.runs[k].tint);
      root.traverse((node) => {
        if (!node.isMesh || node.material.opacity < 0.5) return;
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

  addLight() {
    const { center, radius } = this.camera.box();
    const light = new MeshCat.THREE.DirectionalLight(0xffffff, 0.5);
    light.position.copy(drawn([center[0] + 1.1 * radius, center[1] - 1.5 * radius, center[2] + 2.6 * radius]));
    light.target.position.copy(drawn(center));
    light.castShadow = true;
    light.shadow.mapSize.set(2048, 2048);
    light.shadow.bias = -0.0012;
    light.shadow.normalBias = 0.008 * radius;
    light.shadow.radius = 4;
    const reach = 1.7 * radius;
    Object.assign(light.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.01 * radius, far: 9 * radius });
    // Meshcat's tree lives in the turned scene; lights and ground of the page hang on an unturned group of it.
    this.extra = new MeshCat.THREE.Group();
    this.extra.rotation.x = Math.PI / 2;
    this.extra.add(light, light.target);
    this.viewer.scene.add(this.extra);
  }

  addGround() {
    const T = MeshCat.THREE;
    const { center, radius } = this.camera.box();
    const { level, surface } = this.scenes.find(Boolean).ground;
    if (surface) return;
    const power = 10 ** Math.floor(Math.log10(radius / 4));
    const step = [1, 2, 5, 10].map((f) => f * power).find((f) => f >= radius / 4);
    const cells = 2 * Math.ceil((5 * radius) / step);
    const grid = new T.GridHelper(cells * step, cells, 0xffffff, 0xffffff);
    const middle = [Math.round(center[0] / step) * step, Math.round(center[1] / step) * step, level];
    grid.position.copy(drawn(middle));
    Object.assign(grid.material, { transparent: true, opacity: 0.6, depthWrite: false });
    const floor = new T.Mesh(new T.PlaneGeometry(cells * step, cells * step), new T.ShadowMaterial({ opacity: 0.2 }));
    floor.rotation.x = -Math.PI / 2;
    floor.position.copy(drawn([middle[0], middle[1], level - 1e-3 * radius]));
    floor.receiveShadow = true;
    floor.material.depthWrite = false;
    this.grid = grid;
    this.extra.add(grid, floor);
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
