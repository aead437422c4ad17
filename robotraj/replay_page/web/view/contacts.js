"use strict";
// Contacts in the 3D view: forces as arrows, friction cones at the footholds, impulses of impacts, required heights.

const ASKED = 0x23854a;
const IMPULSE = 0x6a1fb0;

// An arrow in world coordinates, seen through the robot.
class Arrow {
  constructor(parent, color, thickness) {
    const T = MeshCat.THREE;
    this.thickness = thickness;
    this.material = new T.MeshBasicMaterial({ color, depthTest: false, transparent: true });
    this.shaft = new T.Mesh(new T.CylinderGeometry(1, 1, 1, 20), this.material);
    this.head = new T.Mesh(new T.ConeGeometry(1, 1, 28), this.material);
    this.group = new T.Group();
    this.group.add(this.shaft, this.head);
    this.group.visible = false;
    for (const mesh of [this.shaft, this.head]) mesh.renderOrder = 20;
    parent.add(this.group);
  }

  // From a point along a vector [m], both (3).
  set(from, vector) {
    const T = MeshCat.THREE;
    const length = Math.hypot(...vector);
    this.group.visible = length > 0.2 * this.thickness;
    if (!this.group.visible) return;
    const head = Math.min(5 * this.thickness, 0.5 * length);
    this.group.position.set(...from);
    this.group.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), new T.Vector3(...vector).normalize());
    this.shaft.scale.set(this.thickness, length - head, this.thickness);
    this.shaft.position.y = (length - head) / 2;
    this.head.scale.set(0.42 * head, head, 0.42 * head);
    this.head.position.y = length - head / 2;
  }

  hide() {
    this.group.visible = false;
  }
}

class ContactsView {
  // The root of a solution has world coordinates; colors are those of the contacts by name.
  constructor(root, scene, colors) {
    const T = MeshCat.THREE;
    this.data = scene.contacts;
    this.group = new T.Group();
    root.add(this.group);
    this.curves = scene.clearance.map((curve) => this.addCurve(curve, scene)).filter(Boolean);
    this.cones = [];
    if (!this.data) return;
    this.scale = this.data.length / this.data.unit;
    const thickness = 0.032 * this.data.length;
    this.arrows = this.data.names.map((name) => new Arrow(this.group, colors[name], thickness));
    this.cones = this.data.cones.map((cone) => this.addCone(cone, colors[this.data.names[cone.foot]]));
    this.soles = this.data.cones.map((cone) => this.addSole(cone, colors[this.data.names[cone.foot]]));
    this.blows = this.data.impacts.map(() => new Arrow(this.group, IMPULSE, 1.3 * thickness));
  }

  addCone({ apex, normal, angle }, color) {
    const T = MeshCat.THREE;
    const slant = 0.5 * this.data.length;
    const [radius, height] = [slant * Math.sin(angle), slant * Math.cos(angle)];
    const cone = new T.Group();
    const look = { color, transparent: true, opacity: 0.2, side: T.DoubleSide, depthWrite: false };
    const mantle = new T.Mesh(new T.ConeGeometry(radius, height, 64, 1, true), new T.MeshBasicMaterial(look));
    const ring = [...Array(64).keys()].map((k) => {
      const turn = (2 * Math.PI * k) / 64;
      return new T.Vector3(radius * Math.cos(turn), -height / 2, radius * Math.sin(turn));
    });
    const rim = new T.LineLoop(new T.BufferGeometry().setFromPoints(ring), new T.LineBasicMaterial({ color }));
    // three.js has the apex of a cone on its +y; here it stands on the ground.
    cone.add(mantle, rim);
    cone.quaternion.setFromUnitVectors(new T.Vector3(0, -1, 0), new T.Vector3(...normal));
    cone.userData.middle = normal.map((x) => (x * height) / 2);
    this.place(cone, apex);
    this.group.add(cone);
    return cone;
  }

  // Outline of a flat foot where it stands, a little above the ground; null for other contacts.
  addSole({ sole, normal }, color) {
    if (!sole.length) return null;
    const T = MeshCat.THREE;
    const lift = new T.Vector3(...normal).multiplyScalar(4e-3 * this.data.length);
    const corners = [0, 1, 2, 3].map((k) => new T.Vector3(...sole.slice(3 * k, 3 * k + 3)).add(lift));
    const shape = new T.BufferGeometry().setFromPoints(corners);
    shape.setIndex([0, 1, 2, 0, 2, 3]);
    const look = { color, transparent: true, opacity: 0.35, side: T.DoubleSide, depthWrite: false };
    const group = new T.Group();
    group.add(new T.Mesh(shape, new T.MeshBasicMaterial(look)));
    group.add(new T.LineLoop(new T.BufferGeometry().setFromPoints(corners), new T.LineBasicMaterial({ color })));
    this.group.add(group);
    return group;
  }

  place(cone, apex) {
    cone.position.set(...apex.map((x, i) => x + cone.userData.middle[i]));
  }

  // The required height as a line, and a curtain from it down to the ground.
  addCurve({ points, ground }, scene) {
    const T = MeshCat.THREE;
    const all = ground.map((z, k) => ({ line: new T.Vector3(...points.slice(3 * k, 3 * k + 3)), ground: z }));
    const size = Math.hypot(...[0, 1, 2].map((i) => Math.max(...scene.hull.map((p) => p[i])) - Math.min(...scene.hull.map((p) => p[i]))));
    const kept = all.filter((p, k) => k === 0 || p.line.distanceTo(all[k - 1].line) > 1e-4 * size);
    if (kept.length < 3) return null;
    const curve = new T.Group();
    const path = new T.CatmullRomCurve3(kept.map((p) => p.line));
    const line = new T.Mesh(
      new T.TubeGeometry(path, 2 * kept.length, 1.2e-3 * size, 6),
      new T.MeshBasicMaterial({ color: ASKED, transparent: true }),
    );
    const corners = kept.flatMap((p) => [p.line.x, p.line.y, p.line.z, p.line.x, p.line.y, p.ground]);
    const faces = kept.slice(1).flatMap((_, k) => [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 1, 2 * k + 3, 2 * k + 2]);
    const sheet = new T.BufferGeometry();
    sheet.setAttribute("position", new T.Float32BufferAttribute(corners, 3));
    sheet.setIndex(faces);
    const look = { color: ASKED, transparent: true, side: T.DoubleSide, depthWrite: false };
    const curtain = new T.Mesh(sheet, new T.MeshBasicMaterial(look));
    curve.add(line, curtain);
    this.group.add(curve);
    return { line: line.material, curtain: curtain.material };
  }

  seek(t, clearance) {
    this.curves.forEach((curve, k) => {
      const now = t >= clearance[k].start && t <= clearance[k].end;
      curve.line.opacity = now ? 1 : 0.3;
      curve.curtain.opacity = now ? 0.2 : 0.06;
    });
    if (!this.data) return;
    this.cones.forEach((cone, k) => {
      const { start, end, foot, stays } = this.data.cones[k];
      cone.visible = t >= start && t <= end;
      if (this.soles[k]) this.soles[k].visible = cone.visible;
      // A contact that may slip takes its cone along.
      if (cone.visible && !stays) this.place(cone, this.force(foot, t).at);
    });
    this.arrows.forEach((arrow, foot) => {
      const found = this.force(foot, t);
      if (found) arrow.set(found.at, found.force.map((f) => f * this.scale));
      else arrow.hide();
    });
    // An impulse is shown from shortly before it to a while after it, fading.
    this.blows.forEach((arrow, k) => {
      const { t: when, p, impulse } = this.data.impacts[k];
      const late = t - when;
      arrow.hide();
      if (late < -0.01 || late > 0.2) return;
      arrow.set(p, impulse.map((x) => (x / this.data.impulseTime) * this.scale));
      arrow.material.opacity = 1 - Math.max(late, 0) / 0.2;
    });
  }

  // Where a contact's force acts at a time [m] and the force [N]; null while it is not held.
  force(foot, t) {
    const span = this.data.forces.filter((f) => f.foot === foot && t >= f.t[0] - 1e-9 && t <= f.t[f.t.length - 1] + 1e-9).pop();
    if (!span) return null;
    const next = span.t.findIndex((stamp) => stamp > t);
    const high = next < 0 ? span.t.length - 1 : Math.max(next, 1);
    const width = span.t[high] - span.t[high - 1];
    const share = width > 0 ? Math.min(1, Math.max(0, (t - span.t[high - 1]) / width)) : 1;
    const mix = (list) => [0, 1, 2].map((i) => (1 - share) * list[3 * high - 3 + i] + share * list[3 * high + i]);
    return { at: mix(span.p), force: mix(span.f) };
  }

  // Scales and their marks: [sign, colour, text].
  marks() {
    const list = [];
    const short = (x) => (x >= 100 ? x.toFixed(0) : x.toPrecision(3));
    if (this.data) {
      const { unit, weight, length, impulseTime, impacts } = this.data;
      const who = weight ? "body weight" : "largest force";
      list.push(["↑", "", `contact force; ${who}, ${short(unit)} N, is ${length.toFixed(2)} m long`]);
      if (impacts.length) list.push(["⇑", "#6a1fb0", `impulse of an impact; ${short(unit * impulseTime)} N s is as long`]);
      list.push(["▽", "", "friction cone while the contact is held"]);
    }
    if (this.curves.length) list.push(["—", "#23854a", "required height"]);
    return list;
  }
}
