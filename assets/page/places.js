"use strict";
// Faces that warnings are about: the camera flies to one, and it is outlined over all else.
// `places` are those of the facts, by the number of the face; `corners` tells the corners of the triangles of a face, as positions.
const patchlightPlaces = (places, corners, { scene, camera, controls, size, draw }) => {
  const FLIGHT_MS = 500;
  const COLOUR = 0xff2fd0;
  const made = [];
  let flight = 0;

  const clear = () => {
    flight += 1;
    made.splice(0).forEach((object) => {
      scene.remove(object);
      object.geometry.dispose();
      object.material.dispose();
    });
  };
  const add = (object) => {
    object.renderOrder = 1;
    scene.add(object);
    made.push(object);
  };
  const through = (numbers) => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(numbers), 3));
    return geometry;
  };

  // In front of a face, on the side of it that the eye is on now if it can be, and a little aslant.
  const view = ({ centre, normal, radius }) => {
    const [middle, front] = [new THREE.Vector3(...centre), new THREE.Vector3(...normal)];
    const aside = camera.position.clone().sub(middle);
    aside.addScaledVector(front, -aside.dot(front)).normalize().multiplyScalar(0.45);
    const distance = Math.max((1.5 * radius) / Math.tan((camera.fov * Math.PI) / 360), 5e-3 * size);
    return { target: middle, eye: middle.clone().addScaledVector(front.add(aside).normalize(), distance) };
  };

  // Shows a face: at once, or by a flight. `false` if it is not known.
  const show = (face, atOnce) => {
    const place = places[face];
    if (!place) return false;
    clear();
    add(new THREE.Mesh(through(corners(face)), new THREE.MeshBasicMaterial({ color: COLOUR, transparent: true, opacity: 0.3, depthTest: false, side: THREE.DoubleSide })));
    add(new THREE.LineSegments(through(place.outline), new THREE.LineBasicMaterial({ color: COLOUR, depthTest: false, transparent: true })));
    const [{ target, eye }, from, looked] = [view(place), camera.position.clone(), controls.target.clone()];
    const [own, began] = [flight, performance.now()];
    const step = (now) => {
      if (own !== flight) return;
      const part = atOnce ? 1 : Math.min(Math.max((now - began) / FLIGHT_MS, 0), 1);
      const eased = part * part * (3 - 2 * part);
      camera.position.lerpVectors(from, eye, eased);
      controls.target.lerpVectors(looked, target, eased);
      controls.update();
      draw();
      if (part < 1) requestAnimationFrame(step);
    };
    step(began);
    return true;
  };
  return { show, clear };
};
