"use strict";
// The stage of a 3D view: recorded commands, light, ground and background.

// Packets: length (4 bytes, little endian), then msgpack. A geometry sent before comes back by its uuid.
function replayCommands(viewer, packets) {
  const shared = new Map();
  const handle = viewer.handle_command.bind(viewer);
  viewer.handle_command = (command) => {
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
    viewer.handle_command_bytearray(packets.subarray(at + 4, at + 4 + length));
    at += 4 + length;
  }
}

// Colours of background and grid; lights of the viewer that the page replaces.
function colorStage(viewer, grid, theme) {
  const set = (path, key, value) => viewer.set_property(path, key, value);
  const parts = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
  set(["Background"], "top_color", parts(theme.sky));
  set(["Background"], "bottom_color", parts(theme.earth));
  for (const name of ["Grid", "Axes"]) set([name], "visible", false);
  for (const name of ["PointLightNegativeX", "PointLightPositiveX"]) set(["Lights", name], "visible", false);
  set(["Lights", "AmbientLight", "<object>"], "intensity", 0.47);
  set(["Lights", "FillLight", "<object>"], "intensity", 0.14);
  viewer.show_background();
  if (grid) grid.material.color.set(theme.meshGrid);
  viewer.set_dirty();
}

// A light with shadows for a box {center, extent, radius} [m]; returns the group that the ground joins.
function addLight(viewer, { center, radius }) {
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
  const group = new MeshCat.THREE.Group();
  group.rotation.x = Math.PI / 2;
  group.add(light, light.target);
  viewer.scene.add(group);
  return group;
}

// A grid and a floor that takes shadows, unless the ground has a surface of its own; returns the grid.
function addGround(group, { center, radius }, { level, surface }) {
  if (surface) return null;
  const T = MeshCat.THREE;
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
  group.add(grid, floor);
  return grid;
}
