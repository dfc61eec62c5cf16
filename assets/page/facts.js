"use strict";
// What is known of the solution, as tables in the element `into`.
// `goTo` shows a face in 3D.
const patchlightFacts = (data, into, goTo) => {
  const { short, percent } = patchlightScale;
  const element = (name, text, kind) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (kind) made.className = kind;
    return made;
  };
  const section = (title, ...content) => {
    const made = element("section");
    made.append(element("h2", title), ...content);
    into.append(made);
  };
  const table = (rows) => {
    const made = element("table");
    rows.forEach(([name, value, share, kind]) => {
      const row = element("tr", undefined, kind);
      const cell = element("td", value);
      if (share > 0) {
        const bar = element("span", undefined, "share");
        bar.style.width = `${Math.max(1, 100 * Math.min(share, 1))}%`;
        cell.append(bar);
      }
      row.append(element("th", name), cell);
      made.append(row);
    });
    return made;
  };
  const report = data.report;
  section("Error", table(data.errors.map(([name, value]) => [name, percent(value)])), element("p", data.about_errors, "claim"));
  const history = report && patchlightHistory(report.history, report.options.error, patchlightScale);
  if (history) {
    const ring = report.history.some((at) => at.of === "lit_mesh") ? "; a ring is the lit mesh" : "";
    section("Error against time", history, element("p", `Claimed, and in grey measured; dashed what was asked for${ring}.`, "claim"));
  }
  data.planes.forEach((plane) => section(`Measuring plane ${plane.name}`, table(patchlightPlaneRows(plane, patchlightScale))));
  if (report) {
    const { emitted, absorbed, escaped, unaccounted, held_back, held_back_unseen } = report.energy;
    const power = (name, x) => [name, `${short(x)} W`, Math.abs(x) / emitted];
    const powers = [power("emitted", emitted), power("absorbed", absorbed), power("escaped", escaped), power("not accounted for", unaccounted)];
    // Light that pairs without a link would reflect at most, where that is known and any.
    const held = [power("held back at most", held_back), power("held back unseen, at most", held_back_unseen)].filter((_, k) => [held_back, held_back_unseen][k] > 0);
    if (report.error.skipped > 0) held.push(["held back, of reflected light", percent(report.error.skipped)]);
    section("Energy, by the elements of the solver", table([...powers, ...held]));
    const times = report.time_s;
    const stages = ["load", "build", "refine", "resolve", "error", "mesh", "bounds", "sample", "output"].filter((stage) => times[stage] > 0.0005);
    section("Time", table([...stages.map((stage) => [stage, `${times[stage].toFixed(2)} s`, times[stage] / times.total]), ["total", `${times.total.toFixed(2)} s`], ["CPU", report.cpu_s.total === null ? "not known" : `${report.cpu_s.total.toFixed(2)} s`]]));
    section("Warnings", report.warnings.length ? list(report.warnings, report.warned_faces) : element("p", "None.", "claim"));
  }
  section("What there is", table(data.counts.map(([name, value]) => [name, String(value)])));
  section("Again", element("code", data.command));
  section("Options that are not the default", data.options.length ? table(data.options) : element("p", "None.", "claim"));
  section("Software", table([["version", data.software], ...(report ? [["visibility", report.backend]] : [])]));
  function list(texts, faces) {
    const made = element("ul");
    texts.slice(0, 50).forEach((text, k) => {
      const line = element("li", text);
      if (data.places[faces[k]]) {
        const button = Object.assign(element("button", "show in 3D", "show-face"), { type: "button" });
        button.addEventListener("click", () => goTo(faces[k]));
        line.append(" ", button);
      }
      made.append(line);
    });
    if (texts.length > 50) made.append(element("li", `${texts.length - 50} more`));
    return made;
  }
};
