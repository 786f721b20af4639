// The picture of a sweep: any columns over any others.
"use strict";

const svgSpace = "http://www.w3.org/2000/svg";
function drawn(name, attributes, text) {
  const made = document.createElementNS(svgSpace, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}
function roundTicks(least, largest) {
  const rough = (largest - least) / 6 || 1, decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((f) => f * decade >= rough) * decade, ticks = [];
  for (let k = Math.ceil(least / step); k * step <= largest; ++k) ticks.push(k * step);
  return ticks;
}

/** A circle, square, triangle or diamond about a point. */
function mark(kind, x, y) {
  return [`M${x - 4.5} ${y}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0`, `M${x - 4} ${y - 4}h8v8h-8z`, `M${x} ${y - 5}l5 9h-10z`,
          `M${x} ${y - 6}l6 6l-6 6l-6 -6z`][kind % 4];
}

/** y over x of the cases of sweeps, coloured by a third column; cases that differ in x alone are joined. */
class SweepPicture {
  constructor(sweep) {
    this.sweep = sweep;
    this.columns = new Map(sweep.columns.map((c) => [c.n, c]));
    const axes = sweep.columns.filter((c) => c.axis && new Set(c.v).size > 1);
    const results = sweep.columns.filter((c) => !c.axis && c.n !== "case" && new Set(c.v).size > 1);
    this.choices = {x: (axes.at(-1) || sweep.columns[0]).n, y: (results[0] || sweep.columns[0]).n, colour: (axes[0] || sweep.columns[0]).n};
    this.axes = axes;
    for (const [what, chosen] of Object.entries(this.choices)) {
      const select = document.getElementById("map-" + what);
      for (const name of this.columns.keys()) select.append(element("option", {value: name}, name));
      select.value = chosen;
      select.addEventListener("change", () => {
        this.choices[what] = select.value;
        this.draw();
      });
    }
    this.draw();
  }

  points() {
    const [x, y, colour] = ["x", "y", "colour"].map((what) => this.columns.get(this.choices[what]));
    const others = this.axes.filter((axis) => axis !== x && axis !== y);
    return this.sweep.cases
        .map((status, k) => ({status, number: k, x: x.v[k], y: y.v[k], c: colour.v[k], of: this.sweep.of[k],
                              line: [this.sweep.of[k], ...others.map((o) => o.v[k])].join()}))
        .filter((p) => p.status === "ok" && [p.x, p.y, p.c].every(Number.isFinite));
  }

  draw() {
    const points = this.points(), width = 860, height = 460, box = {left: 90, right: 700, top: 20, bottom: 400};
    const range = (key) => {
      const values = points.map((p) => p[key]), least = Math.min(...values), largest = Math.max(...values);
      const margin = 0.04 * (largest - least) || Math.abs(least) * 0.1 || 1;
      return key === "c" ? [least, largest] : [least - margin, largest + margin];
    };
    const picture = drawn("svg", {viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "font-size": 12, fill: "#222"});
    picture.append(drawn("rect", {width, height, fill: "#fff"}));
    document.getElementById("map-view").replaceChildren(picture);
    if (points.length === 0) {
      picture.append(drawn("text", {x: 100, y: 100}, "no case that ended well has these numbers"));
      return;
    }
    const [x, y, c] = [range("x"), range("y"), range("c")];
    const px = (v) => box.left + (v - x[0]) / (x[1] - x[0]) * (box.right - box.left);
    const py = (v) => box.bottom - (v - y[0]) / (y[1] - y[0]) * (box.bottom - box.top);
    const share = (v) => (c[1] > c[0] ? (v - c[0]) / (c[1] - c[0]) : 0.5);
    this.frame(picture, box, x, y, px, py);
    const lines =
        Map.groupBy ? Map.groupBy(points, (p) => p.line) : points.reduce((m, p) => m.set(p.line, [...(m.get(p.line) || []), p]), new Map());
    for (const line of lines.values()) {
      const path = line.sort((a, b) => a.x - b.x).map((p, k) => `${k ? "L" : "M"}${px(p.x).toFixed(1)} ${py(p.y).toFixed(1)}`).join("");
      picture.append(drawn("path", {d: path, fill: "none", stroke: heatText(share(line[0].c)), "stroke-opacity": 0.5,
                                     "stroke-dasharray": line[0].of % 2 ? "6 4" : "none"}));
    }
    for (const p of points) {
      const dot = drawn("path", {d: mark(p.of, px(p.x), py(p.y)), fill: heatText(share(p.c)), class: "case", "data-case": p.number});
      const of = this.sweep.names.length > 1 ? this.sweep.names[p.of] + ", " : "";
      dot.append(drawn("title", {}, `${of}case ${this.number(p)}: ${readable(p.x)}, ${readable(p.y)}, ${readable(p.c)}`));
      picture.append(dot);
    }
    this.legend(picture);
    this.scale(picture, c);
  }

  /** A case's number in its own sweep. */
  number(p) {
    return this.columns.has("case") ? this.columns.get("case").v[p.number] : p.number;
  }

  /** Marks of the sweeps, if there are several. */
  legend(picture) {
    if (this.sweep.names.length < 2) return;
    this.sweep.names.forEach((name, k) => {
      picture.append(drawn("path", {d: mark(k, 722, 232 + 20 * k), fill: "#666"}), drawn("text", {x: 734, y: 236 + 20 * k}, name.length > 17 ? "…" + name.slice(-16) : name));
    });
  }

  heading(what) {
    return this.columns.get(this.choices[what]).label;
  }

  frame(picture, box, x, y, px, py) {
    for (const tick of roundTicks(...x)) {
      picture.append(drawn("path", {d: `M${px(tick)} ${box.top}V${box.bottom}`, stroke: "#ddd"}));
      picture.append(drawn("text", {x: px(tick), y: box.bottom + 17, "text-anchor": "middle"}, readable(tick)));
    }
    for (const tick of roundTicks(...y)) {
      picture.append(drawn("path", {d: `M${box.left} ${py(tick)}H${box.right}`, stroke: "#ddd"}));
      picture.append(drawn("text", {x: box.left - 6, y: py(tick) + 4, "text-anchor": "end"}, readable(tick)));
    }
    picture.append(
        drawn("rect", {x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top, fill: "none", stroke: "#666"}));
    const middle = 0.5 * (box.top + box.bottom);
    picture.append(drawn("text", {x: 0.5 * (box.left + box.right), y: box.bottom + 40, "text-anchor": "middle"}, this.heading("x")));
    picture.append(drawn("text", {x: 16, y: middle, "text-anchor": "middle", transform: `rotate(-90 16 ${middle})`}, this.heading("y")));
  }

  scale(picture, c) {
    picture.append(drawn("text", {x: 716, y: 30}, this.heading("colour")));
    const top = 42, height = 160, stripes = 80;
    for (let k = 0; k < stripes; ++k) {
      const fill = heatText(1 - (k + 0.5) / stripes);
      picture.append(drawn("rect", {x: 716, y: top + k * height / stripes, width: 24, height: height / stripes, fill, "shape-rendering": "crispEdges"}));
    }
    for (const tick of c[1] > c[0] ? roundTicks(...c) : c.slice(1)) {
      const y = top + (c[1] > c[0] ? (c[1] - tick) / (c[1] - c[0]) : 0.5) * height;
      picture.append(drawn("path", {d: `M740 ${y}h4`, stroke: "#222"}), drawn("text", {x: 748, y: y + 4}, readable(tick)));
    }
  }
}

window.picture = new SweepPicture(data.sweep);
