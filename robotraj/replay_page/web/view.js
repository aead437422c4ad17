"use strict";
// The 3D view: meshcat's viewer fed from recorded commands, framed and lit for the robot.

class View {
  constructor(pane, scene, packets, colors) {
    this.scene = scene;
    this.pane = pane;
    this.viewer = new MeshCat.Viewer(pane, false);
    const own = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => own(pane.clientWidth || 1, pane.clientHeight || 1);
    this.hideDefaults();
    this.replayCommands(packets);
    // An action follows seek() only once it was played; the page keeps its own clock.
    for (const action of this.viewer.animator.actions) action.play();
    this.joints = Object.create(null);
    for (const [name, path] of Object.entries(scene.joints)) this.joints[name] = this.viewer.scene_tree.find(path).object;
    this.past = scene.traces.map((trace) => this.viewer.scene_tree.find([...trace.path, "<object>"]).object);
    for (const trace of scene.traces) {
      const lines = this.viewer.scene_tree.find(trace.path.slice(0, -1)).object;
      lines.traverse((node) => (node.castShadow = false));
    }
    this.addLight();
    this.addGround();
    this.contacts = new ContactsView(this.viewer, scene, colors);
    this.moved = false;
    this.listen(this.viewer.controls);
    new ResizeObserver(() => this.resize()).observe(pane);
    this.resize();
  }

  hideDefaults() {
    const set = (path, key, value) => this.viewer.set_property(path, key, value);
    set(["Background"], "top_color", [0.985, 0.99, 0.995]);
    set(["Background"], "bottom_color", [0.87, 0.895, 0.92]);
    for (const name of ["Grid", "Axes"]) set([name], "visible", false);
    for (const name of ["PointLightNegativeX", "PointLightPositiveX"]) set(["Lights", name], "visible", false);
    set(["Lights", "AmbientLight", "<object>"], "intensity", 0.47);
    set(["Lights", "FillLight", "<object>"], "intensity", 0.14);
    this.viewer.show_background();
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

  // The box along the world's axes around the robot's outermost points over the motion [m].
  box() {
    const low = [0, 1, 2].map((i) => Math.min(...this.scene.hull.map((p) => p[i])));
    const high = [0, 1, 2].map((i) => Math.max(...this.scene.hull.map((p) => p[i])));
    const center = low.map((x, i) => (x + high[i]) / 2);
    const extent = low.map((x, i) => high[i] - x);
    return { center, extent, radius: Math.max(Math.hypot(...extent) / 2, 0.05) };
  }

  // three.js has y up, the scene is turned: world (x, y, z) is drawn at (x, z, -y).
  static drawn([x, y, z]) {
    return new MeshCat.THREE.Vector3(x, z, -y);
  }

  addLight() {
    const { center, radius } = this.box();
    const light = new MeshCat.THREE.DirectionalLight(0xffffff, 0.5);
    light.position.copy(View.drawn([center[0] + 1.1 * radius, center[1] - 1.5 * radius, center[2] + 2.6 * radius]));
    light.target.position.copy(View.drawn(center));
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
    const { center, radius } = this.box();
    const { level, surface } = this.scene.ground;
    if (surface) return;
    const power = 10 ** Math.floor(Math.log10(radius / 4));
    const step = [1, 2, 5, 10].map((f) => f * power).find((f) => f >= radius / 4);
    const cells = 2 * Math.ceil((5 * radius) / step);
    const grid = new T.GridHelper(cells * step, cells, 0xaab4c0, 0xced6de);
    const middle = [Math.round(center[0] / step) * step, Math.round(center[1] / step) * step, level];
    grid.position.copy(View.drawn(middle));
    grid.material.transparent = true;
    grid.material.opacity = 0.75;
    grid.material.depthWrite = false;
    const floor = new T.Mesh(new T.PlaneGeometry(cells * step, cells * step), new T.ShadowMaterial({ opacity: 0.2 }));
    floor.rotation.x = -Math.PI / 2;
    floor.position.copy(View.drawn([middle[0], middle[1], level - 1e-3 * radius]));
    floor.receiveShadow = true;
    floor.material.depthWrite = false;
    this.extra.add(grid, floor);
  }

  listen(controls) {
    controls.addEventListener("start", () => (this.moved = true));
  }

  // A planar mechanism is seen square on, a spatial one from the front right, above.
  direction() {
    const { extent } = this.box();
    const widest = Math.max(...extent);
    if (extent[1] < 0.4 * widest && extent[1] <= extent[0]) return [0.3, -1, 0.28];
    if (extent[0] < 0.4 * widest) return [1, -0.3, 0.28];
    return [0.95, -0.85, 0.55];
  }

  home() {
    const { center, radius } = this.box();
    const camera = this.viewer.camera;
    const half = ((camera.fov / 2) * Math.PI) / 180;
    const toward = View.drawn(this.direction()).normalize();
    camera.near = radius / 100;
    camera.far = radius * 100;
    const right = new MeshCat.THREE.Vector3(0, 1, 0).cross(toward).normalize();
    const up = toward.clone().cross(right);
    const points = this.scene.hull.map((p) => View.drawn(p));
    const target = View.drawn(center);
    let distance = 0;
    // Shift the target until the outermost points are centred on the screen, at the distance that shows them all.
    for (let round = 0; round < 6; round++) {
      const seen = points.map((p) => {
        const arm = p.clone().sub(target);
        return { x: arm.dot(right), y: arm.dot(up), z: arm.dot(toward) };
      });
      const need = ({ x, y, z }) => z + Math.max(Math.abs(y) / Math.tan(half), Math.abs(x) / (Math.tan(half) * camera.aspect));
      distance = Math.max(...seen.map(need), 0.3 * radius);
      for (const [axis, key] of [[right, "x"], [up, "y"]]) {
        const slopes = seen.map((s) => s[key] / (distance - s.z + 1e-9));
        target.addScaledVector(axis, (distance * (Math.min(...slopes) + Math.max(...slopes))) / 2);
      }
    }
    this.viewer.controls.target.copy(target);
    camera.position.copy(target).addScaledVector(toward, 1.14 * distance);
    this.moved = false;
    this.follow(false);
    this.viewer.controls.update();
    this.viewer.set_dirty();
  }

  // Where the body is that the root moves, as drawn; along the ground alone.
  body() {
    const node = this.joints[this.scene.body];
    node.updateWorldMatrix(true, false);
    return new MeshCat.THREE.Vector3().setFromMatrixPosition(node.matrixWorld).setY(0);
  }

  // Keep the camera beside the robot as it moves along, close enough to fill the view.
  follow(wanted) {
    this.followed = wanted ? this.body() : null;
    byId("follow").setAttribute("aria-pressed", String(wanted));
    if (!wanted) return;
    const { camera, controls } = this.viewer;
    const toward = camera.position.clone().sub(controls.target).normalize();
    const { center } = this.box();
    controls.target.copy(this.followed).setY(View.drawn(center).y);
    const half = Math.tan(((camera.fov / 2) * Math.PI) / 180) * Math.min(1, camera.aspect);
    camera.position.copy(controls.target).addScaledVector(toward, (0.85 * this.scene.stature) / half);
    this.moved = true;
    controls.update();
    this.viewer.set_dirty();
  }

  keepUp() {
    const now = this.body();
    const step = now.clone().sub(this.followed);
    this.followed = now;
    this.viewer.controls.target.add(step);
    this.viewer.camera.position.add(step);
    this.viewer.controls.update();
  }

  resize() {
    this.viewer.camera.fov = 38;
    this.viewer.set_3d_pane_size();
    if (!this.moved) this.home();
    this.draw();
  }

  seek(t) {
    this.viewer.animator.seek(t - this.scene.start);
    this.viewer.animator.display_progress(t - this.scene.start);
    this.scene.traces.forEach((trace, i) => {
      const geometry = this.past[i].geometry;
      const rings = trace.times.length;
      const perRing = geometry.index.count / (rings - 1);
      const passed = trace.times.filter((stamp) => stamp <= t + 1e-9).length - 1;
      geometry.setDrawRange(0, Math.max(passed, 0) * perRing);
    });
    this.contacts.seek(t, this.scene.clearance);
    if (this.followed) this.keepUp();
    this.viewer.set_dirty();
  }

  draw() {
    if (this.viewer.needs_render) this.viewer.render();
  }

  poses() {
    const T = MeshCat.THREE;
    this.viewer.scene.updateMatrixWorld(true);
    const back = this.viewer.scene.matrixWorld.clone().invert();
    const result = Object.create(null);
    for (const [name, node] of Object.entries(this.joints)) {
      const [p, q, s] = [new T.Vector3(), new T.Quaternion(), new T.Vector3()];
      back.clone().multiply(node.matrixWorld).decompose(p, q, s);
      result[name] = { position: p.toArray(), quaternion: q.toArray() };
    }
    return result;
  }
}
