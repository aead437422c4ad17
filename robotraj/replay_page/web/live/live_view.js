"use strict";
// The robot along one iterate: poses of its joints at samples of the motion, repeated while the next one is computed.

const NUMBERS = 7;

class LiveView {
  // Camera needs the scenes of all solutions and their offsets; here there is one.
  constructor(pane, scene, packets, theme) {
    Object.assign(this, { scenes: [scene], offsets: [[0, 0, 0]], joints: [Object.create(null)], theme });
    this.viewer = new MeshCat.Viewer(pane, false);
    const own = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => own(pane.clientWidth || 1, pane.clientHeight || 1);
    replayCommands(this.viewer, packets);
    this.nodes = Object.entries(scene.joints).map(([joint, path]) => [Number(joint), this.viewer.scene_tree.find(path).object]);
    this.camera = new Camera(this);
    this.grid = addGround(addLight(this.viewer, this.camera.box()), this.camera.box(), scene.ground);
    this.paths = scene.tips.map(({ color }) => {
      const line = new MeshCat.THREE.Line(new MeshCat.THREE.BufferGeometry(), new MeshCat.THREE.LineBasicMaterial({ color }));
      line.frustumCulled = false;
      this.viewer.scene.add(line);
      return line;
    });
    this.recolor();
    new ResizeObserver(() => this.resize()).observe(pane);
    this.resize();
  }

  recolor() {
    colorStage(this.viewer, this.grid, this.theme);
  }

  resize() {
    this.viewer.camera.fov = 38;
    this.viewer.set_3d_pane_size();
    if (!this.camera.moved) this.camera.home();
  }

  // Take an iterate: float32 in base64, (samples, joints, 7), with its duration [s].
  take({ poses, samples, duration }) {
    const bytes = Uint8Array.from(atob(poses), (c) => c.charCodeAt(0));
    Object.assign(this, { values: new Float32Array(bytes.buffer), samples, duration });
    this.width = this.values.length / samples;
    this.scenes[0].tips.forEach((tip, k) => {
      const points = Array.from({ length: samples }, (_, sample) => this.tip(tip, sample));
      this.paths[k].geometry.setFromPoints(points);
    });
    this.viewer.set_dirty();
  }

  // Position and quaternion of a joint at one sample.
  pose(joint, sample) {
    const at = sample * this.width + NUMBERS * (joint - 1);
    const [x, y, z, qx, qy, qz, qw] = this.values.subarray(at, at + NUMBERS);
    return [new MeshCat.THREE.Vector3(x, y, z), new MeshCat.THREE.Quaternion(qx, qy, qz, qw)];
  }

  tip({ joint, offset }, sample) {
    const arm = new MeshCat.THREE.Vector3(...offset);
    if (joint === 0) return arm;
    const [position, quaternion] = this.pose(joint, sample);
    return arm.applyQuaternion(quaternion).add(position);
  }

  // Place the joints at a share of the motion, between two samples.
  show(share) {
    if (!this.values) return;
    const place = Math.min(Math.max(share, 0), 1) * (this.samples - 1);
    const low = Math.min(Math.floor(place), this.samples - 2);
    for (const [joint, node] of this.nodes) {
      const [[p, q], [end, turn]] = [this.pose(joint, low), this.pose(joint, low + 1)];
      node.position.copy(p.lerp(end, place - low));
      node.quaternion.copy(q.slerp(turn, place - low));
    }
    this.viewer.set_dirty();
  }

  draw() {
    if (this.viewer.needs_render) this.viewer.render();
  }
}
