"use strict";
// Pick a joint in the 3D view: a click on a link selects its curves, and a marked curve lights up its link.

const CLICK = 5;

class Picker {
  constructor(view, selection, marks) {
    Object.assign(this, { view, selection, lit: [] });
    this.note = element("li", "click on a link to see its joint", "picked");
    marks.append(this.note);
    const { pane } = view;
    pane.addEventListener("pointerdown", (event) => (this.from = [event.clientX, event.clientY]));
    pane.addEventListener("pointerup", (event) => {
      if (this.from && Math.hypot(event.clientX - this.from[0], event.clientY - this.from[1]) < CLICK) this.pick(event);
    });
    selection.listen((changes) => "marked" in changes && this.light(selection.marked));
  }

  // The joint that moves what is seen at a point of the window: {joint, run}, or null.
  at(clientX, clientY) {
    const T = MeshCat.THREE;
    const box = this.view.pane.getBoundingClientRect();
    const place = new T.Vector2((2 * (clientX - box.left)) / box.width - 1, 1 - (2 * (clientY - box.top)) / box.height);
    const ray = new T.Raycaster();
    ray.setFromCamera(place, this.view.viewer.camera);
    const meshes = [];
    for (const root of this.view.roots) {
      if (root) root.traverseVisible((node) => node.isMesh && meshes.push(node));
    }
    for (const { object } of ray.intersectObjects(meshes, false)) {
      const found = this.owner(object);
      if (found) return found;
    }
    return null;
  }

  owner(object) {
    for (let node = object; node; node = node.parent) {
      for (const [run, joints] of this.view.joints.entries()) {
        const named = Object.entries(joints).find(([, own]) => own === node);
        if (named) return { joint: named[0], run };
      }
    }
    return null;
  }

  pick(event) {
    const found = this.at(event.clientX, event.clientY);
    if (!found) {
      this.selection.set({ marked: null });
      return;
    }
    const { selection } = this;
    const label = this.labelOf(found.joint);
    this.note.textContent = `joint ${found.joint}`;
    if (label === null) return;
    const own = selection.groupOf(label);
    const group = selection.group === ALL && !selection.groups[own].root ? ALL : own;
    selection.set({ group, run: found.run, isolated: null, marked: label });
  }

  // The label of a joint's curves; a root has several of its own, of which the first is taken.
  labelOf(joint) {
    const labels = this.selection.groups.flatMap((group) => group.labels);
    if (labels.includes(joint)) return joint;
    const root = this.selection.groups.find((group) => group.root);
    return labels.find((label) => label.startsWith(joint)) || (root && /root/.test(joint) ? root.labels[0] : null);
  }

  light(label) {
    for (const mesh of this.lit) mesh.material.emissive.setHex(0);
    this.lit = [];
    if (label !== null) {
      for (const joints of this.view.joints) {
        if (!joints[label]) continue;
        for (const child of joints[label].children) {
          if (/^visual /.test(child.name)) child.traverse((node) => node.isMesh && node.material.emissive && this.lit.push(node));
        }
      }
      this.note.textContent = `joint ${label}`;
    }
    for (const mesh of this.lit) mesh.material.emissive.setHex(0x1a57b0);
    this.view.viewer.set_dirty();
  }
}
