// Writes a scene of three.js by its GLTFExporter to the file named on the command line, and prints as JSON what is in it by three.js' own
// reckoning: by material area, moment of area (metres times area) and flux of the position through the fronts, which is three times the volume of what
// is closed and faces outwards.
const fs = require("fs");
const path = require("path");
const zlib = require("zlib");
const { pathToFileURL } = require("url");

// What browsers have and Node.js has not: a reader of blobs, and a canvas that becomes a PNG.
globalThis.FileReader = class {
  readAsArrayBuffer(blob) {
    blob.arrayBuffer().then((bytes) => ((this.result = bytes), this.onloadend()));
  }
};
globalThis.ImageData = class {
  constructor(data, width, height) {
    Object.assign(this, { data, width, height });
  }
};
globalThis.OffscreenCanvas = class {
  constructor(width, height) {
    Object.assign(this, { width, height });
  }
  getContext() {
    return { translate: () => {}, scale: () => {}, putImageData: (image) => (this.image = image) };
  }
  convertToBlob() {
    const { data, width, height } = this.image;
    const rows = [];
    for (let row = 0; row < height; row++) rows.push(Buffer.from([0]), Buffer.from(data.slice(4 * width * row, 4 * width * (row + 1))));
    const chunk = (name, body) => {
      const named = Buffer.concat([Buffer.from(name), body]);
      const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
      length.writeUInt32BE(body.length);
      sum.writeUInt32BE(zlib.crc32(named));
      return Buffer.concat([length, named, sum]);
    };
    const head = Buffer.alloc(13);
    head.writeUInt32BE(width, 0);
    head.writeUInt32BE(height, 4);
    head.set([8, 6, 0, 0, 0], 8);
    const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
    const png = [signature, chunk("IHDR", head), chunk("IDAT", zlib.deflateSync(Buffer.concat(rows))), chunk("IEND", Buffer.alloc(0))];
    return Promise.resolve(new Blob([Buffer.concat(png)], { type: "image/png" }));
  }
};

function made(THREE) {
  const scene = new THREE.Scene();
  const material = (name, [r, g, b], more) => {
    const made = new THREE.MeshStandardMaterial({ name, metalness: 0, ...more });
    made.color.setRGB(r, g, b);
    return made;
  };
  const mesh = (name, geometry, of) => Object.assign(new THREE.Mesh(geometry, of), { name });

  // A floor with a texture, half black and half white.
  const texels = new Uint8Array([0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255, 0, 0, 0, 255]);
  const map = new THREE.DataTexture(texels, 2, 2);
  map.colorSpace = THREE.SRGBColorSpace;
  map.needsUpdate = true;
  const floor = mesh("floor", new THREE.PlaneGeometry(8, 8), material("floor", [0.5, 0.5, 0.5], { map }));
  floor.rotation.x = -Math.PI / 2;
  scene.add(floor);

  // Groups in groups, turned, stretched and mirrored.
  const outer = new THREE.Group();
  outer.name = "outer";
  outer.position.set(1, 0.5, 2);
  outer.rotation.set(0.3, 1.1, -0.4);
  outer.scale.set(2, 1, 0.75);
  const inner = new THREE.Group();
  inner.name = "inner";
  inner.position.set(0.25, 1, 0);
  inner.scale.set(-1, 1, 1);
  const stool = mesh("stool", new THREE.BoxGeometry(0.5, 0.25, 1), material("mirrored", [0.25, 0.5, 0.75]));
  stool.position.set(0.5, 0, 0);
  inner.add(stool);
  inner.add(mesh("ball", new THREE.IcosahedronGeometry(0.3, 1), material("ball", [0.125, 0.25, 0.5])));
  outer.add(inner);
  scene.add(outer);

  // A lamp that looks down, and a curtain with two sides.
  const emits = new THREE.Color().setRGB(1, 0.5, 0.25);
  const lamp = mesh("lamp", new THREE.PlaneGeometry(1, 2), material("lamp", [0, 0, 0], { emissive: emits, emissiveIntensity: 4 }));
  lamp.rotation.x = Math.PI / 2;
  lamp.position.y = 3;
  const dim = mesh("dim", new THREE.PlaneGeometry(1, 1), material("dim", [0, 0, 0], { emissive: emits, emissiveIntensity: 0.5 }));
  dim.position.z = -3;
  const curtain = mesh("curtain", new THREE.PlaneGeometry(2, 1), material("curtain", [0.75, 0.5, 0.25], { side: THREE.DoubleSide }));
  curtain.position.set(-2, 1, 0);
  scene.add(lamp, dim, curtain);

  // Copies of one mesh, one of them mirrored.
  const chairs = new THREE.InstancedMesh(new THREE.BoxGeometry(0.5, 0.5, 0.5), material("chair", [0.5, 0.25, 0.125]), 3);
  chairs.name = "chairs";
  chairs.position.set(0, 0.25, 0);
  const turned = new THREE.Quaternion().setFromEuler(new THREE.Euler(0, 0.7, 0.2));
  chairs.setMatrixAt(0, new THREE.Matrix4().makeTranslation(-3, 0, -3));
  chairs.setMatrixAt(1, new THREE.Matrix4().compose(new THREE.Vector3(3, 1, -3), turned, new THREE.Vector3(1, 2, 0.5)));
  chairs.setMatrixAt(2, new THREE.Matrix4().compose(new THREE.Vector3(3, 0, 3), turned, new THREE.Vector3(-1, 1, 1)));
  scene.add(chairs);

  // Lights, one of them in a group.
  const lights = new THREE.Group();
  lights.name = "lights";
  lights.position.set(0, 2, 1);
  lights.scale.setScalar(2);
  const bulb = Object.assign(new THREE.PointLight(new THREE.Color().setRGB(1, 0.5, 0.25), 358), { name: "bulb" });
  bulb.position.set(0.5, 0.25, 0);
  lights.add(bulb);
  const towards = (light) => {
    light.target.position.set(0, 0, -1);
    light.add(light.target);
    return light;
  };
  const spot = towards(Object.assign(new THREE.SpotLight(0xffffff, 179, 0, 0.5, 0.5), { name: "spot" }));
  spot.position.set(1, 2, 3);
  const sun = towards(Object.assign(new THREE.DirectionalLight(0xffffff, 895), { name: "sun" }));
  sun.position.set(0, 0, 0);
  scene.add(lights, spot, sun);
  return scene;
}

function reckoned(THREE, scene) {
  const materials = {};
  const add = (mesh, toWorld) => {
    const { geometry, material } = mesh;
    const flat = geometry.index ? geometry.toNonIndexed() : geometry;
    const of = (materials[material.name] ??= { area: 0, moment: [0, 0, 0], flux: 0 });
    const sides = material.side === THREE.DoubleSide ? 2 : 1;
    const mirrored = Math.sign(toWorld.determinant());
    const corner = (k) => new THREE.Vector3().fromBufferAttribute(flat.attributes.position, k).applyMatrix4(toWorld);
    for (let k = 0; k < flat.attributes.position.count; k += 3) {
      const triangle = new THREE.Triangle(corner(k), corner(k + 1), corner(k + 2));
      const [area, middle, normal] = [triangle.getArea(), triangle.getMidpoint(new THREE.Vector3()), triangle.getNormal(new THREE.Vector3())];
      of.area += sides * area;
      middle.toArray().forEach((x, axis) => (of.moment[axis] += sides * area * x));
      of.flux += sides === 2 ? 0 : mirrored * area * middle.dot(normal);
    }
  };
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (!object.isMesh) return;
    const own = new THREE.Matrix4();
    for (let k = 0; k < (object.isInstancedMesh ? object.count : 1); k++) {
      if (object.isInstancedMesh) object.getMatrixAt(k, own);
      add(object, new THREE.Matrix4().multiplyMatrices(object.matrixWorld, own));
    }
  });
  return materials;
}

(async () => {
  const build = path.dirname(require.resolve("three"));
  const imported = (file) => import(pathToFileURL(file));
  const THREE = await imported(path.join(build, "three.module.js"));
  const { GLTFExporter } = await imported(path.join(build, "../examples/jsm/exporters/GLTFExporter.js"));
  const scene = made(THREE);
  const glb = await new GLTFExporter().parseAsync(scene, { binary: true });
  fs.writeFileSync(process.argv[2], Buffer.from(glb));
  console.log(`JSON ${JSON.stringify({ revision: THREE.REVISION, materials: reckoned(THREE, scene) })}`);
})();
