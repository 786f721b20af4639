// The chain as instanced solids at its recorded states: pins, plates, sheaves.
"use strict";

/** A quantised series back as numbers. */
function restored(series) {
  const whole = unpacked(series.v, Uint16Array), values = new Float32Array(whole.length), step = (series.to - series.from) / 65535;
  for (let k = 0; k < whole.length; ++k) values[k] = series.from + whole[k] * step;
  return values;
}

/** Turn, lift and zoom of a view by a key. */
const keyTurns = {
  ArrowLeft: [-0.1, 0, 1],
  ArrowRight: [0.1, 0, 1],
  ArrowUp: [0, 0.1, 1],
  ArrowDown: [0, -0.1, 1],
  "+": [0, 0, 0.9],
  "-": [0, 0, 1.1]
};
/** Calls look(turn, lift, zoom) for drags and the wheel on a canvas, click(event) where it was pressed and not dragged. */
function lookAround(canvas, look, click) {
  let held = null;
  canvas.addEventListener("pointerdown", (e) => {
    held = {x: e.clientX, y: e.clientY, moved: false};
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!held) return;
    const dx = e.clientX - held.x, dy = e.clientY - held.y;
    if (!held.moved && Math.hypot(dx, dy) < 4) return;
    held = {x: e.clientX, y: e.clientY, moved: true};
    look(-0.006 * dx, 0.006 * dy, 1);
  });
  canvas.addEventListener("pointerup", (e) => {
    if (held && !held.moved) click(e);
    held = null;
  });
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    look(0, 0, Math.exp(1e-3 * e.deltaY));
  }, {passive: false});
}

/** Places everything at a moment, counted in recorded states, and draws it. */
class DrawnChain {
  constructor(motion) {
    this.motion = motion;
    this.t = unpacked(motion.t, Float64Array);
    for (const axis of ["x", "y", "z"]) this[axis] = restored(motion[axis]).map((metres) => 1e3 * metres);
    this.colours = motion.colours.map((c) => ({name: c.n, unit: c.u, values: restored(c.v), from: c.v.from, to: c.v.to}));
    this.shafts = motion.shafts.map((s) => ({angle: unpacked(s.angle, Float32Array), radius: unpacked(s.radius, Float32Array)}));
    this.moment = 0;
    this.pin = -1;
    this.view = {turn: 0.45, lift: 0.5, distance: 420, x: this.middle(this.x), y: this.middle(this.y)};
    this.canvas = document.getElementById("chain");
    this.build();
  }

  look(turn, lift, zoom) {
    this.view.turn += turn;
    this.view.lift = Math.min(Math.max(this.view.lift + lift, -1.5), 1.5);
    this.view.distance = Math.min(Math.max(this.view.distance * zoom, 60), 2500);
    this.frame();
  }

  build() {
    const THREE = window.THREE;
    this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 2, 10, 5000);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75));
    const lamp = new THREE.DirectionalLight(0xffffff, 0.6);
    lamp.position.set(200, 400, 600);
    this.scene.add(lamp);
    const pins = this.motion.pins, pitch = this.pitch(), width = 1e3 * this.motion.width;
    this.pins = this.solids(new THREE.BoxBufferGeometry(1.6 * width, 2.6 * width, 1e3 * this.motion.length), pins);
    const packs = Math.min(this.motion.plates, 5);
    this.packs = [...Array(packs).keys()].map((k) => (packs > 1 ? 1e3 * this.motion.span * (2 * k / (packs - 1) - 1) : 0));
    this.plates = this.solids(new THREE.BoxBufferGeometry(pitch + 1.2 * width, 3.4 * width, 1.4), pins * packs);
    this.sheaves = [];
    if (this.motion.pulleys)
      for (const shaft of [0, 1])
        for (const side of [-1, 1]) this.sheaves.push(this.sheave(shaft, side));
    this.labels = (this.motion.labels || []).map((text, shaft) => this.label(text, shaft));
  }

  /** A name in the middle of a pulley, in front of everything. */
  label(text, shaft) {
    const THREE = window.THREE, canvas = element("canvas", {width: 256, height: 64}), paint = canvas.getContext("2d");
    paint.fillStyle = "rgba(28, 33, 38, 0.8)";
    paint.fillRect(0, 0, 256, 64);
    paint.fillStyle = "#ffffff";
    paint.font = "bold 40px sans-serif";
    paint.textAlign = "center";
    paint.fillText(text, 128, 46);
    const sprite = new THREE.Sprite(new THREE.SpriteMaterial({map: new THREE.CanvasTexture(canvas), depthTest: false, transparent: true}));
    sprite.position.set(shaft * 1e3 * this.motion.distance, 0, 0);
    sprite.renderOrder = 1;
    this.scene.add(sprite);
    return sprite;
  }

  /** Equal solids with a colour each, which instances of older releases of three do not have. */
  solids(shape, count) {
    const THREE = window.THREE, material = new THREE.MeshLambertMaterial({color: 0xffffff});
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = "attribute vec3 tint;\nvarying vec3 shownTint;\n" +
          shader.vertexShader.replace("#include <begin_vertex>", "#include <begin_vertex>\nshownTint = tint;");
      shader.fragmentShader = "varying vec3 shownTint;\n" +
          shader.fragmentShader.replace("#include <color_fragment>", "#include <color_fragment>\ndiffuseColor.rgb *= shownTint;");
    };
    const mesh = new THREE.InstancedMesh(shape, material, count);
    mesh.tint = new THREE.InstancedBufferAttribute(new Float32Array(3 * count), 3);
    shape.setAttribute("tint", mesh.tint);
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return mesh;
  }

  /** Of where the pins are at the first state. */
  middle(values) {
    const first = values.slice(0, this.motion.pins);
    return 0.5 * (Math.min(...first) + Math.max(...first));
  }
  /** Half of the width of what is drawn. */
  halfWidth() {
    if (this.motion.pulleys) return 500 * this.motion.distance + 1e3 * this.motion.outermost;
    const first = this.x.slice(0, this.motion.pins);
    return 0.55 * (Math.max(...first) - Math.min(...first));
  }
  pitch() {
    const dx = this.x[1] - this.x[0], dy = this.y[1] - this.y[0];
    return Math.hypot(dx, dy);
  }

  /** A cone between the innermost and the outermost radius, with marks that show how it turns. */
  sheave(shaft, side) {
    const THREE = window.THREE, inner = 1e3 * this.motion.innermost * 0.6, outer = 1e3 * this.motion.outermost;
    const lean = Math.tan(this.motion.flank),
          profile = [[inner, lean * inner], [outer, lean * outer], [outer, lean * outer + 5], [inner, lean * inner + 12]];
    const solid = new THREE.LatheBufferGeometry([...profile, profile[0]].map(([r, z]) => new THREE.Vector2(r, z)), 72);
    solid.rotateX(side * Math.PI / 2);
    const mesh = new THREE.Mesh(
        solid,
        new THREE.MeshLambertMaterial({color: 0x9fb0c0, transparent: true, opacity: 0.35, side: THREE.DoubleSide, depthWrite: false}));
    const marks = new THREE.InstancedMesh(
              new THREE.BoxBufferGeometry(outer - inner, 1.2, 1.2), new THREE.MeshLambertMaterial({color: 0x708090}), 6),
          at = new THREE.Matrix4();
    for (let k = 0; k < 6; ++k) {
      const middle = 0.5 * (inner + outer);
      at.makeRotationZ(k * Math.PI / 3);
      at.multiply(new THREE.Matrix4().makeTranslation(middle, 0, side * (lean * middle + 8)));
      marks.setMatrixAt(k, at);
    }
    const both = new THREE.Group();
    both.add(mesh, marks);
    this.scene.add(both);
    return {both, shaft, side};
  }

  /** Between the two states at a moment, that may be a fraction. */
  at(values, pin, moment) {
    const below = Math.min(Math.floor(moment), this.t.length - 1), above = Math.min(below + 1, this.t.length - 1), part = moment - below,
          pins = this.motion.pins;
    return (1 - part) * values[below * pins + pin] + part * values[above * pins + pin];
  }
  of(series, moment) {
    const below = Math.min(Math.floor(moment), series.length - 1), above = Math.min(below + 1, series.length - 1);
    return series[below] + (moment - below) * (series[above] - series[below]);
  }
  time() { return this.of(this.t, this.moment); }
  /** What the chosen colour says of a pin now. */
  value(pin) { return this.at(this.colour.values, pin, this.moment); }

  place() {
    const THREE = window.THREE, pins = this.motion.pins,
          where = this.where || (this.where = [...Array(pins)].map(() => new THREE.Vector3()));
    const matrix = new THREE.Matrix4(), shift = new THREE.Matrix4(), {from, to} = this.colour;
    for (let pin = 0; pin < pins; ++pin)
      where[pin].set(this.at(this.x, pin, this.moment), this.at(this.y, pin, this.moment), this.at(this.z, pin, this.moment));
    for (let pin = 0; pin < pins; ++pin) {
      const here = where[pin], next = where[(pin + 1) % pins], lean = Math.atan2(next.y - here.y, next.x - here.x);
      const share = to > from ? (this.value(pin) - from) / (to - from) : 0.5, [r, g, b] = heat(share);
      matrix.makeRotationZ(lean);
      matrix.setPosition(here.x, here.y, here.z);
      this.pins.setMatrixAt(pin, matrix);
      if (pin === this.pin)
        this.pins.tint.setXYZ(pin, 1, 0.1, 0.1);
      else
        this.pins.tint.setXYZ(pin, r / 255, g / 255, b / 255);
      this.packs.forEach((z, k) => {
        const at = pin * this.packs.length + k;
        this.plates.setMatrixAt(
            at, shift.copy(matrix).setPosition(0.5 * (here.x + next.x), 0.5 * (here.y + next.y), 0.5 * (here.z + next.z) + z));
        this.plates.tint.setXYZ(at, r / 255, g / 255, b / 255);
      });
    }
    for (const mesh of [this.pins, this.plates]) {
      mesh.instanceMatrix.needsUpdate = true;
      mesh.tint.needsUpdate = true;
    }
    for (const {both, shaft, side} of this.sheaves) {
      const radius = 1e3 * this.of(this.shafts[shaft].radius, this.moment);
      both.position.set(shaft * 1e3 * this.motion.distance, 0, side * (500 * this.motion.length - Math.tan(this.motion.flank) * radius));
      both.rotation.z = this.of(this.shafts[shaft].angle, this.moment);
    }
  }

  frame() {
    const {turn, lift, distance, x, y} = this.view;
    this.camera.position.set(
        x + distance * Math.sin(turn) * Math.cos(lift), y + distance * Math.sin(lift), distance * Math.cos(turn) * Math.cos(lift));
    this.camera.lookAt(x, y, 0);
    this.renderer.render(this.scene, this.camera);
  }

  resize() {
    const {clientWidth, clientHeight} = this.canvas;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    const half = Math.tan(Math.PI / 9), wide = 1.15 * this.halfWidth() / (this.view.distance * this.camera.aspect),
          widened = Math.max(half, wide);   // of the picture's height: a narrow canvas shows the whole width as well
    this.camera.fov = 360 / Math.PI * Math.atan(widened);
    for (const label of this.labels) label.scale.set(56 * widened / half, 14 * widened / half, 1);
    this.camera.updateProjectionMatrix();
    this.frame();
  }

  /** Where a pin's middle is on the page [px]. */
  screen(pin) {
    const box = this.canvas.getBoundingClientRect(), at = this.where[pin].clone().project(this.camera);
    return {x: box.left + 0.5 * (1 + at.x) * box.width, y: box.top + 0.5 * (1 - at.y) * box.height, depth: at.z};
  }
}
