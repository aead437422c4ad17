"use strict";
// Layers of the 3D view: what is drawn of the robot and around it, each with a switch.

class Layers {
  constructor(host, view, runs) {
    Object.assign(this, { view, runs, host });
    this.things = { robot: [], collision: [], spheres: [], obstacles: [], paths: [], contacts: [], frames: [], com: [] };
    view.roots.forEach((root, k) => root && this.collect(root, k));
    this.addSwitch("robot", "robot", true);
    this.addSwitch("paths", "paths", true);
    this.addSwitch("contacts", "contacts", true);
    this.addSwitch("obstacles", "obstacles", true);
    this.addSwitch("frames", "frames", false);
    this.addSwitch("com", "centre of mass", false);
    this.addSwitch("collision", "collision shapes", false);
    this.addSwitch("spheres", "collision spheres", false);
    view.onSeek = (t) => this.moveCenters(t);
  }

  collect(root, k) {
    const scene = this.runs[k].scene;
    root.traverse((node) => {
      if (/^visual \d/.test(node.name)) this.things.robot.push(node);
      if (/^collision \d/.test(node.name)) {
        this.things.collision.push(node);
        // In front of the surface that the shape often shares with the link.
        node.traverse((mesh) => mesh.isMesh && Object.assign(mesh.material, { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2 }));
      }
      if (/^spheres \d/.test(node.name)) this.things.spheres.push(node);
      if (/^obstacle \d/.test(node.name)) this.things.obstacles.push(node);
      if (node.name === "traces") this.things.paths.push(node);
    });
    this.view.contacts[k] && this.things.contacts.push(...(scene.contacts || scene.clearance.length ? [this.view.contacts[k].group] : []));
    this.addFrames(this.view.joints[k], scene);
    if (scene.center) this.addCenter(root, scene, k);
  }

  addSwitch(name, text, on) {
    const list = this.things[name];
    if (!list.length) return;
    const made = button(text, `Show or hide: ${text}`, on, () => {
      const wanted = made.getAttribute("aria-pressed") !== "true";
      made.setAttribute("aria-pressed", String(wanted));
      this.show(name, wanted);
      if (name === "com") this.moveCenters(this.time);
    });
    made.dataset.layer = name;
    this.host.append(made);
    this.show(name, on);
  }

  show(name, on) {
    for (const node of this.things[name]) node.visible = on;
    this.view.viewer.set_dirty();
  }

  // Axes of every joint's frame: x red, y green, z blue.
  addFrames(joints, scene) {
    for (const node of Object.values(joints)) {
      const axes = new MeshCat.THREE.AxesHelper(0.09 * scene.stature);
      axes.material.depthTest = false;
      axes.renderOrder = 30;
      axes.castShadow = axes.receiveShadow = false;
      node.add(axes);
      this.things.frames.push(axes);
    }
  }

  // The centre of mass as a ball, its path, and a line down to the ground.
  addCenter(root, scene, k) {
    const T = MeshCat.THREE;
    const { p } = scene.center;
    const group = new T.Group();
    const look = (opacity) => ({ color: 0x2f7de0, depthTest: false, transparent: true, opacity });
    const ball = new T.Mesh(new T.SphereGeometry(0.022 * scene.stature, 20, 14), new T.MeshBasicMaterial(look(0.9)));
    const points = [];
    for (let i = 0; i < p.length; i += 3) points.push(new T.Vector3(p[i], p[i + 1], p[i + 2]));
    const path = new T.Line(new T.BufferGeometry().setFromPoints(points), new T.LineBasicMaterial(look(0.8)));
    const drop = new T.Line(new T.BufferGeometry().setFromPoints([new T.Vector3(), new T.Vector3()]), new T.LineBasicMaterial(look(0.8)));
    drop.frustumCulled = false;
    for (const part of [ball, path, drop]) part.renderOrder = 25;
    group.add(ball, path, drop);
    group.userData = { ball, drop, k, level: scene.ground.level };
    root.add(group);
    this.things.com.push(group);
  }

  moveCenters(t) {
    this.time = t;
    for (const { visible, userData } of this.things.com) {
      if (!visible) continue;
      const { t: times, p } = this.runs[userData.k].scene.center;
      const high = later(times, t);
      const width = times[high] - times[high - 1];
      const share = width > 0 ? Math.min(1, Math.max(0, (t - times[high - 1]) / width)) : 1;
      const at = [0, 1, 2].map((i) => (1 - share) * p[3 * high - 3 + i] + share * p[3 * high + i]);
      userData.ball.position.set(...at);
      userData.drop.geometry.attributes.position.array.set([...at, at[0], at[1], userData.level]);
      userData.drop.geometry.attributes.position.needsUpdate = true;
    }
  }
}
