"use strict";
// The page of a solution: the lit scene in 3D, and what is known of it. Data stand in the elements above, see `output/page/mod.rs`.
(async () => {
  const byId = (id) => document.getElementById(id);
  const { short, percent, round, helix } = patchlightScale;
  if (!window.DecompressionStream) {
    byId("note").textContent = "This browser is too old to show what the page holds: take one from 2023 or later.";
    document.body.dataset.drawn = "no";
    return;
  }
  const page = await patchlightData();
  const { facts: data, floats, positions, radiosity, index, ofSurface, surfaceOfNode, surfaceOfTriangle } = page;
  const channels = data.shown_channels;
  const nodeCount = positions.length / 3;

  // Irradiance H = (B - E) / rho where something is reflected, else 0; seen by an eye in lx.
  const WEIGHTS = channels === 3 ? [0.2126, 0.7152, 0.0722] : [1];
  const materialOf = (surface) => data.materials[ofSurface(surface).material];
  const irradiance = (surface, b) => {
    const material = materialOf(surface);
    return b.map((value, c) => (material.reflectance[c] > 0 ? Math.max(value - material.exitance[c], 0) / material.reflectance[c] : 0));
  };
  const seen = (values) => values.reduce((sum, value, c) => sum + WEIGHTS[c] * value, 0);
  const shownOf = (h) => seen(h) * data.per_irradiance;
  const shown = new Float32Array(nodeCount);
  const colours = new Float32Array(3 * nodeCount);
  const show = () => {
    for (let node = 0; node < nodeCount; node++) {
      const b = Array.from(radiosity.subarray(channels * node, channels * (node + 1)));
      shown[node] = shownOf(irradiance(surfaceOfNode[node], b));
      for (let c = 0; c < 3; c++) colours[3 * node + c] = b[channels === 3 ? c : 0] / Math.PI;
    }
  };
  show();

  // Standard errors of what is shown, for the weights of the solution: what is known of all channels together each has by its part of the light.
  const errors = floats("standard-errors");
  const shownErrors = new Float32Array(errors.length);
  for (let node = 0; node < errors.length; node++) {
    const { exitance } = materialOf(surfaceOfNode[node]);
    const light = exitance.map((e, c) => Math.max(radiosity[channels * node + c] - e, 0));
    const whole = Math.hypot(...light);
    const parts = light.map((b, c) => exitance[c] + errors[node] * (whole > 0 ? b / whole : 1 / Math.sqrt(channels)));
    shownErrors[node] = shownOf(irradiance(surfaceOfNode[node], parts));
  }

  // The exposure that brings the geometric mean of the luminances to 0.22, as of pictures.
  let [sum, lit] = [0, 0];
  for (let node = 0; node < nodeCount; node++) {
    const luminance = 0.2126 * colours[3 * node] + 0.7152 * colours[3 * node + 1] + 0.0722 * colours[3 * node + 2];
    if (luminance > 0) [sum, lit] = [sum + Math.log2(luminance), lit + 1];
  }
  const exposure = lit > 0 ? Math.log2(0.22) - sum / lit : 0;

  // What can be shown in false colours: a number for each node, with its unit, and up to where the colours go.
  const high = (values) => Float32Array.from(values).sort()[Math.floor(0.98 * (values.length - 1))];
  const planeValues = floats("plane-values");
  const brightest = planeValues.reduce((most, value) => (value > most ? value : most), high(shown));
  const quantities = {
    lux: { title: `${data.quantity} in false colours`, unit: data.unit, values: shown, scale: round(brightest) },
  };
  if (errors.length > 0) quantities.errors = { title: `standard error of the ${data.quantity}`, unit: data.unit, values: shownErrors, scale: round(high(shownErrors)) };
  Object.entries(quantities).forEach(([name, { title }], k) => byId("show").add(Object.assign(document.createElement("option"), { value: name, textContent: title }), 1 + k));

  // What is chosen, and kept in the address.
  const typed = new URLSearchParams(location.hash.slice(1));
  const state = {
    show: [...Object.keys(quantities), "texels"].find((name) => name === typed.get("show")) ?? "beauty",
    exposure: Number(typed.get("exposure") ?? exposure.toFixed(1)),
    texel: Number(typed.get("texel") ?? 0.05), // what bakes take if nothing is said
    lines: typed.get("lines") === "1",
    isolines: typed.get("isolines") === "1",
    curves: floats("curve-ends").length > 0 && typed.get("curves") !== "0",
    planes: data.planes.length > 0 && typed.get("planes") !== "0", // who asked for them sees them
    face: null,
    backs: typed.get("backs") === "1",
    lost: typed.get("lost") === "1",
    factors: null,
  };
  if (!Number.isFinite(state.exposure)) state.exposure = 0;
  if (!(state.texel > 0)) state.texel = 0.05;
  // Where light is shown, the scale is that of light on planes.
  const coloured = () => quantities[state.show] ?? quantities.lux;
  if (Number(typed.get("scale")) > 0) coloured().scale = Number(typed.get("scale"));

  let goTo = () => {};
  patchlightFacts(data, byId("facts"), (face) => goTo(face));
  byId("title").textContent = data.title;
  document.title = `${data.title} - Patchlight`;
  byId("claim").textContent = data.claim;
  byId("lost-shares").textContent = `${percent(data.lost.leave)} leave the scene (red), ${percent(data.lost.meet_backs)} meet backs (magenta)`;

  // The scene.
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas: byId("view"), antialias: true, preserveDrawingBuffer: true });
  } catch (error) {
    byId("note").textContent = "This browser draws nothing in 3D (WebGL 2 is missing); all figures are beside this.";
    document.body.dataset.drawn = "no";
    return;
  }
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setClearColor(0x101214);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("radiance", new THREE.BufferAttribute(colours, 3));
  geometry.setAttribute("shown", new THREE.BufferAttribute(Float32Array.from(shown), 1));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  const ramp = Array.from({ length: 65 }, (_, k) => helix(k / 64)).map(([r, g, b]) => new THREE.Vector3(r, g, b));
  const uniforms = { factor: { value: 1 }, scale: { value: 0 }, isolines: { value: 0 }, texel: { value: 0 }, ramp: { value: ramp } };
  const { vertex: vertexShader, fragment: fragmentShader } = patchlightShaders;
  const shaded = (polygonOffsetFactor) =>
    new THREE.ShaderMaterial({ uniforms, vertexShader, fragmentShader, polygonOffset: true, polygonOffsetFactor, polygonOffsetUnits: 1 + polygonOffsetFactor });
  const [material, behind] = [shaded(0), shaded(1)];
  const scene = new THREE.Scene();
  const mesh = new THREE.Mesh(geometry, material); // what clicks meet

  // What is covered is dark. It is drawn farther back, by what its depth changes over a pixel: else it shows along the edges of what covers it.
  const isLit = (node) => colours[3 * node] + colours[3 * node + 1] + colours[3 * node + 2] > 0;
  const drawn = [[], []];
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [index[t], index[t + 1], index[t + 2]];
    drawn[Number(isLit(a) || isLit(b) || isLit(c))].push(a, b, c);
  }
  drawn.forEach((corners, lit) => {
    const part = new THREE.BufferGeometry();
    ["position", "radiance", "shown"].forEach((name) => part.setAttribute(name, geometry.getAttribute(name)));
    part.setIndex(corners);
    scene.add(new THREE.Mesh(part, lit ? material : behind));
  });
  const planes = patchlightPlanes(data.planes, planeValues, new THREE.ShaderMaterial({
    uniforms: { ...material.uniforms, scale: { value: 1 }, isolines: { value: 0 } },
    vertexShader: patchlightShaders.vertex,
    fragmentShader: patchlightShaders.fragment,
    side: THREE.DoubleSide,
  }));
  scene.add(planes.mesh);
  const curves = patchlightSegments(data.curves, floats("curve-ends"));
  const lost = patchlightSegments(data.lost.kinds, floats("lost-ray-ends"));
  scene.add(curves, lost);
  const marker = new THREE.Mesh(new THREE.SphereGeometry(1, 12, 8), new THREE.MeshBasicMaterial({ color: 0xff7800 }));
  marker.visible = false;
  scene.add(marker);
  geometry.computeBoundingSphere();
  const size = geometry.boundingSphere.radius;
  const camera = new THREE.PerspectiveCamera(data.camera.fov, 1, 1e-3 * size, 20 * size);
  camera.up.set(...data.camera.up);
  const controls = new THREE.OrbitControls(camera, byId("view"));
  controls.listenToKeyEvents(byId("view"));
  const toStart = () => {
    camera.position.set(...data.camera.eye);
    controls.target.set(...data.camera.target);
    controls.update();
  };
  toStart();

  // Surfaces are seen from the front alone: where a back is shown, light that lands there is lost.
  const backs = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0xc800c8, side: 1 })); // THREE.BackSide is not in the bundle
  backs.visible = false;
  scene.add(backs);

  // Lines are made once they are asked for.
  const edges = patchlightEdges(page, geometry);
  scene.add(edges.fillers(material.uniforms));
  let lines = null;

  const draw = () => renderer.render(scene, camera);
  const legend = () => {
    const stops = Array.from({ length: 17 }, (_, k) => `rgb(${helix(k / 16).map((x) => Math.round(255 * x)).join(",")})`);
    byId("bar").style.background = `linear-gradient(to top, ${stops.join(",")})`;
    byId("unit").textContent = coloured().unit;
    byId("bar").replaceChildren(
      ...[0, 0.2, 0.4, 0.6, 0.8, 1].map((t) => {
        const tick = document.createElement("span");
        tick.style.bottom = `${100 * t}%`;
        tick.textContent = short(t * coloured().scale);
        return tick;
      }),
    );
  };
  byId("exposure").min = Math.round(exposure) - 8;
  byId("exposure").max = Math.round(exposure) + 8;
  // Gives nodes the numbers of a quantity, where they have others.
  let painted = shown;
  const paint = (values) => {
    if (values === painted) return;
    painted = values;
    geometry.getAttribute("shown").array.set(values);
    geometry.getAttribute("shown").needsUpdate = true;
  };
  const hasOwnWeights = () => !groups || state.factors.every((factor, g) => factor === groups.solved[g]);
  const update = () => {
    // Planes were measured with the weights of the solution, and errors are known for these.
    const isAsSolved = hasOwnWeights();
    if (!isAsSolved && state.show === "errors") state.show = "lux";
    byId("show").querySelectorAll("[value=errors]").forEach((option) => (option.disabled = !isAsSolved));
    const [isColoured, { values, scale, unit }] = [state.show in quantities, coloured()];
    paint(values);
    planes.mesh.visible = state.planes && isAsSolved && coloured() === quantities.lux;
    planes.mesh.material.uniforms.scale.value = quantities.lux.scale;
    material.uniforms.factor.value = 2 ** state.exposure;
    material.uniforms.scale.value = isColoured ? scale : 0;
    material.uniforms.texel.value = state.show === "texels" ? state.texel : 0;
    if (state.lines && !lines) scene.add((lines = edges.lines(0xff7800, 0.45)));
    if (lines) lines.visible = state.lines;
    material.polygonOffsetFactor = state.lines || state.curves ? 1 : 0; // lines lie before surfaces, however these slope
    material.uniforms.isolines.value = state.isolines ? 1 : 0;
    backs.visible = state.backs;
    byId("show").value = state.show;
    byId("exposure").value = state.exposure;
    byId("ev").textContent = `${Number(state.exposure).toFixed(1)} EV`;
    byId("scale").value = scale;
    byId("scale-unit").textContent = unit;
    byId("texel").value = state.texel;
    byId("texel-row").hidden = state.show !== "texels";
    byId("lines").checked = state.lines;
    byId("isolines").checked = state.isolines;
    byId("backs").checked = state.backs;
    curves.visible = state.curves;
    byId("curves").checked = state.curves;
    lost.visible = state.lost;
    byId("lost").checked = state.lost;
    byId("lost-row").hidden = floats("lost-ray-ends").length === 0;
    byId("curves-row").hidden = floats("curve-ends").length === 0;
    byId("planes").checked = state.planes;
    byId("planes-row").hidden = data.planes.length === 0;
    byId("exposure-row").hidden = isColoured;
    byId("isolines-row").hidden = !isColoured;
    byId("scale-row").hidden = byId("legend").hidden = !isColoured && !planes.mesh.visible;
    legend();
    draw();
  };
  const changed = () => {
    const kept = new URLSearchParams({ show: state.show, exposure: state.exposure, scale: coloured().scale });
    if (state.show === "texels") kept.set("texel", state.texel);
    ["lines", "isolines", "backs", "lost"].filter((name) => state[name]).forEach((name) => kept.set(name, 1));
    if (data.planes.length > 0 && !state.planes) kept.set("planes", 0);
    if (floats("curve-ends").length > 0 && !state.curves) kept.set("curves", 0);
    if (state.face) kept.set("face", state.face);
    if (state.factors && state.factors.some((factor, g) => factor !== groups.solved[g])) kept.set("weights", state.factors.join(","));
    history.replaceState(null, "", `#${kept}`);
    update();
  };
  const resize = () => {
    const { clientWidth, clientHeight } = byId("stage");
    renderer.setSize(clientWidth, clientHeight, false);
    camera.aspect = clientWidth / clientHeight;
    // What was chosen for a wide picture stays in sight in a narrow one.
    const wide = data.camera.aspect;
    const half = Math.tan((data.camera.fov * Math.PI) / 360);
    camera.fov = (360 / Math.PI) * Math.atan(half * Math.max(1, wide / camera.aspect));
    camera.updateProjectionMatrix();
    draw();
  };

  // Light groups: a slider and a number for each, sums at once, and the claim that follows.
  const groups = data.light_groups && patchlightGroups(data.light_groups, floats("group-radiosity"));
  const weigh = (factors) => {
    state.factors = factors;
    groups.apply(factors, radiosity, data.materials);
    show();
    geometry.getAttribute("radiance").needsUpdate = true;
    painted = null;
    const claim = groups.claim(factors);
    byId("weights-claim").textContent = `error ${percent(claim)} claimed by energy; ${groups.command(factors)}`;
    byId("weights").querySelectorAll("label").forEach((label, g) => label.querySelectorAll("input").forEach((input) => (input.value = factors[g])));
  };
  const makeGroups = () => {
    byId("groups").hidden = false;
    groups.names.forEach((name, g) => {
      const [label, text] = [document.createElement("label"), document.createElement("span")];
      text.textContent = name;
      text.className = "name";
      const inputs = [["range", { max: 2, step: 0.01 }], ["number", { step: "any" }]].map(([type, range]) => {
        const input = Object.assign(document.createElement("input"), { type, min: 0, ...range });
        input.setAttribute("aria-label", `weight of ${name}`);
        input.addEventListener("input", () => {
          const factor = Number(input.value);
          if (input.value === "" || !(factor >= 0 && factor < 1e6)) return;
          weigh(state.factors.map((old, h) => (h === g ? factor : old)));
          changed();
        });
        return input;
      });
      label.append(text, ...inputs);
      byId("weights").append(label);
    });
    byId("as-solved").addEventListener("click", () => (weigh([...groups.solved]), changed()));
    const asked = (typed.get("weights") ?? "").split(",").map(Number);
    const fits = typed.has("weights") && asked.length === groups.solved.length && asked.every((factor) => factor >= 0 && factor < 1e6);
    weigh(fits ? asked : [...groups.solved]);
  };
  if (groups) makeGroups();

  // A click that does not turn the scene shows values.
  const mark = ({ point, distance }) => {
    marker.position.copy(point);
    marker.scale.setScalar(0.006 * distance);
    draw();
  };
  const pick = (x, y) => {
    const box = byId("view").getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height), camera);
    const hit = ray.intersectObject(mesh)[0];
    const field = planes.hit(ray);
    marker.visible = Boolean(field || hit);
    if (field && !(hit && hit.distance < field.distance)) {
      const { plane, value } = field;
      byId("note").textContent = `measuring plane ${plane.name}\n${plane.quantity} ${short(value)} ${plane.unit}`;
      mark(field);
      return;
    }
    if (!hit) {
      byId("note").textContent = "Nothing that faces the eye is there.";
      draw();
      return;
    }
    const surface = surfaceOfTriangle(hit.faceIndex);
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const point = (node) => new THREE.Vector3(...positions.subarray(3 * node, 3 * node + 3));
    const [a, b, c] = corners.map(point);
    const whole = b.clone().sub(a).cross(c.clone().sub(a));
    const part = (p, q) => p.clone().sub(hit.point).cross(q.clone().sub(hit.point)).dot(whole) / whole.lengthSq();
    const weights = [part(b, c), part(c, a), part(a, b)];
    const values = Array.from({ length: channels }, (_, k) => corners.reduce((sum, node, corner) => sum + weights[corner] * radiosity[channels * node + k], 0));
    const h = irradiance(surface, values);
    const reflects = materialOf(surface).reflectance.some((rho) => rho > 0);
    const known = errors.length > 0 && hasOwnWeights();
    const error = known ? ` ± ${short(corners.reduce((sum, node, corner) => sum + weights[corner] * shownErrors[node], 0))}` : "";
    const { face, object, group } = ofSurface(surface);
    const named = (kind, name) => (name ? `${kind} ${name}` : "");
    const place = [hit.point.x, hit.point.y, hit.point.z].map((x) => x.toFixed(3)).join(", ");
    byId("note").textContent = [
      `${[materialOf(surface).name, `face ${face + 1}`, named("object", data.objects[object]), named("group", data.groups[group])].filter(Boolean).join(", ")}, at ${place} m`,
      `radiosity ${values.map(short).join(", ")} W/m²`,
      reflects ? `irradiance ${h.map(short).join(", ")} W/m²` : "irradiance not known: nothing is reflected here",
      reflects ? `${data.quantity} ${short(shownOf(h))}${error} ${data.unit}` : "",
    ].filter(Boolean).join("\n");
    mark(hit);
  };
  let down = null;
  byId("view").addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
  byId("view").addEventListener("pointerup", (event) => {
    if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) pick(event.clientX, event.clientY);
    down = null;
  });

  controls.addEventListener("change", draw);
  byId("show").addEventListener("change", (event) => ((state.show = event.target.value), changed()));
  byId("exposure").addEventListener("input", (event) => ((state.exposure = Number(event.target.value)), changed()));
  byId("scale").addEventListener("change", ({ target }) => (Number(target.value) > 0 && (coloured().scale = Number(target.value)), changed()));
  byId("texel").addEventListener("change", ({ target }) => (Number(target.value) > 0 && (state.texel = Number(target.value)), changed()));
  ["lines", "isolines", "backs", "lost", "planes", "curves"].forEach((name) => byId(name).addEventListener("change", (event) => ((state[name] = event.target.checked), changed())));
  byId("reset").addEventListener("click", () => {
    places.clear();
    state.face = null;
    toStart();
    changed();
  });
  addEventListener("resize", resize);
  // A warning shows the face that it is about.
  const cornersOf = (face) => {
    const found = [];
    for (let t = 0; t < index.length / 3; t++) {
      if (ofSurface(surfaceOfTriangle(t)).face + 1 !== face) continue;
      for (let corner = 3 * t; corner < 3 * t + 3; corner++) found.push(...positions.subarray(3 * index[corner], 3 * index[corner] + 3));
    }
    return found;
  };
  const places = patchlightPlaces(data.places, cornersOf, { scene, camera, controls, size, draw });
  goTo = (face, atOnce = matchMedia("(prefers-reduced-motion: reduce)").matches) => {
    if (!places.show(face, atOnce)) return;
    byId("stage").scrollIntoView({ block: "nearest" });
    // Planes may hide it.
    [state.face, state.planes] = [face, false];
    byId("note").textContent = `face ${face}, by a warning`;
    changed();
  };
  update();
  resize();
  if (typed.has("face")) goTo(Number(typed.get("face")), true);
  document.body.dataset.drawn = "yes";
  if (typed.has("pick")) pick(...typed.get("pick").split(",").map(Number));
})();
