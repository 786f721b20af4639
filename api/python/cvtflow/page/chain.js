// The running chain, moved by a person.
"use strict";

/** Moved, turned, played and asked by a person. */
class RunningChain extends DrawnChain {
  constructor(motion) {
    super(motion);
    this.playing = false;
    this.controls();
    this.keys();
    this.resize();
    this.show(0);
  }

  show(moment) {
    this.moment = Math.min(Math.max(moment, 0), this.t.length - 1);
    this.place();
    this.frame();
    document.getElementById("moment").value = this.moment;
    document.getElementById("moment-text").textContent = `${readable(data.time.f * this.time())} ${data.time.u}`;
    this.tellPin();
  }

  play(on) {
    this.playing = on;
    document.getElementById("play").textContent = on ? "pause" : "play";
    let before = performance.now();
    const run = (now) => {
      if (!this.playing) return;
      const last = this.t.length - 1, states = last / (this.t[last] - this.t[0] || 1),
            ahead = Math.max(now - before, 0) / 1e3 / Number(document.getElementById("speed").value);
      before = now;
      const next = this.moment + ahead * states;
      this.show(next > last ? next % (last || 1) : next);   // a picture that takes longer than the record goes on as well
      requestAnimationFrame(run);
    };
    if (on) requestAnimationFrame(run);
  }

  controls() {
    const speed = document.getElementById("speed"), colour = document.getElementById("colour"), moment = document.getElementById("moment");
    for (const slow of [1, 10, 100, 1000, 10000])
      speed.append(element("option", {value: slow}, slow === 1 ? "as in life" : `${slow} times slower`));
    speed.value = 100;
    this.colours.forEach((c, k) => colour.append(element("option", {value: k}, c.unit === "" ? c.name : `${c.name} [${c.unit}]`)));
    colour.addEventListener("change", () => this.choose(Number(colour.value)));
    this.colour = this.colours[0] || {name: "nothing", unit: "", values: new Float32Array(this.x.length), from: 0, to: 0};
    this.legend();
    moment.step = "any";
    moment.addEventListener("input", () => {
      this.play(false);
      this.show(Number(moment.value));
    });
    document.getElementById("play").addEventListener("click", () => this.play(!this.playing));
    moment.max = this.t.length - 1;
    lookAround(this.canvas, (...by) => this.look(...by), (e) => this.click(e));
  }

  choose(number) {
    this.colour = this.colours[number];
    this.legend();
    this.show(this.moment);
    if (this.pin >= 0) this.plotPin();
  }

  keys() {
    this.canvas.addEventListener("keydown", (e) => {
      if (keyTurns[e.key])
        this.look(...keyTurns[e.key]);
      else if (e.key === " ")
        this.play(!this.playing);
      else if (e.key === "," || e.key === ".")
        this.show(Math.round(this.moment) + (e.key === "." ? 1 : -1));
      else if (e.key === "p" || e.key === "P")
        this.pick((this.pin + 1) % this.motion.pins);
      else
        return;
      e.preventDefault();
    });
  }

  legend() {
    const bar = element("canvas", {width: 200, height: 1}), paint = bar.getContext("2d"), {name, unit, from, to} = this.colour;
    for (let k = 0; k < 200; ++k) {
      paint.fillStyle = heatText(k / 199);
      paint.fillRect(k, 0, 1, 1);
    }
    const of = (value) => readable(Number(value.toPrecision(3))) + (unit === "" ? "" : " " + unit);
    document.getElementById("legend").replaceChildren(name + ": " + of(from), bar, of(to));
  }

  /** The pin nearest to where was clicked, if one is near. */
  click(event) {
    let nearest = -1, least = 20;
    for (let pin = 0; pin < this.motion.pins; ++pin) {
      const at = this.screen(pin), distance = Math.hypot(at.x - event.clientX, at.y - event.clientY);
      if (distance < least) {
        least = distance;
        nearest = pin;
      }
    }
    if (nearest >= 0) this.pick(nearest);
  }

  pick(pin) {
    this.pin = pin;
    this.show(this.moment);
    this.plotPin();
  }

  tellPin() {
    if (this.pin < 0) return;
    const numbers =
        this.colours.map((c) => `${c.name} ${readable(this.at(c.values, this.pin, this.moment))}${c.unit === "" ? "" : " " + c.unit}`);
    document.getElementById("pin").textContent = `pin ${this.pin} at ${readable(data.time.f * this.time())} ${data.time.u}: ${numbers.join(", ")}`;
  }

  plotPin() {
    if (this.chart) this.chart.destroy();
    const pins = this.motion.pins, rows = [...this.t].map((t, k) => [data.time.f * t, this.colour.values[k * pins + this.pin]]);
    const place = document.getElementById("pin-plot"), name = `${this.colour.name} of pin ${this.pin}`, style = getComputedStyle(root);
    place.className = "panel";
    this.chart = new Dygraph(place, rows, {
      labels: [`time [${data.time.u}]`, name],
      title: name,
      xlabel: `time [${data.time.u}]`,
      ylabel: this.colour.unit === "" ? "" : `[${this.colour.unit}]`,
      titleHeight: 20,
      colors: [colours[1]],
      axisLineColor: style.getPropertyValue("--soft"),
      gridLineColor: style.getPropertyValue("--line"),
      axes: {y: {valueFormatter: readable, axisLabelFormatter: readable, axisLabelWidth: 80}},
      clickCallback: (event, time) => this.show(this.t.findIndex((t) => data.time.f * t >= time - 1e-9)),
    });
  }
}

/** Runs the chain of a record; its controls begin anew. */
function runChain(number) {
  const view = document.getElementById("chain-view"), fresh = pristine.cloneNode(true);
  if (window.chain instanceof RunningChain) {
    window.chain.play(false);
    window.chain.renderer.forceContextLoss();
  }
  view.replaceWith(fresh);
  const record = document.getElementById("chain-record");
  if (record) {
    record.value = number;
    record.addEventListener("change", () => runChain(Number(record.value)));
  }
  window.chain = new RunningChain(data.motions[number]);
}
const pristine = document.getElementById("chain-view") && document.getElementById("chain-view").cloneNode(true);

if (data.motions) {
  try {
    runChain(0);
    document.addEventListener("theme", () => window.chain.frame());
    window.addEventListener("resize", () => window.chain.resize());
  } catch (error) {
    if (window.chain instanceof RunningChain || !/WebGL/.test(String(error))) throw error;
    document.getElementById("chain").replaceWith(element("p", {}, "This browser has no WebGL; the chain cannot be shown."));
  }
}
