// The live page: settings, the running chain, strips. The simulation is in worker.js.
'use strict';

const $ = (id) => document.getElementById(id);
const heatStops = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];
/** From dark blue (0) over green to yellow (1). */
function heat(share) {
    const at = Math.min(Math.max(share, 0), 1) * 5, below = Math.min(Math.floor(at), 4), part = at - below;
    return heatStops[below].map((value, k) => (1 - part) * value + part * heatStops[below + 1][k]);
}
/** Numbers from base64, which reports contain and this page does not. */
function unpacked(numbers) { return numbers; }

/** Column of the worker's frames, name, unit; lowest value of the scale, if it is fixed. */
const colourings = [
    {column: 3, name: 'tip force', unit: 'kN', factor: 1e-3, from: 0},
    {column: 4, name: 'tension of a link', unit: 'kN', factor: 1e-3, from: 0}, {column: 5, name: 'slip of a pin', unit: '%', factor: 100}
];

/** The chain at the last frame. */
class LiveChain extends DrawnChain {
    constructor(shape, columns) {
        const none = {from: 0, to: 0, v: new Uint16Array(shape.pins)}, still = {angle: [0], radius: [0.05]};
        super({...shape, t: [0], x: none, y: none, z: none, colours: [], shafts: [still, still]});
    }
    static of(shape, columns) {
        LiveChain.first = columns;
        return new LiveChain(shape);
    }
    build() {
        this.take(LiveChain.first);
        this.view = {turn: 0.35, lift: 0.35, distance: 430, x: this.middle(this.x), y: this.middle(this.y)};
        super.build();
    }
    take(columns) {
        const pins = this.motion.pins, column = (k, factor) => columns.slice(k * pins, (k + 1) * pins).map((value) => factor * value);
        [this.x, this.y, this.z] = [0, 1, 2].map((k) => column(k, 1e3));
        const {column: number, factor, from, name, unit} = colourings[Number($('colouring').value)], values = column(number, factor);
        const low = from === undefined ? Math.min(...values) : from, high = Math.max(...values);
        const before = this.colour && this.colour.name === name ? this.colour : {from: low, to: high};
        // The scale grows at once and shrinks slowly, so that colours neither saturate nor flicker.
        this.colour = {
            name,
            unit,
            values,
            from: Math.min(low, before.from + 0.03 * (low - before.from)),
            to: Math.max(high, before.to + 0.03 * (high - before.to))
        };
    }
    update({columns, numbers}) {
        this.take(columns);
        for (const k of [0, 1])
            this.shafts[k] = {angle: [numbers[`shaft_${k + 1}/angle`] || 0], radius: [numbers[`shaft_${k + 1}/radius`] || 0.05]};
        this.place();
        this.frame();
        $('low').textContent = readable(this.colour.from, 2);
        $('high').textContent = `${readable(this.colour.to, 3)} ${this.colour.unit}`;
    }
}

/** Three digits, as a person reads them. */
function readable(value, digits = 3) {
    if (!Number.isFinite(value)) return '–';
    const size = Math.abs(value);
    return size !== 0 && (size >= 1e6 || size < 1e-4) ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
}

/** A curve or two over the last frames, drawn on a canvas. */
class Strip {
    constructor(title, unit, curves) {
        Object.assign(this, {title, unit, curves, rows: []});
        this.figure = document.createElement('figure');
        this.caption = document.createElement('figcaption');
        this.canvas = document.createElement('canvas');
        this.canvas.setAttribute('role', 'img');
        this.figure.append(this.caption, this.canvas);
        $('strips').append(this.figure);
    }
    clear() { this.rows = []; }
    add(time, numbers) {
        if (time >= 0 && this.rows.length > 0 && this.rows[0][0] < 0) this.clear();  // settling is over
        this.rows.push([time, ...this.curves.map((curve) => curve.value(numbers))]);
        if (this.rows.length > 600) this.rows.shift();
    }
    draw() {
        const last = this.rows[this.rows.length - 1] || [0], values = this.rows.flatMap((row) => row.slice(1)).filter(Number.isFinite);
        this.caption.replaceChildren(`${this.title} `);
        this.curves.forEach((curve, k) => {
            const value = document.createElement('span');
            value.textContent = `${curve.name} ${readable(last[k + 1], 4)}`.trim();
            value.style.color = `var(--curve-${k})`;
            this.caption.append(value, k + 1 < this.curves.length ? ', ' : ` ${this.unit}`);
        });
        this.canvas.setAttribute('aria-label', this.caption.textContent);
        const width = this.canvas.width = this.canvas.clientWidth * devicePixelRatio,
              height = this.canvas.height = this.canvas.clientHeight * devicePixelRatio;
        if (values.length < 2) return;
        const paint = this.canvas.getContext('2d'), style = getComputedStyle(document.documentElement);
        let low = Math.min(...values), high = Math.max(...values);
        const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1e-9);
        if (high - low < least) [low, high] = [low - least, high + least];
        const from = this.rows[0][0], span = last[0] - from || 1, top = 16 * devicePixelRatio, deep = height - 2 * top;
        paint.font = `${11 * devicePixelRatio}px sans-serif`;
        paint.fillStyle = style.getPropertyValue('--soft');
        paint.fillText(readable(high, 4), 3, top - 4);
        paint.fillText(readable(low, 4), 3, height - 4);
        paint.textAlign = 'right';
        paint.fillText(`${readable(1e3 * from, 3)} … ${readable(1e3 * last[0], 3)} ms`, width - 3, height - 4);
        paint.lineWidth = 1.5 * devicePixelRatio;
        this.curves.forEach((curve, k) => {
            paint.strokeStyle = style.getPropertyValue(`--curve-${k}`);
            paint.beginPath();
            for (const row of this.rows)
                if (Number.isFinite(row[k + 1]))
                    paint.lineTo((row[0] - from) / span * width, top + (high - row[k + 1]) / (high - low) * deep);
            paint.stroke();
        });
    }
}
const number = (name, factor = 1) => ({numbers}) => factor * numbers[name];
const strips = [
    new Strip('Ratio', '', [{name: '', value: number('ratio')}]),
    new Strip('Slip', '%', [{name: '', value: number('slip', 100)}]),
    new Strip('Efficiency', '%', [{name: '', value: number('efficiency', 100)}]),
    new Strip(
        'Tension', 'kN', [{name: 'tight', value: number('tight_tension', 1e-3)}, {name: 'slack', value: number('slack_tension', 1e-3)}]),
    new Strip(
        'Speed', 'rpm',
        [{name: 'driving', value: number('shaft_1/speed', 30 / Math.PI)}, {name: 'driven', value: number('shaft_2/speed', 30 / Math.PI)}]),
];

// Settings: the link of the page contains them ---------------------------------------------------------------------------------------

const scenes = JSON.parse($('scenes').textContent);
/** Label, unit and factor of an input by its key. */
const labels = {
    'clamping.driving': ['clamping force, driving', 'kN', 1e-3],
    'clamping.driven': ['clamping force, driven', 'kN', 1e-3],
    'load.torque': ['load torque', 'N·m', 1],
    'drive.torque': ['drive torque', 'N·m', 1],
    'drive.speed': ['drive speed', 'rpm', 30 / Math.PI],
    'control.ratio': ['ratio target', '', 1],
    'load.speed': ['load speed', 'rpm', 30 / Math.PI]
};
const settings = {
    scene: 'baseline',
    detail: 'rigid',
    until: null,
    keys: {}
};
const ranges = {};  // of the sliders of this scene

function readLink() {
    for (const [key, value] of new URLSearchParams(location.hash.slice(1))) {
        if (key === 'scene' && scenes[value])
            settings.scene = value;
        else if (key === 'detail' && [...$('detail').options].some((option) => option.value === value))
            settings.detail = value;
        else if (key === 'until' && Number.isFinite(Number(value)))
            settings.until = Number(value);
        else if (key.includes('.'))
            settings.keys[key] = value;  // the simulation checks it
    }
}
function writeLink() {
    const link = new URLSearchParams({scene: settings.scene, detail: settings.detail, ...settings.keys});
    if (settings.until !== null) link.set('until', settings.until);
    history.replaceState(null, '', '#' + link);
}

// The worker -------------------------------------------------------------------------------------------------------------------------

const worker = new Worker(URL.createObjectURL(new Blob([$('worker').textContent], {type: 'text/javascript'})));
let chain = null, shape = null, latest = null, running = true;
window.live = {
    frames: 0,
    frame: null,
    firstPicture: null,
    settings
};  // what tests read

function restart() {
    $('fault').textContent = '';
    shape = null;
    for (const strip of strips) strip.clear();
    worker.postMessage({
        until: settings.until,
        open: {
            toml: scenes[settings.scene].toml,
            detail: settings.detail,
            settings: Object.entries(settings.keys).map(([key, value]) => `${key}=${value}`)
        }
    });
    writeLink();
    $('about').textContent = scenes[settings.scene].description.replace(/N\*m/g, 'N·m');
}

/** A slider per input that the scene has, up to twice the scene's value. */
function showInputs(inputs) {
    $('inputs').replaceChildren();
    inputs.forEach(({key, value}, number) => {
        if (!labels[key] || !Number.isFinite(value) || (key === 'control.ratio' && value === 0)) return;
        const [name, unit, factor] = labels[key];
        const reach = ranges[key] = ranges[key] || Math.max(Math.abs(value), key.endsWith('torque') ? 100 : 1e-3);
        const slider = document.createElement('input'), shown = document.createElement('output'), label = document.createElement('label');
        const signed = key.endsWith('torque');
        Object.assign(slider, {type: 'range', min: signed ? -2 * reach : 0.3 * reach, max: 2 * reach, step: 'any', id: 'input-' + key});
        slider.value = value;
        const show = () => { shown.textContent = `${readable(factor * Number(slider.value), 4)} ${unit}`; };
        slider.addEventListener('input', () => {
            show();
            settings.keys[key] = Number(Number(slider.value).toPrecision(6));
            worker.postMessage({set: {number, value: settings.keys[key]}});
            writeLink();
        });
        show();
        label.append(name[0].toUpperCase() + name.slice(1), slider, shown);
        $('inputs').append(label);
    });
}

const answers = {
    opened: ({inputs, shape: opened}) => {
        showInputs(inputs);
        shape = opened;
        latest = null;  // of the scene before
        if (chain) chain.renderer.dispose();
        chain = null;
        play(running);
    },
    fault: (text) => {
        $('fault').textContent = text;
        play(false);
    },
    scene: (text) => {
        const link = document.createElement('a');
        link.href = URL.createObjectURL(new Blob([text], {type: 'application/toml'}));
        link.download = settings.scene + '.toml';
        window.live.toml = text;
        link.click();
    },
    frame: (frame) => {
        const waits = latest !== null;
        latest = frame;
        if (!waits) requestAnimationFrame(show);
    },
};
worker.onmessage = ({data}) => Object.entries(data).forEach(([name, what]) => answers[name](what));


/** Draws the latest frame, and asks for the next one. */
function show() {
    const frame = latest;
    latest = null;
    worker.postMessage({next: true});
    if (!shape || !frame) return;
    if (!chain) chain = drawn(frame.columns);
    if (chain) chain.update(frame);
    for (const strip of strips) strip.add(frame.time, frame);
    if (window.live.frames++ % 3 === 0 || !frame.running) strips.forEach((strip) => strip.draw());
    if (window.live.firstPicture === null) window.live.firstPicture = performance.now() / 1e3;  // since the page was opened [s]
    window.live.frame = frame;
    showFrame(frame);
}
function drawn(columns) {
    try {
        const made = LiveChain.of(shape, columns);
        made.resize();
        return made;
    } catch (error) {
        if (!/WebGL/.test(String(error))) throw error;
        $('fault').textContent = 'This browser has no WebGL; the chain cannot be shown.';
        return null;
    }
}

function showFrame({time, pace, energy, hash, ended}) {
    $('time').textContent = `${readable(1e3 * time, 5)} ms${time < 0 ? ', settling' : ''}`;
    $('pace').textContent =
        pace > 0 ? (pace >= 1 ? `${readable(pace, 2)} times real time` : `1/${readable(1 / pace, 2)} of real time`) : '–';
    const [residual, dissipated, doubt] = energy;
    $('energy').textContent =
        `${doubt <= 1 ? 'closes' : 'does not close'}: residual ${readable(residual, 2)} J of ${readable(dissipated, 3)} J dissipated`;
    $('energy').className = doubt <= 1 ? 'good' : 'bad';
    $('hash').textContent = hash;
    if (ended && running) play(false);
}

function play(on) {
    running = on;
    $('play').textContent = on ? 'Pause' : 'Run';
    worker.postMessage({run: on});
}

/** A bar of the colours. */
function paintScale() {
    const stops = heatStops.map((stop) => `rgb(${stop})`);
    $('bar').style.background = `linear-gradient(90deg, ${stops})`;
}

function begin() {
    paintScale();
    for (const name of Object.keys(scenes)) $('scene').append(new Option(name, name));
    readLink();
    $('scene').value = settings.scene;
    $('detail').value = settings.detail;
    colourings.forEach(({name, unit}, k) => $('colouring').append(new Option(`${name} [${unit}]`, k)));
    for (const id of ['scene', 'detail'])
        $(id).addEventListener('change', () => {
            settings[id] = $(id).value;
            if (id === 'scene') {
                settings.keys = {};
                for (const key of Object.keys(ranges)) delete ranges[key];
            }
            restart();
        });
    $('play').addEventListener('click', () => play(!running));
    $('restart').addEventListener('click', () => {
        running = true;
        restart();
    });
    $('download').addEventListener('click', () => worker.postMessage({scene: null}));
    window.addEventListener('hashchange', () => location.reload());  // another link in the same tab
    window.addEventListener('resize', () => {
        if (chain) chain.resize();
        strips.forEach((strip) => strip.draw());
    });
    const canvas = $('chain');
    const look = (...by) => {
        if (chain) chain.look(...by);
    };
    lookAround(canvas, look, () => {});
    canvas.addEventListener('keydown', (event) => {
        if (!keyTurns[event.key]) return;
        look(...keyTurns[event.key]);
        event.preventDefault();
    });
    restart();
}
begin();
