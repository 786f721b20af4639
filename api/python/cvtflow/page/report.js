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

/** A text for Dygraphs, which takes labels for markup. */
function escaped(text) {
  const names = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "\"": "&quot;", "'": "&#39;"};
  return text.replace(/[&<>"']/g, (c) => names[c]);
}

function element(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#8c6d1f", "#777777"];

/** From dark blue (0) over green to yellow (1). */
function heat(share) {
  const stops = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
  const at = Math.min(Math.max(share, 0), 1) * 5, below = Math.min(Math.floor(at), 4), part = at - below;
  return stops[below].map((value, k) => (1 - part) * value + part * stops[below + 1][k]);
}
function heatText(share) { return "rgb(" + heat(share).map(Math.round).join(",") + ")"; }

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
document.getElementById("theme").addEventListener("click", () => {
  root.dataset.theme = dark() ? "light" : "dark";
  showTheme();
});
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
    const button = element("button", {type: "button"}, ...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => sortBy(table, column, heading));
  });
}

// Curves -----------------------------------------------------------------------------------------------------------------------------

/** Panels of curves over time with one zoom. */
class Curves {
  constructor(runs) {
    this.runs = runs.map((run) => ({label: run.label, t: unpacked(run.t, Float64Array), targets: run.targets || {},
                                    curves: new Map(run.curves.map((c) => [c.n, c]))}));
    this.values = new Map();
    this.charts = [];
    this.chosen = new Set();
    this.ends = [Math.min(...this.runs.map((r) => r.t[0])), Math.max(...this.runs.map((r) => r.t[r.t.length - 1]))].map((t) => data.time.f * t);
    this.window = [...this.ends];
    this.list(runs[0].curves);
    this.buttons();
  }

  /** All values of a curve of a run; null where the run has none. */
  of(run, name) {
    const key = this.runs.indexOf(run) + name;
    if (!this.values.has(key)) {
      const curve = run.curves.get(name);
      this.values.set(key, !curve ? null : curve.v ? unpacked(curve.v, Float32Array) : new Float32Array(run.t.length).fill(curve.c ?? NaN));
    }
    return this.values.get(key);
  }

  list(curves) {
    const place = document.getElementById("channels");
    for (const curve of curves) {
      const box = element("input", {type: "checkbox", value: curve.n});
      const plain = !curve.n.includes("/") && curve.v && this.chosen.size < 4;
      if (plain) {
        box.checked = true;
        this.chosen.add(curve.n);
      }
      box.addEventListener("change", () => {
        box.checked ? this.chosen.add(curve.n) : this.chosen.delete(curve.n);
        this.draw();
      });
      place.append(element("label", {title: curve.d}, box, " " + curve.n));
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
    for (const chart of this.charts) chart.updateOptions({dateWindow: window});
  }

  /** Names by unit: one panel each; numbers without a unit, and shares, stay alone: slip and efficiency share no axis. */
  panels() {
    const panels = new Map();
    for (const name of this.chosen) {
      const unit = this.runs[0].curves.get(name).u;
      const key = unit === "" || unit === "%" ? name : unit;
      panels.set(key, [...(panels.get(key) || []), name]);
    }
    return panels;
  }

  rows(names) {
    const columns = names.length * this.runs.length, at = new Map();
    this.runs.forEach((run, r) => names.forEach((name, c) => {
      const values = this.of(run, name);
      for (let k = 0; values && k < run.t.length; ++k) {
        const t = data.time.f * run.t[k];
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
      const panel = element("div", {class: "panel", role: "img", "aria-label": names.join(", ") + " over time"});
      place.append(element("div", {}, panel));
      this.charts.push(this.chart(panel, key, this.withTargets(names)));
    }
  }

  /** Names of a panel, and of what controllers hold in it. */
  withTargets(names) {
    const targets = names.map((name) => this.runs[0].targets[name]).filter((target) => target && !names.includes(target));
    return [...names, ...targets];
  }

  chart(panel, key, names) {
    const time = `time [${data.time.u}]`, labels = [time];
    for (const run of this.runs)
      for (const name of names) labels.push(this.runs.length > 1 ? name + ", " + run.label : name);
    const dashed = Object.fromEntries(labels.slice(1).filter((label) => this.runs.some((run) => Object.values(run.targets).some(
        (target) => label === target || label === target + ", " + run.label))).map((label) => [label, {strokePattern: [6, 4], strokeWidth: 1.6}]));
    const style = getComputedStyle(root), unit = this.runs[0].curves.get(names[0]).u;
    return new Dygraph(panel, this.rows(names), {
      labels,
      series: dashed,
      colors: colours,
      connectSeparatedPoints: true,
      strokeWidth: 1.2,
      labelsSeparateLines: true,
      legend: labels.length > 2 ? "always" : "onmouseover",
      xlabel: time,
      ylabel: escaped(unit === "" ? key : unit === "%" ? key + " [%]" : "[" + unit + "]"),
      dateWindow: this.window,
      axisLineColor: style.getPropertyValue("--soft"),
      gridLineColor: style.getPropertyValue("--line"),
      axes: {
        y: {valueFormatter: readable, axisLabelFormatter: readable, axisLabelWidth: 80},
        x: {valueFormatter: (t) => readable(t) + " " + data.time.u}
      },
      zoomCallback: (from, to) => this.show([from, to]),
    });
  }
}

// Pictures and tables that are wider than the page ----------------------------------------------------------------------------------

/** Whether there is more to the left or to the right, for the edges that style shows. */
function showEdges(scroller) {
  const rest = scroller.scrollWidth - scroller.clientWidth - scroller.scrollLeft;
  scroller.parentElement.toggleAttribute("data-before", scroller.scrollLeft > 1);
  scroller.parentElement.toggleAttribute("data-behind", rest > 1);
}
const scrollers = [...document.querySelectorAll(".scroller")];
for (const scroller of scrollers) {
  scroller.addEventListener("scroll", () => showEdges(scroller), {passive: true});
  if (window.ResizeObserver) new ResizeObserver(() => showEdges(scroller)).observe(scroller);
}

showTheme();
if (data.runs) {
  window.curves = new Curves(data.runs);
  window.curves.draw();
  document.addEventListener("theme", () => window.curves.draw());
}
