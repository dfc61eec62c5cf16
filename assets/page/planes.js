"use strict";
// Measuring planes: a layer in 3D with a field for each sensor in false colours, and what they tell as tables.
// `planes` are those of the facts, `values` what their sensors show, plane after plane; `material` draws numbers, see shaders.js.
const patchlightPlanes = (planes, values, material) => {
  // Two triangles for each field that was measured.
  const [positions, shown, index, sensors] = [[], [], [], []];
  let first = 0;
  planes.forEach((plane, number) => {
    const [columns, rows] = plane.counts;
    const at = (column, row) => plane.origin.map((x, k) => x + (column / columns) * plane.edges[0][k] + (row / rows) * plane.edges[1][k]);
    for (let sensor = 0; sensor < columns * rows; sensor++) {
      const value = values[first + sensor];
      if (Number.isNaN(value)) continue;
      const [column, row] = [sensor % columns, Math.floor(sensor / columns)];
      const corner = positions.length / 3;
      [[0, 0], [1, 0], [1, 1], [0, 1]].forEach(([right, up]) => positions.push(...at(column + right, row + up)));
      shown.push(value, value, value, value);
      index.push(corner, corner + 1, corner + 2, corner, corner + 2, corner + 3);
      sensors.push([number, value]);
    }
    first += columns * rows;
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(positions), 3));
  geometry.setAttribute("radiance", new THREE.BufferAttribute(new Float32Array(positions.length), 3));
  geometry.setAttribute("shown", new THREE.BufferAttribute(new Float32Array(shown), 1));
  geometry.setIndex(index);
  const mesh = new THREE.Mesh(geometry, material);

  // What a ray meets of them: its distance, and words.
  const hit = (ray) => {
    const found = mesh.visible && ray.intersectObject(mesh)[0];
    if (!found) return null;
    const [number, value] = sensors[Math.floor(found.faceIndex / 2)];
    return { distance: found.distance, point: found.point, value, plane: planes[number] };
  };
  return { mesh, hit, largest: shown.reduce((most, value) => Math.max(most, value), 0) };
};

// A table for each plane: rows of name and text.
const patchlightPlaneRows = (plane, { short, percent }) => {
  const { summary, unit, outdoors, counts } = plane;
  const [columns, rows] = counts;
  if (!summary) return [["sensors", `none of ${columns} x ${rows} measured`]];
  const error = Number.isFinite(summary.standard_error) ? ` ± ${short(Number(summary.standard_error.toPrecision(2)))}` : "";
  const told = [
    ["sensors measured", `${summary.count} of ${columns} x ${rows}`],
    [`mean ${plane.quantity}`, `${short(summary.mean)}${error} ${unit}`],
    ["minimum", `${short(summary.minimum)} ${unit}`],
    ["maximum", `${short(summary.maximum)} ${unit}`],
    ["uniformity, minimum / mean", summary.uniformity.toFixed(3)],
  ];
  if (outdoors === null) return told;
  const factor = summary.daylight_factor;
  told.push(["under the open sky", `${short(outdoors)} ${unit}`]);
  told.push(["daylight factor, mean", factor ? percent(factor[0]) : "not known: not all light is the sky's"]);
  if (factor) told.push(["daylight factor, minimum", percent(factor[1])]);
  return told;
};
