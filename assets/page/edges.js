"use strict";
// The edges of elements and triangles: as lines, and in the colours of the light where pixels between elements stay empty.
const patchlightEdges = ({ positions, elements, triangles, index }, geometry) => {
  // Lines of the mesh, of colour and opacity as given.
  const lines = (color, opacity) => {
    const ends = [];
    for (let e = 0; e < elements.length; e += 6) ends.push(elements[e], elements[e + 1], elements[e + 1], elements[e + 2], elements[e + 2], elements[e]);
    for (let t = 0; t < triangles.length; t += 3) ends.push(triangles[t], triangles[t + 1], triangles[t + 1], triangles[t + 2], triangles[t + 2], triangles[t]);
    const edges = new THREE.BufferGeometry();
    edges.setAttribute("position", geometry.getAttribute("position"));
    edges.setIndex(ends);
    return new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color, transparent: true, opacity }));
  };

  // Where elements of different sizes meet, pixels between them may stay empty: the halves of all edges, in the colours of their nodes and a little behind
  // the elements, fill these. As elements are, they are seen from the front alone.
  const fillers = (uniforms) => {
    const normals = new Float32Array(positions.length);
    for (let k = 0; k < index.length; k += 3) {
      const [a, b, c] = [0, 1, 2].map((corner) => new THREE.Vector3(...positions.subarray(3 * index[k + corner], 3 * index[k + corner] + 3)));
      const normal = b.sub(a).cross(c.sub(a)).normalize();
      for (let corner = 0; corner < 3; corner++) normal.toArray(normals, 3 * index[k + corner]);
    }
    const halves = [];
    for (let e = 0; e < elements.length; e += 6) {
      [0, 3, 3, 1, 1, 4, 4, 2, 2, 5, 5, 0].forEach((corner) => halves.push(elements[e + corner]));
    }
    const edges = new THREE.BufferGeometry();
    ["position", "radiance", "shown"].forEach((name) => edges.setAttribute(name, geometry.getAttribute(name)));
    edges.setAttribute("facing", new THREE.BufferAttribute(normals, 3));
    edges.setIndex(halves);
    const { edgeVertex, edgeFragment } = patchlightShaders;
    return new THREE.LineSegments(edges, new THREE.ShaderMaterial({ uniforms, vertexShader: edgeVertex, fragmentShader: edgeFragment }));
  };
  return { lines, fillers };
};
