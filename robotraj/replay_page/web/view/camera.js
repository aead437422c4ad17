"use strict";
// The camera: it frames all solutions over the whole motion, or moves along with the first robot.

// three.js has y up, the scene is turned: world (x, y, z) is drawn at (x, z, -y).
function drawn([x, y, z]) {
  return new MeshCat.THREE.Vector3(x, z, -y);
}

function extentOf(points, axis) {
  const values = points.map((p) => p[axis]);
  return Math.max(...values) - Math.min(...values);
}

class Camera {
  constructor(view) {
    Object.assign(this, { view, viewer: view.viewer, moved: false, followed: null });
    this.viewer.controls.addEventListener("start", () => (this.moved = true));
    // OrbitControls takes every touch for itself; scrolling the page past the robot must stay possible.
    this.viewer.controls.domElement.style.touchAction = "pan-y";
  }

  // The outermost points of all solutions over their motions, with the obstacles near them, where they are drawn.
  hull() {
    const placed = (points, k) => points.map((p) => p.map((x, i) => x + this.view.offsets[k][i]));
    return this.view.scenes.flatMap((scene, k) => (scene ? placed([...scene.hull, ...scene.surroundings], k) : []));
  }

  // The box along the world's axes around these points [m].
  box() {
    const points = this.hull();
    const low = [0, 1, 2].map((i) => Math.min(...points.map((p) => p[i])));
    const high = [0, 1, 2].map((i) => Math.max(...points.map((p) => p[i])));
    const center = low.map((x, i) => (x + high[i]) / 2);
    const extent = low.map((x, i) => high[i] - x);
    return { center, extent, radius: Math.max(Math.hypot(...extent) / 2, 0.05) };
  }

  // A planar mechanism is seen square on, a spatial one from the front right, above.
  direction() {
    const hull = this.view.scenes.find(Boolean).hull;
    const extent = [0, 1, 2].map((i) => extentOf(hull, i));
    const widest = Math.max(...extent);
    if (extent[1] < 0.4 * widest && extent[1] <= extent[0]) return [0.3, -1, 0.28];
    if (extent[0] < 0.4 * widest) return [1, -0.3, 0.28];
    return [0.95, -0.85, 0.55];
  }

  // The horizontal axis of the world that lies most across the view.
  across() {
    const [x, y] = this.direction();
    return Math.abs(y) >= Math.abs(x) ? [1, 0, 0] : [0, 1, 0];
  }

  home() {
    const { center, radius } = this.box();
    const camera = this.viewer.camera;
    const half = ((camera.fov / 2) * Math.PI) / 180;
    const toward = drawn(this.direction()).normalize();
    camera.near = radius / 100;
    camera.far = radius * 100;
    const right = new MeshCat.THREE.Vector3(0, 1, 0).cross(toward).normalize();
    const up = toward.clone().cross(right);
    const points = this.hull().map((p) => drawn(p));
    const target = drawn(center);
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

  get body() {
    const scene = this.view.scenes[0];
    return scene && scene.body ? this.view.joints[0][scene.body] : null;
  }

  // Where the body is that the root moves, as drawn; along the ground alone.
  bodyPlace() {
    const node = this.body;
    node.updateWorldMatrix(true, false);
    return new MeshCat.THREE.Vector3().setFromMatrixPosition(node.matrixWorld).setY(0);
  }

  // Keep the camera beside the robot as it moves along, close enough to fill the view.
  follow(wanted) {
    this.followed = wanted && this.body ? this.bodyPlace() : null;
    byId("follow").setAttribute("aria-pressed", String(this.followed !== null));
    if (!this.followed) return;
    const { camera, controls } = this.viewer;
    const toward = camera.position.clone().sub(controls.target).normalize();
    const { center } = this.box();
    controls.target.copy(this.followed).setY(drawn(center).y);
    const half = Math.tan(((camera.fov / 2) * Math.PI) / 180) * Math.min(1, camera.aspect);
    camera.position.copy(controls.target).addScaledVector(toward, (0.85 * this.view.scenes[0].stature) / half);
    this.moved = true;
    controls.update();
    this.viewer.set_dirty();
  }

  keepUp() {
    if (!this.followed) return;
    const now = this.bodyPlace();
    const step = now.clone().sub(this.followed);
    this.followed = now;
    this.viewer.controls.target.add(step);
    this.viewer.camera.position.add(step);
    this.viewer.controls.update();
  }

  // Place and target as six numbers, for links.
  get placed() {
    const { camera, controls } = this.viewer;
    return [...camera.position.toArray(), ...controls.target.toArray()];
  }

  set placed(values) {
    const { camera, controls } = this.viewer;
    camera.position.fromArray(values);
    controls.target.fromArray(values, 3);
    this.moved = true;
    controls.update();
    this.viewer.set_dirty();
  }
}
