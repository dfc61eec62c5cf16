"use strict";
// What the elements of the page hold, see `output/page/mod.rs`: facts, nodes, triangles, and the surfaces that these are on.
const patchlightData = async () => {
  const facts = JSON.parse(document.getElementById("facts-data").textContent);
  const inflated = async (text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  };
  const arrays = new Map();
  for (const { id, textContent } of document.querySelectorAll("script[type='text/plain']")) arrays.set(id, await inflated(textContent));
  const floats = (id) => new Float32Array(arrays.get(id));
  const numbers = (id) => new Uint32Array(arrays.get(id));

  // Nodes, elements of six nodes, polygons as triangles, and the surfaces that they are on, as runs of (surface, count).
  const positions = floats("positions");
  const radiosity = floats("radiosity");
  const elements = numbers("elements");
  const triangles = numbers("triangles");
  const surfaceData = numbers("surfaces"); // by surface: face, material, object, group
  const ofSurface = (surface) => {
    const [face, material, object, group] = surfaceData.subarray(4 * surface, 4 * surface + 4);
    return { face, material, object, group };
  };

  const ofRuns = (runs, length) => {
    const of = new Uint32Array(length);
    let next = 0;
    for (let k = 0; k < runs.length; k += 2) {
      of.fill(runs[k], next, next + runs[k + 1]);
      next += runs[k + 1];
    }
    return of;
  };
  const elementSurface = ofRuns(numbers("element-runs"), elements.length / 6);
  const triangleSurface = ofRuns(numbers("triangle-runs"), triangles.length / 3);

  // Four triangles for each element: corners 0 to 2, middles 3 to 5 behind them.
  const PIECES = [0, 3, 5, 3, 1, 4, 5, 4, 2, 3, 4, 5];
  const index = new Uint32Array(2 * elements.length + triangles.length);
  const surfaceOfNode = new Uint32Array(positions.length / 3);
  for (let e = 0; e < elements.length / 6; e++) {
    PIECES.forEach((corner, k) => (index[12 * e + k] = elements[6 * e + corner]));
    for (let k = 0; k < 6; k++) surfaceOfNode[elements[6 * e + k]] = elementSurface[e];
  }
  index.set(triangles, 2 * elements.length);
  triangles.forEach((node, k) => (surfaceOfNode[node] = triangleSurface[Math.floor(k / 3)]));
  const surfaceOfTriangle = (t) => (12 * (elements.length / 6) > 3 * t ? elementSurface[Math.floor(t / 4)] : triangleSurface[t - (elements.length / 6) * 4]);
  return { facts, floats, positions, radiosity, elements, triangles, index, ofSurface, surfaceOfNode, surfaceOfTriangle };
};
