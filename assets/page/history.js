"use strict";
// The error against time as a small plot on axes of powers of ten: what was claimed and measured each time, and what was asked for.
// `null` where nothing was known of it.
const patchlightHistory = (history, asked, { short, percent }) => {
  const [width, height] = [304, 210];
  const frame = { left: 44, right: 296, top: 22, bottom: 168 };
  const element = (name, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const isKnown = (error) => error !== null && error > 0;
  const known = history.filter((at) => isKnown(at.claimed));
  if (known.length === 0) return null;

  // An axis around numbers, so wide that it has two ticks or more, and these.
  const axis = (numbers, from, to) => {
    const [least, most] = [Math.min(...numbers), Math.max(...numbers)];
    const wider = Math.max(1.3, Math.sqrt(Math.max(1, 6.5 / (most / least))));
    const [low, high] = [least / wider, most * wider];
    const digits = high / low > 100 ? [1] : [1, 2, 5];
    const ticks = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) ticks.push(...digits.map((digit) => Number(`${digit}e${power}`)));
    return { at: (x) => from + (Math.log(x / low) / Math.log(high / low)) * (to - from), ticks: ticks.filter((x) => x >= low && x <= high) };
  };
  const seconds = (at) => Math.max(at.time_s, 1e-3);
  const x = axis(known.map(seconds), frame.left, frame.right);
  const y = axis([asked, ...known.flatMap((at) => [at.claimed, at.measured].filter(isKnown))], frame.bottom, frame.top);

  const plot = element("svg", { viewBox: `0 0 ${width} ${height}`, class: "plot", role: "img", "aria-label": "Error against time" });
  const line = (from, to, kind) => plot.append(element("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: kind }));
  const label = (text, px, py, anchor) => plot.append(element("text", { x: px, y: py, "text-anchor": anchor }, text));
  x.ticks.forEach((value) => {
    line([x.at(value), frame.top], [x.at(value), frame.bottom], "grid");
    label(short(value), x.at(value), frame.bottom + 14, "middle");
  });
  y.ticks.forEach((value) => {
    line([frame.left, y.at(value)], [frame.right, y.at(value)], "grid");
    label(`${short(100 * value)} %`, frame.left - 5, y.at(value) + 4, "end");
  });
  label("error", frame.left - 5, 11, "end");
  line([frame.left, frame.top], [frame.left, frame.bottom], "axis");
  line([frame.left, frame.bottom], [frame.right, frame.bottom], "axis");
  label("seconds since the solve began", (frame.left + frame.right) / 2, frame.bottom + 32, "middle");

  line([frame.left, y.at(asked)], [frame.right, y.at(asked)], "asked");
  ["measured", "claimed"].forEach((kind) => {
    const points = known.filter((at) => isKnown(at[kind]));
    plot.append(element("polyline", { points: points.filter((at) => at.of !== "lit_mesh").map((at) => `${x.at(seconds(at))},${y.at(at[kind])}`).join(" "), class: kind }));
    points.forEach((at) => {
      const point = element("circle", { cx: x.at(seconds(at)), cy: y.at(at[kind]), r: at.of === "lit_mesh" ? 5 : 3.5, class: `${kind} ${at.of}` });
      const of = { over_links: "values over links", over_cells: "values over cells", lit_mesh: "the lit mesh" }[at.of];
      const rays = at.rays_per_point === null ? "" : `, ${at.rays_per_point} rays to a point`;
      point.append(element("title", {}, `${percent(at[kind])} ${kind} of ${of} after ${short(at.time_s)} s${rays}, ${short(at.rays)} rays in all`));
      plot.append(point);
    });
  });
  return plot;
};
