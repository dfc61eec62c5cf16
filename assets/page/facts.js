"use strict";
// What is known of the solution, as tables in the element `into`.
const patchlightFacts = (data, into, { short, percent }) => {
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
  if (report) {
    const { emitted, absorbed, escaped, unaccounted } = report.energy;
    const power = (name, x) => [name, `${short(x)} W`, Math.abs(x) / emitted];
    section("Energy, by the elements of the solver", table([power("emitted", emitted), power("absorbed", absorbed), power("escaped", escaped), power("not accounted for", unaccounted)]));
    const times = report.time_s;
    const stages = ["load", "build", "refine", "resolve", "error", "mesh", "bounds", "sample", "output"].filter((stage) => times[stage] > 0.0005);
    section("Time", table([...stages.map((stage) => [stage, `${times[stage].toFixed(2)} s`, times[stage] / times.total]), ["total", `${times.total.toFixed(2)} s`], ["CPU", report.cpu_s.total === null ? "not known" : `${report.cpu_s.total.toFixed(2)} s`]]));
    section("Warnings", report.warnings.length ? list(report.warnings) : element("p", "None.", "claim"));
  }
  section("What there is", table(data.counts.map(([name, value]) => [name, String(value)])));
  section("Again", element("code", data.command));
  section("Options that are not the default", data.options.length ? table(data.options) : element("p", "None.", "claim"));
  section("Software", table([["version", data.software], ...(report ? [["visibility", report.backend]] : [])]));
  function list(texts) {
    const made = element("ul");
    texts.slice(0, 50).forEach((text) => made.append(element("li", text)));
    if (texts.length > 50) made.append(element("li", `${texts.length - 50} more`));
    return made;
  }
};
