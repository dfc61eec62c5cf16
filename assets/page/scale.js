"use strict";
// Numbers as texts, as scales and as colours.
const patchlightScale = (() => {
  const short = (x) => (x === null || !Number.isFinite(x) ? "not known" : x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(2) : String(Number(x.toPrecision(4))));
  const percent = (x) => (x === null || x === undefined || !Number.isFinite(x) ? "not known" : `${(100 * x).toFixed(2)} %`);

  // The least of 1, 2 or 5 times a power of ten that is not below a number.
  const round = (x) => {
    if (!(x > 0)) return 1;
    const power = 10 ** Math.floor(Math.log10(x));
    return [1, 2, 5, 10].map((digit) => digit * power).find((high) => high >= x * (1 - 1e-9));
  };

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

  return { short, percent, round, helix };
})();
