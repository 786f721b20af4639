// The running chain: pins, plates and sheaves as instanced solids at the recorded states.
"use strict";

/** A quantised series back as numbers. */
function restored(series) {
  const whole = unpacked(series.v, Uint16Array), values = new Float32Array(whole.length), step = (series.to - series.from) / 65535;
  for (let k = 0; k < whole.length; ++k) values[k] = series.from + whole[k] * step;
  return values;
}

class RunningChain {
  constructor(motion) {
    this.motion = motion;
    this.t = unpacked(motion.t, Float64Array);
    for (const axis of ["x", "y", "z"]) this[axis] = restored(motion[axis]).map((metres) => 1e3 * metres);
    this.colours = motion.colours.map((c) => ({ name: c.n, unit: c.u, values: restored(c.v), from: c.v.from, to: c.v.to }));
    this.shafts = motion.shafts.map((s) => ({ angle: unpacked(s.angle, Float32Array), radius: unpacked(s.radius, Float32Array) }));
    this.moment = 0;
    this.playing = false;
    this.pin = -1;
    this.view = { turn: 0.45, lift: 0.5, distance: 420, x: 500 * motion.distance, y: 0 };
    this.canvas = document.getElementById("chain");
    this.build();
    this.controls();
    this.keys();
    this.resize();
    this.show(0);
  }

  build() {
    const THREE = window.THREE;
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 2, 10, 5000);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.6);
    lamp.position.set(200, 400, 600);
    this.scene.add(lamp);
    const pins = this.motion.pins, pitch = this.pitch(), width = 1e3 * this.motion.width;
    const metal = () => new THREE.MeshLambertMaterial({ color: 0xffffff });
    this.pins = new THREE.InstancedMesh(new THREE.BoxGeometry(1.6 * width, 2.6 * width, 1e3 * this.motion.length), metal(), pins);
    const packs = Math.min(this.motion.plates, 5);
    this.packs = [...Array(packs).keys()].map((k) => (packs > 1 ? 1e3 * this.motion.span * (2 * k / (packs - 1) - 1) : 0));
    this.plates = new THREE.InstancedMesh(new THREE.BoxGeometry(pitch + 1.2 * width, 3.4 * width, 1.4), metal(), pins * packs);
    for (const mesh of [this.pins, this.plates]) { mesh.frustumCulled = false; this.scene.add(mesh); }
    this.sheaves = [];
    if (this.motion.pulleys) for (const shaft of [0, 1]) for (const side of [-1, 1]) this.sheaves.push(this.sheave(shaft, side));
  }

  pitch() { const dx = this.x[1] - this.x[0], dy = this.y[1] - this.y[0]; return Math.hypot(dx, dy); }

  /** A cone between the innermost and the outermost radius, with marks that show how it turns. */
  sheave(shaft, side) {
    const THREE = window.THREE, inner = 1e3 * this.motion.innermost * 0.6, outer = 1e3 * this.motion.outermost;
    const lean = Math.tan(this.motion.flank), profile = [[inner, lean * inner], [outer, lean * outer], [outer, lean * outer + 5], [inner, lean * inner + 12]];
    const solid = new THREE.LatheGeometry([...profile, profile[0]].map(([r, z]) => new THREE.Vector2(r, z)), 72);
    solid.rotateX(side * Math.PI / 2);
    const mesh = new THREE.Mesh(solid, new THREE.MeshLambertMaterial({ color: 0x9fb0c0, transparent: true, opacity: 0.35, side: THREE.DoubleSide, depthWrite: false }));
    const marks = new THREE.InstancedMesh(new THREE.BoxGeometry(outer - inner, 1.2, 1.2), new THREE.MeshLambertMaterial({ color: 0x708090 }), 6), at = new THREE.Matrix4();
    for (let k = 0; k < 6; ++k) {
      const middle = 0.5 * (inner + outer);
      at.makeRotationZ(k * Math.PI / 3);
      at.multiply(new THREE.Matrix4().makeTranslation(middle, 0, side * (lean * middle + 8)));
      marks.setMatrixAt(k, at);
    }
    const both = new THREE.Group();
    both.add(mesh, marks);
    this.scene.add(both);
    return { both, shaft, side };
  }

  /** Between the two states at a moment, that may be a fraction. */
  at(values, pin, moment) {
    const below = Math.min(Math.floor(moment), this.t.length - 1), above = Math.min(below + 1, this.t.length - 1), part = moment - below, pins = this.motion.pins;
    return (1 - part) * values[below * pins + pin] + part * values[above * pins + pin];
  }
  of(series, moment) {
    const below = Math.min(Math.floor(moment), series.length - 1), above = Math.min(below + 1, series.length - 1);
    return series[below] + (moment - below) * (series[above] - series[below]);
  }
  time() { return this.of(this.t, this.moment); }
  /** What the chosen colour says of a pin now. */
  value(pin) { return this.at(this.colour.values, pin, this.moment); }

  show(moment) {
    this.moment = Math.min(Math.max(moment, 0), this.t.length - 1);
    this.place();
    this.frame();
    document.getElementById("moment").value = this.moment;
    document.getElementById("moment-text").textContent = readable(1e3 * this.time()) + " ms";
    this.tellPin();
  }

  place() {
    const THREE = window.THREE, pins = this.motion.pins, where = this.where || (this.where = [...Array(pins)].map(() => new THREE.Vector3()));
    const matrix = new THREE.Matrix4(), shift = new THREE.Matrix4(), tint = new THREE.Color(), { from, to } = this.colour;
    for (let pin = 0; pin < pins; ++pin) where[pin].set(this.at(this.x, pin, this.moment), this.at(this.y, pin, this.moment), this.at(this.z, pin, this.moment));
    for (let pin = 0; pin < pins; ++pin) {
      const here = where[pin], next = where[(pin + 1) % pins], lean = Math.atan2(next.y - here.y, next.x - here.x);
      const share = to > from ? (this.value(pin) - from) / (to - from) : 0.5, [r, g, b] = heat(share);
      tint.setRGB(r / 255, g / 255, b / 255);
      matrix.makeRotationZ(lean);
      matrix.setPosition(here.x, here.y, here.z);
      this.pins.setMatrixAt(pin, matrix);
      if (pin === this.pin) this.pins.setColorAt(pin, new THREE.Color(0xff2020));
      else this.pins.setColorAt(pin, tint);
      matrix.setPosition(0.5 * (here.x + next.x), 0.5 * (here.y + next.y), 0.5 * (here.z + next.z));
      this.packs.forEach((z, k) => {
        const at = pin * this.packs.length + k;
        this.plates.setMatrixAt(at, shift.copy(matrix).multiply(new THREE.Matrix4().makeTranslation(0, 0, z)));
        this.plates.setColorAt(at, tint);
      });
    }
    for (const mesh of [this.pins, this.plates]) { mesh.instanceMatrix.needsUpdate = true; mesh.instanceColor.needsUpdate = true; }
    for (const { both, shaft, side } of this.sheaves) {
      const radius = 1e3 * this.of(this.shafts[shaft].radius, this.moment);
      both.position.set(shaft * 1e3 * this.motion.distance, 0, side * (500 * this.motion.length - Math.tan(this.motion.flank) * radius));
      both.rotation.z = this.of(this.shafts[shaft].angle, this.moment);
    }
  }

  frame() {
    const { turn, lift, distance, x, y } = this.view;
    this.camera.position.set(x + distance * Math.sin(turn) * Math.cos(lift), y + distance * Math.sin(lift), distance * Math.cos(turn) * Math.cos(lift));
    this.camera.lookAt(x, y, 0);
    this.renderer.render(this.scene, this.camera);
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.frame();
  }

  play(on) {
    this.playing = on;
    document.getElementById("play").textContent = on ? "pause" : "play";
    let before = performance.now();
    const run = (now) => {
      if (!this.playing) return;
      const states = (this.t.length - 1) / (this.t[this.t.length - 1] - this.t[0] || 1), ahead = (now - before) / 1e3 / Number(document.getElementById("speed").value);
      before = now;
      const next = this.moment + ahead * states;
      this.show(next > this.t.length - 1 ? 0 : next);
      requestAnimationFrame(run);
    };
    if (on) requestAnimationFrame(run);
  }

  controls() {
    const speed = document.getElementById("speed"), colour = document.getElementById("colour"), moment = document.getElementById("moment");
    for (const slow of [1, 10, 100, 1000, 10000]) speed.append(element("option", { value: slow }, slow === 1 ? "as in life" : `${slow} times slower`));
    speed.value = 100;
    this.colours.forEach((c, k) => colour.append(element("option", { value: k }, c.unit === "1" ? c.name : `${c.name} [${c.unit}]`)));
    colour.addEventListener("change", () => this.choose(Number(colour.value)));
    this.colour = this.colours[0] || { name: "nothing", unit: "", values: new Float32Array(this.x.length), from: 0, to: 0 };
    this.legend();
    moment.step = "any";
    moment.addEventListener("input", () => { this.play(false); this.show(Number(moment.value)); });
    document.getElementById("play").addEventListener("click", () => this.play(!this.playing));
    window.addEventListener("resize", () => this.resize());
    let held = null;
    this.canvas.addEventListener("pointerdown", (e) => { held = { x: e.clientX, y: e.clientY, moved: false }; this.canvas.setPointerCapture(e.pointerId); });
    this.canvas.addEventListener("pointermove", (e) => {
      if (!held) return;
      const dx = e.clientX - held.x, dy = e.clientY - held.y;
      if (!held.moved && Math.hypot(dx, dy) < 4) return;
      held = { x: e.clientX, y: e.clientY, moved: true };
      this.look(-0.006 * dx, 0.006 * dy, 1);
    });
    this.canvas.addEventListener("pointerup", (e) => { if (held && !held.moved) this.click(e); held = null; });
    this.canvas.addEventListener("wheel", (e) => { e.preventDefault(); this.look(0, 0, Math.exp(1e-3 * e.deltaY)); }, { passive: false });
  }

  choose(number) { this.colour = this.colours[number]; this.legend(); this.show(this.moment); if (this.pin >= 0) this.plotPin(); }

  look(turn, lift, zoom) {
    this.view.turn += turn;
    this.view.lift = Math.min(Math.max(this.view.lift + lift, -1.5), 1.5);
    this.view.distance = Math.min(Math.max(this.view.distance * zoom, 60), 2500);
    this.frame();
  }

  keys() {
    const turns = { ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1], "+": [0, 0, 0.9], "-": [0, 0, 1.1] };
    this.canvas.addEventListener("keydown", (e) => {
      if (turns[e.key]) this.look(...turns[e.key]);
      else if (e.key === " ") this.play(!this.playing);
      else if (e.key === "," || e.key === ".") this.show(Math.round(this.moment) + (e.key === "." ? 1 : -1));
      else if (e.key === "p" || e.key === "P") this.pick((this.pin + 1) % this.motion.pins);
      else return;
      e.preventDefault();
    });
  }

  legend() {
    const bar = element("canvas", { width: 200, height: 1 }), paint = bar.getContext("2d"), { name, unit, from, to } = this.colour;
    for (let k = 0; k < 200; ++k) { paint.fillStyle = heatText(k / 199); paint.fillRect(k, 0, 1, 1); }
    const of = (value) => readable(value) + (unit === "1" ? "" : " " + unit);
    document.getElementById("legend").replaceChildren(name + ": " + of(from), bar, of(to));
  }

  click(event) {
    const THREE = window.THREE, box = this.canvas.getBoundingClientRect(), ray = new THREE.Raycaster();
    ray.setFromCamera({ x: 2 * (event.clientX - box.left) / box.width - 1, y: 1 - 2 * (event.clientY - box.top) / box.height }, this.camera);
    const hit = ray.intersectObjects([this.pins, this.plates])[0];
    if (hit) this.pick(hit.object === this.pins ? hit.instanceId : Math.floor(hit.instanceId / this.packs.length));
  }

  pick(pin) { this.pin = pin; this.show(this.moment); this.plotPin(); }

  tellPin() {
    if (this.pin < 0) return;
    const numbers = this.colours.map((c) => `${c.name} ${readable(this.at(c.values, this.pin, this.moment))}${c.unit === "1" ? "" : " " + c.unit}`);
    document.getElementById("pin").textContent = `pin ${this.pin} at ${readable(1e3 * this.time())} ms: ${numbers.join(", ")}`;
  }

  plotPin() {
    if (this.chart) this.chart.destroy();
    const pins = this.motion.pins, rows = [...this.t].map((t, k) => [1e3 * t, this.colour.values[k * pins + this.pin]]);
    const place = document.getElementById("pin-plot"), name = `${this.colour.name} of pin ${this.pin}`, style = getComputedStyle(root);
    place.className = "panel";
    this.chart = new Dygraph(place, rows, {
      labels: ["time [ms]", name], title: name, xlabel: "time [ms]", ylabel: this.colour.unit === "1" ? "" : `[${this.colour.unit}]`, titleHeight: 20,
      colors: [colours[1]], axisLineColor: style.getPropertyValue("--soft"), gridLineColor: style.getPropertyValue("--line"),
      axes: { y: { valueFormatter: readable, axisLabelFormatter: readable, axisLabelWidth: 64 } },
      clickCallback: (event, time) => this.show(this.t.findIndex((t) => 1e3 * t >= time - 1e-9)),
    });
  }
}

if (data.motion) {
  try {
    window.chain = new RunningChain(data.motion);
    document.addEventListener("theme", () => window.chain.frame());
  } catch (error) {
    if (window.chain || !/WebGL/.test(String(error))) throw error;
    document.getElementById("chain").replaceWith(element("p", {}, "This browser has no WebGL; the chain cannot be shown."));
  }
}
