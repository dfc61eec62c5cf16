"use strict";
// Lines of several kinds in their colours: of each kind in turn how many there are and its colour, and all ends.
const patchlightSegments = (kinds, ends) => {
  const colours = new Float32Array(ends.length);
  let first = 0;
  kinds.forEach(([count, [r, g, b]]) => {
    const colour = new THREE.Color((r << 16) | (g << 8) | b);
    for (let end = 0; end < 2 * count; end++, first++) colours.set([colour.r, colour.g, colour.b], 3 * first);
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(ends, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: true }));
};
