// Curves, tables and pictures of a report. Data stand in #data; nothing is fetched.
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);

/** Numbers from base64. @param Kind a typed array */
function unpacked(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Kind(bytes.buffer);
}

/** "0.000123", "1.2e-9": six digits, as a person reads them. */
function readable(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size >= 1e6 || size < 1e-4) ? value.toExponential(4) : String(Number(value.toPrecision(6)));
}

function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8c6d1f", "#777777"];

// Light and dark ---------------------------------------------------------------------------------------------------------------------

const root = document.documentElement;
const wantsDark = window.matchMedia("(prefers-color-scheme: dark)");
function dark() { return root.dataset.theme ? root.dataset.theme === "dark" : wantsDark.matches; }
function showTheme() {
  root.dataset.shown = dark() ? "dark" : "light";
  const button = document.getElementById("theme");
  button.setAttribute("aria-pressed", dark());
  button.textContent = dark() ? "light" : "dark";
  document.dispatchEvent(new Event("theme"));
}
document.getElementById("theme").addEventListener("click", () => { root.dataset.theme = dark() ? "light" : "dark"; showTheme(); });
wantsDark.addEventListener("change", showTheme);

// Tables that can be sorted ----------------------------------------------------------------------------------------------------------

function cellValue(row, column) {
  const cell = row.cells[column];
  return cell.dataset.value !== undefined ? Number(cell.dataset.value) : cell.textContent;
}
function compare(a, b) {
  if (typeof a === "number" && typeof b === "number") return Number.isNaN(a) ? 1 : Number.isNaN(b) ? -1 : a - b;
  return String(a).localeCompare(String(b));
}
function sortBy(table, column, heading) {
  const ascending = heading.getAttribute("aria-sort") !== "ascending";
  for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
  heading.setAttribute("aria-sort", ascending ? "ascending" : "descending");
  const rows = [...table.tBodies[0].rows];
  rows.sort((a, b) => (ascending ? 1 : -1) * compare(cellValue(a, column), cellValue(b, column)));
  table.tBodies[0].append(...rows);
}
for (const table of document.querySelectorAll("table.sortable")) {
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = element("button", { type: "button" }, ...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => sortBy(table, column, heading));
  });
}

// Curves -----------------------------------------------------------------------------------------------------------------------------

/** Panels of curves over time with one zoom. */
class Curves {
  constructor(runs) {
    this.runs = runs.map((run) => ({ label: run.label, t: unpacked(run.t, Float64Array), curves: new Map(run.curves.map((c) => [c.n, c])) }));
    this.values = new Map();
    this.charts = [];
    this.chosen = new Set();
    this.ends = [Math.min(...this.runs.map((r) => r.t[0])) * 1e3, Math.max(...this.runs.map((r) => r.t[r.t.length - 1])) * 1e3];
    this.window = [...this.ends];
    this.list(runs[0].curves);
    this.buttons();
  }

  /** All values of a curve of a run; null where the run has none. */
  of(run, name) {
    const key = this.runs.indexOf(run) + name;
    if (!this.values.has(key)) {
      const curve = run.curves.get(name);
      this.values.set(key, !curve ? null : curve.v ? unpacked(curve.v, Float32Array) : new Float32Array(run.t.length).fill(curve.c));
    }
    return this.values.get(key);
  }

  list(curves) {
    const place = document.getElementById("channels");
    for (const curve of curves) {
      const box = element("input", { type: "checkbox", value: curve.n });
      const plain = !curve.n.includes("/") && curve.v && this.chosen.size < 4;
      if (plain) { box.checked = true; this.chosen.add(curve.n); }
      box.addEventListener("change", () => { box.checked ? this.chosen.add(curve.n) : this.chosen.delete(curve.n); this.draw(); });
      place.append(element("label", { title: curve.d }, box, " " + curve.n));
    }
    document.getElementById("filter").addEventListener("input", (event) => {
      for (const label of place.querySelectorAll("label")) label.hidden = !label.textContent.includes(event.target.value.trim());
    });
  }

  buttons() {
    for (const button of document.querySelectorAll("#curves-tools [data-zoom]"))
      button.addEventListener("click", () => this.zoom(Number(button.dataset.zoom), 0));
    for (const button of document.querySelectorAll("#curves-tools [data-move]"))
      button.addEventListener("click", () => this.zoom(1, Number(button.dataset.move)));
    document.getElementById("whole").addEventListener("click", () => this.show([...this.ends]));
  }

  zoom(factor, move) {
    const [from, to] = this.window, middle = 0.5 * (from + to) + move * (to - from), half = 0.5 * factor * (to - from);
    this.show([Math.max(this.ends[0], middle - half), Math.min(this.ends[1], middle + half)]);
  }

  show(window) {
    this.window = window;
    for (const chart of this.charts) chart.updateOptions({ dateWindow: window });
  }

  /** Names by unit: one panel each; numbers without a unit stay alone. */
  panels() {
    const panels = new Map();
    for (const name of this.chosen) {
      const unit = this.runs[0].curves.get(name).u;
      const key = unit === "1" ? name : unit;
      panels.set(key, [...(panels.get(key) || []), name]);
    }
    return panels;
  }

  rows(names) {
    const columns = names.length * this.runs.length, at = new Map();
    this.runs.forEach((run, r) => names.forEach((name, c) => {
      const values = this.of(run, name);
      for (let k = 0; values && k < run.t.length; ++k) {
        const t = run.t[k] * 1e3;
        if (!at.has(t)) at.set(t, [t, ...new Array(columns).fill(null)]);
        at.get(t)[1 + r * names.length + c] = values[k];
      }
    }));
    return [...at.values()].sort((a, b) => a[0] - b[0]);
  }

  draw() {
    for (const chart of this.charts) chart.destroy();
    this.charts = [];
    const place = document.getElementById("panels");
    place.replaceChildren();
    for (const [key, names] of this.panels()) {
      const panel = element("div", { class: "panel", role: "img", "aria-label": names.join(", ") + " over time" });
      place.append(element("div", {}, panel));
      this.charts.push(this.chart(panel, key, names));
    }
  }

  chart(panel, key, names) {
    const labels = ["time [ms]"];
    for (const run of this.runs) for (const name of names) labels.push(this.runs.length > 1 ? name + ", " + run.label : name);
    const style = getComputedStyle(root), unit = this.runs[0].curves.get(names[0]).u;
    return new Dygraph(panel, this.rows(names), {
      labels, colors: colours, connectSeparatedPoints: true, strokeWidth: 1.2, legend: "follow", labelsSeparateLines: true,
      legend: "onmouseover", xlabel: "time [ms]", ylabel: unit === "1" ? key : "[" + unit + "]", dateWindow: this.window,
      axisLineColor: style.getPropertyValue("--soft"), gridLineColor: style.getPropertyValue("--line"),
      axes: { y: { valueFormatter: readable, axisLabelFormatter: readable, axisLabelWidth: 64 }, x: { valueFormatter: (t) => readable(t) + " ms" } },
      zoomCallback: (from, to) => this.show([from, to]),
    });
  }
}

// Pictures of sweeps -----------------------------------------------------------------------------------------------------------------

const svgSpace = "http://www.w3.org/2000/svg";
function drawn(name, attributes, text) {
  const made = document.createElementNS(svgSpace, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}
/** From dark blue (0) over green to yellow (1). */
function heat(share) {
  const stops = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
  const at = Math.min(Math.max(share, 0), 1) * 5, below = Math.min(Math.floor(at), 4), part = at - below;
  return stops[below].map((value, k) => (1 - part) * value + part * stops[below + 1][k]);
}
function heatText(share) { return "rgb(" + heat(share).map(Math.round).join(",") + ")"; }

function roundTicks(least, largest) {
  const rough = (largest - least) / 6 || 1, decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((f) => f * decade >= rough) * decade, ticks = [];
  for (let k = Math.ceil(least / step); k * step <= largest; ++k) ticks.push(k * step);
  return ticks;
}

/** y over x of a sweep's cases, coloured by a third column; cases that differ in x alone are joined. */
class SweepPicture {
  constructor(sweep) {
    this.sweep = sweep;
    this.columns = new Map(sweep.columns.map((c) => [c.n, c]));
    const axes = sweep.columns.filter((c) => c.axis && new Set(c.v).size > 1);
    const results = sweep.columns.filter((c) => !c.axis && c.n !== "case" && new Set(c.v).size > 1);
    this.choices = { x: (axes.at(-1) || sweep.columns[0]).n, y: (results[0] || sweep.columns[0]).n, colour: (axes[0] || sweep.columns[0]).n };
    this.axes = axes;
    for (const [what, chosen] of Object.entries(this.choices)) {
      const select = document.getElementById("map-" + what);
      for (const name of this.columns.keys()) select.append(element("option", { value: name }, name));
      select.value = chosen;
      select.addEventListener("change", () => { this.choices[what] = select.value; this.draw(); });
    }
    this.draw();
  }

  points() {
    const [x, y, colour] = ["x", "y", "colour"].map((what) => this.columns.get(this.choices[what]));
    const others = this.axes.filter((axis) => axis !== x && axis !== y);
    return this.sweep.cases.map((status, k) => ({ status, number: k, x: x.v[k], y: y.v[k], c: colour.v[k], line: others.map((o) => o.v[k]).join() }))
      .filter((p) => p.status === "ok" && [p.x, p.y, p.c].every(Number.isFinite));
  }

  draw() {
    const points = this.points(), width = 860, height = 460, box = { left: 90, right: 700, top: 20, bottom: 400 };
    const range = (key) => {
      const values = points.map((p) => p[key]), least = Math.min(...values), largest = Math.max(...values);
      const margin = 0.04 * (largest - least) || Math.abs(least) * 0.1 || 1;
      return key === "c" ? [least, largest] : [least - margin, largest + margin];
    };
    const picture = drawn("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "font-size": 12, fill: "#222" });
    picture.append(drawn("rect", { width, height, fill: "#fff" }));
    document.getElementById("map-view").replaceChildren(picture);
    if (points.length === 0) { picture.append(drawn("text", { x: 100, y: 100 }, "no case that ended well has these numbers")); return; }
    const [x, y, c] = [range("x"), range("y"), range("c")];
    const px = (v) => box.left + (v - x[0]) / (x[1] - x[0]) * (box.right - box.left);
    const py = (v) => box.bottom - (v - y[0]) / (y[1] - y[0]) * (box.bottom - box.top);
    const share = (v) => (c[1] > c[0] ? (v - c[0]) / (c[1] - c[0]) : 0.5);
    this.frame(picture, box, x, y, px, py);
    const lines = Map.groupBy ? Map.groupBy(points, (p) => p.line) : points.reduce((m, p) => m.set(p.line, [...(m.get(p.line) || []), p]), new Map());
    for (const line of lines.values()) {
      const path = line.sort((a, b) => a.x - b.x).map((p, k) => `${k ? "L" : "M"}${px(p.x).toFixed(1)} ${py(p.y).toFixed(1)}`).join("");
      picture.append(drawn("path", { d: path, fill: "none", stroke: heatText(share(line[0].c)), "stroke-opacity": 0.5 }));
    }
    for (const p of points) {
      const dot = drawn("circle", { cx: px(p.x), cy: py(p.y), r: 4.5, fill: heatText(share(p.c)), "data-case": p.number });
      dot.append(drawn("title", {}, `case ${p.number}: ${readable(p.x)}, ${readable(p.y)}, ${readable(p.c)}`));
      picture.append(dot);
    }
    this.scale(picture, c);
  }

  heading(what) { const column = this.columns.get(this.choices[what]); return column.n + (column.u ? ` [${column.u}]` : ""); }

  frame(picture, box, x, y, px, py) {
    for (const tick of roundTicks(...x)) {
      picture.append(drawn("path", { d: `M${px(tick)} ${box.top}V${box.bottom}`, stroke: "#ddd" }));
      picture.append(drawn("text", { x: px(tick), y: box.bottom + 17, "text-anchor": "middle" }, readable(tick)));
    }
    for (const tick of roundTicks(...y)) {
      picture.append(drawn("path", { d: `M${box.left} ${py(tick)}H${box.right}`, stroke: "#ddd" }));
      picture.append(drawn("text", { x: box.left - 6, y: py(tick) + 4, "text-anchor": "end" }, readable(tick)));
    }
    picture.append(drawn("rect", { x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top, fill: "none", stroke: "#666" }));
    const middle = 0.5 * (box.top + box.bottom);
    picture.append(drawn("text", { x: 0.5 * (box.left + box.right), y: box.bottom + 40, "text-anchor": "middle" }, this.heading("x")));
    picture.append(drawn("text", { x: 16, y: middle, "text-anchor": "middle", transform: `rotate(-90 16 ${middle})` }, this.heading("y")));
  }

  scale(picture, c) {
    picture.append(drawn("text", { x: 716, y: 30 }, this.heading("colour")));
    for (let k = 0; k <= 6; ++k) {
      picture.append(drawn("rect", { x: 716, y: 42 + 22 * (6 - k), width: 24, height: 22, fill: heatText(k / 6) }));
      picture.append(drawn("text", { x: 748, y: 57 + 22 * (6 - k) }, readable(c[0] + k / 6 * (c[1] - c[0]))));
    }
  }
}

showTheme();
if (data.runs) {
  window.curves = new Curves(data.runs);
  window.curves.draw();
  document.addEventListener("theme", () => window.curves.draw());
}
if (data.sweep) window.picture = new SweepPicture(data.sweep);
