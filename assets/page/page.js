"use strict";
// The page of a solution: the lit scene in 3D, and what is known of it. Data stand in the elements above, see `output/page/mod.rs`.
(() => {
  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("facts-data").textContent);
  const bytes = (id) => Uint8Array.from(atob(byId(id).textContent.trim()), (c) => c.charCodeAt(0));
  const floats = (id) => new Float32Array(bytes(id).buffer);
  const numbers = (id) => new Uint32Array(bytes(id).buffer);

  // Nodes, elements of six nodes, polygons as triangles, and the surfaces that they are on, as runs of (surface, count).
  const positions = floats("positions");
  const radiosity = floats("radiosity");
  const elements = numbers("elements");
  const triangles = numbers("triangles");
  const surfaceData = numbers("surfaces"); // by surface: face, material
  const channels = data.shown_channels;
  const nodeCount = positions.length / 3;

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
  const surfaceOfNode = new Uint32Array(nodeCount);
  for (let e = 0; e < elements.length / 6; e++) {
    PIECES.forEach((corner, k) => (index[12 * e + k] = elements[6 * e + corner]));
    for (let k = 0; k < 6; k++) surfaceOfNode[elements[6 * e + k]] = elementSurface[e];
  }
  index.set(triangles, 2 * elements.length);
  triangles.forEach((node, k) => (surfaceOfNode[node] = triangleSurface[Math.floor(k / 3)]));
  const surfaceOfTriangle = (t) => (12 * (elements.length / 6) > 3 * t ? elementSurface[Math.floor(t / 4)] : triangleSurface[t - (elements.length / 6) * 4]);

  // Irradiance H = (B - E) / rho where something is reflected, else 0; seen by an eye in lx.
  const WEIGHTS = channels === 3 ? [0.2126, 0.7152, 0.0722] : [1];
  const materialOf = (surface) => data.materials[surfaceData[2 * surface + 1]];
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

  const short = (x) => (x === null || !Number.isFinite(x) ? "not known" : x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(2) : String(Number(x.toPrecision(4))));
  const percent = (x) => (x === null || x === undefined || !Number.isFinite(x) ? "not known" : `${(100 * x).toFixed(2)} %`);

  // The least of 1, 2 or 5 times a power of ten that is not below a number.
  const round = (x) => {
    if (!(x > 0)) return 1;
    const power = 10 ** Math.floor(Math.log10(x));
    return [1, 2, 5, 10].map((digit) => digit * power).find((high) => high >= x * (1 - 1e-9));
  };

  // The exposure that brings the geometric mean of the luminances to 0.22, as of pictures.
  let [sum, lit] = [0, 0];
  for (let node = 0; node < nodeCount; node++) {
    const luminance = 0.2126 * colours[3 * node] + 0.7152 * colours[3 * node + 1] + 0.0722 * colours[3 * node + 2];
    if (luminance > 0) [sum, lit] = [sum + Math.log2(luminance), lit + 1];
  }
  const exposure = lit > 0 ? Math.log2(0.22) - sum / lit : 0;

  // What is chosen, and kept in the address.
  const typed = new URLSearchParams(location.hash.slice(1));
  const sorted = Float32Array.from(shown).sort();
  const state = {
    show: ["lux", "texels"].find((name) => name === typed.get("show")) ?? "beauty",
    exposure: Number(typed.get("exposure") ?? exposure.toFixed(1)),
    scale: Number(typed.get("scale") ?? round(sorted[Math.floor(0.98 * (nodeCount - 1))])),
    texel: Number(typed.get("texel") ?? 0.05), // what bakes take if nothing is said
    lines: typed.get("lines") === "1",
    isolines: typed.get("isolines") === "1",
    backs: typed.get("backs") === "1",
    factors: null,
  };
  if (!Number.isFinite(state.exposure)) state.exposure = 0;
  [["scale", 1], ["texel", 0.05]].filter(([name]) => !(state[name] > 0)).forEach(([name, usual]) => (state[name] = usual));

  // The helix in Oklab of `output/false_colours.rs`, as GLSL and for the legend.
  const HELIX = { lightness: [0.25, 0.93], hue: [0.83, 0.3], chroma: 0.095 };
  const mix = ([from, to], t) => from + t * (to - from);
  const helix = (t) => {
    const angle = 2 * Math.PI * mix(HELIX.hue, t);
    const [L, a, b] = [mix(HELIX.lightness, t), HELIX.chroma * Math.cos(angle), HELIX.chroma * Math.sin(angle)];
    const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
    const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
    const linear = [4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s, -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s];
    return linear.map((x) => Math.min(Math.max(x, 0), 1)).map((x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
  };

  patchlightFacts(data, byId("facts"), { short, percent });
  byId("title").textContent = data.title;
  document.title = `${data.title} - Patchlight`;
  byId("claim").textContent = data.claim;
  byId("lux-option").textContent = data.quantity + " in false colours";
  byId("scale-unit").textContent = data.unit;

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
  geometry.setAttribute("shown", new THREE.BufferAttribute(shown, 1));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  const ramp = Array.from({ length: 65 }, (_, k) => helix(k / 64)).map(([r, g, b]) => new THREE.Vector3(r, g, b));
  const material = new THREE.ShaderMaterial({
    uniforms: { factor: { value: 1 }, scale: { value: 0 }, isolines: { value: 0 }, texel: { value: 0 }, ramp: { value: ramp } },
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
    vertexShader: `
      attribute vec3 radiance; attribute float shown;
      varying vec3 light; varying float value; varying vec3 place;
      void main() { light = radiance; value = shown; place = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    // The tone curve of output/png.rs: straight up to 0.5, then bent towards white, on the largest channel.
    fragmentShader: `
      uniform float factor; uniform float scale; uniform float isolines; uniform float texel; uniform vec3 ramp[65];
      varying vec3 light; varying float value; varying vec3 place;
      vec3 encoded(vec3 c) { return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }
      void main() {
        if (scale > 0.0) {
          float at = clamp(value / scale, 0.0, 1.0) * 64.0;
          int below = int(min(floor(at), 63.0));
          vec3 c = mix(ramp[below], ramp[below + 1], at - float(below));
          // Lines of equal light are a pixel and a half wide, however fast it changes; where it does not change there are none.
          float mark = 5.0 * value / scale;
          float slope = fwidth(mark);
          float away = abs(mark - max(round(mark), 1.0));
          if (isolines > 0.0 && slope < 0.5 && away < 0.75 * slope) c = vec3(dot(c, vec3(0.299, 0.587, 0.114)) < 0.5 ? 1.0 : 0.0);
          gl_FragColor = vec4(c, 1.0);
          return;
        }
        vec3 c = min(max(light * factor, 0.0), 1e6);
        float peak = max(c.r, max(c.g, c.b));
        if (peak > 0.5) {
          float bent = 1.0 - 0.25 / peak;
          float kept = 1.0 / (1.0 + 0.15 * (peak - bent));
          c = bent + (c / peak * bent - bent) * kept;
        }
        c = encoded(c);
        if (texel > 0.0) {
          // Squares along the axis that lies most in the surface; where they are smaller than two pixels, what they are in the mean.
          vec3 n = normalize(cross(dFdx(place), dFdy(place)));
          vec3 a = abs(n) - vec3(0.02, 0.01, 0.0); // of two that lie in it alike always the same
          vec3 axis = a.x <= min(a.y, a.z) ? vec3(1.0, 0.0, 0.0) : a.y <= a.z ? vec3(0.0, 1.0, 0.0) : vec3(0.0, 0.0, 1.0);
          vec3 u = normalize(axis - dot(axis, n) * n);
          vec2 at = vec2(dot(place, u), dot(place, cross(n, u))) / texel;
          float odd = mod(floor(at.x + 1e-3) + floor(at.y + 1e-3), 2.0);
          c *= mix(0.6 + 0.4 * odd, 0.8, clamp(2.0 * max(fwidth(at.x), fwidth(at.y)) - 0.5, 0.0, 1.0));
        }
        gl_FragColor = vec4(c, 1.0);
      }`,
  });
  const scene = new THREE.Scene();
  const mesh = new THREE.Mesh(geometry, material);
  scene.add(mesh);
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
  let lines = null;
  const makeLines = () => {
    const ends = [];
    for (let e = 0; e < elements.length; e += 6) ends.push(elements[e], elements[e + 1], elements[e + 1], elements[e + 2], elements[e + 2], elements[e]);
    for (let t = 0; t < triangles.length; t += 3) ends.push(triangles[t], triangles[t + 1], triangles[t + 1], triangles[t + 2], triangles[t + 2], triangles[t]);
    const edges = new THREE.BufferGeometry();
    edges.setAttribute("position", geometry.getAttribute("position"));
    edges.setIndex(ends);
    lines = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0xff7800, transparent: true, opacity: 0.45 }));
    scene.add(lines);
  };

  // Where elements of different sizes meet, pixels between them may stay empty: the halves of all edges, in the colours of their nodes and a little behind
  // the elements, fill these. As elements are, they are seen from the front alone.
  const normals = new Float32Array(3 * nodeCount);
  for (let k = 0; k < index.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => new THREE.Vector3(...positions.subarray(3 * index[k + corner], 3 * index[k + corner] + 3)));
    const normal = b.sub(a).cross(c.sub(a)).normalize();
    for (let corner = 0; corner < 3; corner++) normal.toArray(normals, 3 * index[k + corner]);
  }
  const halves = [];
  for (let e = 0; e < elements.length; e += 6) {
    [0, 3, 3, 1, 1, 4, 4, 2, 2, 5, 5, 0].forEach((corner) => halves.push(elements[e + corner]));
  }
  const fillers = new THREE.BufferGeometry();
  ["position", "radiance", "shown"].forEach((name) => fillers.setAttribute(name, geometry.getAttribute(name)));
  fillers.setAttribute("facing", new THREE.BufferAttribute(normals, 3));
  fillers.setIndex(halves);
  const behind = new THREE.ShaderMaterial({
    uniforms: material.uniforms,
    vertexShader: `
      attribute vec3 radiance; attribute float shown; attribute vec3 facing;
      varying vec3 light; varying float value; varying vec3 place; varying float front;
      void main() {
        light = radiance; value = shown; place = position; front = dot(cameraPosition - position, facing);
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_Position.z += 2e-4 * gl_Position.w;
      }`,
    fragmentShader: material.fragmentShader
      .replace("varying float value;", "varying float value; varying float front;")
      .replace("if (texel > 0.0)", "if (false)")
      .replace("void main() {", "void main() { if (front <= 0.0) discard;"),
  });
  scene.add(new THREE.LineSegments(fillers, behind));

  const draw = () => renderer.render(scene, camera);
  const legend = () => {
    const stops = Array.from({ length: 17 }, (_, k) => `rgb(${helix(k / 16).map((x) => Math.round(255 * x)).join(",")})`);
    byId("bar").style.background = `linear-gradient(to top, ${stops.join(",")})`;
    byId("unit").textContent = data.unit;
    byId("bar").replaceChildren(
      ...[0, 0.2, 0.4, 0.6, 0.8, 1].map((t) => {
        const tick = document.createElement("span");
        tick.style.bottom = `${100 * t}%`;
        tick.textContent = short(t * state.scale);
        return tick;
      }),
    );
  };
  byId("exposure").min = Math.round(exposure) - 8;
  byId("exposure").max = Math.round(exposure) + 8;
  const update = () => {
    const isLux = state.show === "lux";
    material.uniforms.factor.value = 2 ** state.exposure;
    material.uniforms.scale.value = isLux ? state.scale : 0;
    material.uniforms.texel.value = state.show === "texels" ? state.texel : 0;
    if (state.lines && !lines) makeLines();
    if (lines) lines.visible = state.lines;
    material.uniforms.isolines.value = state.isolines ? 1 : 0;
    backs.visible = state.backs;
    byId("show").value = state.show;
    byId("exposure").value = state.exposure;
    byId("ev").textContent = `${Number(state.exposure).toFixed(1)} EV`;
    byId("scale").value = state.scale;
    byId("texel").value = state.texel;
    byId("texel-row").hidden = state.show !== "texels";
    byId("lines").checked = state.lines;
    byId("isolines").checked = state.isolines;
    byId("backs").checked = state.backs;
    byId("exposure-row").hidden = isLux;
    byId("scale-row").hidden = byId("isolines-row").hidden = byId("legend").hidden = !isLux;
    legend();
    draw();
  };
  const changed = () => {
    const kept = new URLSearchParams({ show: state.show, exposure: state.exposure, scale: state.scale });
    if (state.show === "texels") kept.set("texel", state.texel);
    ["lines", "isolines", "backs"].filter((name) => state[name]).forEach((name) => kept.set(name, 1));
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
    ["radiance", "shown"].forEach((name) => (geometry.getAttribute(name).needsUpdate = true));
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
  const pick = (x, y) => {
    const box = byId("view").getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height), camera);
    const hit = ray.intersectObject(mesh)[0];
    marker.visible = Boolean(hit);
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
    const place = [hit.point.x, hit.point.y, hit.point.z].map((x) => x.toFixed(3)).join(", ");
    byId("note").textContent = [
      `${materialOf(surface).name}, face ${surfaceData[2 * surface] + 1}, at ${place} m`,
      `radiosity ${values.map(short).join(", ")} W/m²`,
      reflects ? `irradiance ${h.map(short).join(", ")} W/m²` : "irradiance not known: nothing is reflected here",
      reflects ? `${data.quantity} ${short(shownOf(h))} ${data.unit}` : "",
    ].filter(Boolean).join("\n");
    marker.position.copy(hit.point);
    marker.scale.setScalar(0.006 * hit.distance);
    draw();
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
  ["scale", "texel"].forEach((name) => byId(name).addEventListener("change", ({ target }) => (Number(target.value) > 0 && (state[name] = Number(target.value)), changed())));
  ["lines", "isolines", "backs"].forEach((name) => byId(name).addEventListener("change", (event) => ((state[name] = event.target.checked), changed())));
  byId("reset").addEventListener("click", () => (toStart(), draw()));
  addEventListener("resize", resize);
  update();
  resize();
  document.body.dataset.drawn = "yes";
  if (typed.has("pick")) pick(...typed.get("pick").split(",").map(Number));
})();
