"use strict";
// How light, numbers in false colours and texels are drawn, on surfaces and on edges.
const patchlightShaders = (() => {
  const vertex = `
  attribute vec3 radiance; attribute float shown;
  varying vec3 light; varying float value; varying vec3 place;
  void main() { light = radiance; value = shown; place = position; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
  // The tone curve of output/png.rs: straight up to 0.5, then bent towards white, on the largest channel.
  const fragment = `
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
  }`;
  // Edges are a little behind, and seen from the front alone.
  const edgeVertex = `
  attribute vec3 radiance; attribute float shown; attribute vec3 facing;
  varying vec3 light; varying float value; varying vec3 place; varying float front;
  void main() {
    light = radiance; value = shown; place = position; front = dot(cameraPosition - position, facing);
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_Position.z += 2e-4 * gl_Position.w;
  }`;
  const edgeFragment = fragment
    .replace("varying float value;", "varying float value; varying float front;")
    .replace("if (texel > 0.0)", "if (false)")
    .replace("void main() {", "void main() { if (front <= 0.0) discard;");
  return { vertex, fragment, edgeVertex, edgeFragment };
})();
