// The simulation of the live page, in a separate thread. Messages: open, set, run, until, scene, next;
// answers: opened, frame, fault, scene. A frame is sent once the page has drawn the one before (next): it never has more than one to draw.
'use strict';

const channels = [
    'ratio', 'slip', 'efficiency', 'tight_tension', 'slack_tension', 'shaft_1/torque', 'shaft_2/torque', 'shaft_1/speed', 'shaft_2/speed',
    'shaft_1/angle', 'shaft_2/angle', 'shaft_1/radius', 'shaft_2/radius', 'shaft_1/clamping', 'shaft_2/clamping', 'tips/touching'
];
const slice = 0.02;  // processor time between two frames [s]

let core, call, running = false, awaited = true, until = Infinity, steps = 20, pending = false, pins = 0;
const spent = {
    wall: 0,
    simulated: 0,
    until: 0
};  // over about the last second

/** A call that reports its error as a text. */
function checked(name, kinds, values) {
    const error = core.ccall(name, 'string', kinds, values);
    if (error === '') return true;
    running = false;
    postMessage({fault: error});
    return false;
}

function frame() {
    awaited = false;
    const numbers = {};
    for (const name of channels) numbers[name] = core.ccall('live_channel', 'number', ['string'], [name]);
    const at = call.pins() / 4, columns = core.HEAPF32.slice(at, at + 6 * pins);
    const hash = core.ccall('live_hash', 'string', [], []);
    postMessage(
        {
            frame: {
                time: call.time(),
                running,
                ended: call.time() >= until,
                numbers,
                hash,
                memory: core.HEAPU8.length,
                pace: spent.wall > 0 ? spent.simulated / spent.wall : 0,
                energy: [0, 1, 2].map((which) => call.energy(which)),
                columns
            }
        },
        [columns.buffer]);
}

/** Steps for one slice of processor time, then a frame. */
function advance() {
    pending = false;
    if (!running) return;
    const begin = performance.now(), from = call.time(),
          passed = Math.min((begin - (spent.until || begin)) / 1e3, 1);  // frame and messages
    while (performance.now() - begin < 1e3 * slice && call.time() < until) {
        const before = performance.now();
        if (!checked('live_advance', ['number'], [Math.min(call.time() + steps * call.step(), until)])) return;
        const taken = performance.now() - before;
        steps = Math.min(Math.max(Math.round(steps * 5 / Math.max(taken, 0.5)), 1), 2000);  // calls of about 5 ms
    }
    const fading = Math.exp(-slice);
    spent.until = performance.now();
    spent.wall = spent.wall * fading + (spent.until - begin) / 1e3 + passed;
    spent.simulated = spent.simulated * fading + call.time() - from;
    if (call.time() >= until) running = false;
    if (awaited || !running) frame();
    schedule();
}
const turn = new MessageChannel();  // a timeout would wait for 4 ms
turn.port1.onmessage = advance;
function schedule() {
    if (!running) spent.until = 0;
    if (!running || pending) return;
    pending = true;
    turn.port2.postMessage(null);
}

function open({toml, detail, settings}) {
    running = false;
    if (!checked('live_open', ['string', 'string', 'string'], [toml, detail, settings.join('\n')])) return;
    const number = (key) => Number(core.ccall('live_value', 'string', ['string'], [key]));
    pins = number('chain.pins');
    spent.wall = spent.simulated = spent.until = 0;
    const inputs = [];
    for (let k = 0; k < 7; ++k) inputs.push({key: core.ccall('live_key', 'string', ['number'], [k]), value: call.input(k)});
    postMessage({
        opened: {
            inputs,
            time: call.time(),
            step: call.step(),
            shape: {
                pins,
                width: number('half.width'),
                length: number('half.length'),
                plates: number('plate.count'),
                span: number('plate.span'),
                innermost: number('pulley.innermost'),
                outermost: number('pulley.outermost'),
                flank: number('tip.angle'),
                distance: number('pulley.centre_distance'),
                pulleys: !core.ccall('live_value', 'string', ['string'], ['detail.pulleys']).includes('absent')
            }
        }
    });
    frame();
}

const actions = {
    open,
    set: ({number, value}) => {
        if (checked('live_set', ['number', 'number'], [number, value]) && !running) frame();
    },
    run: (on) => {
        running = on;
        schedule();
    },
    next: () => { awaited = true; },
    until: (time) => { until = time === null ? Infinity : time; },
    scene: () => postMessage({scene: core.ccall('live_scene', 'string', [], [])}),
};
const early = [];
onmessage = ({data}) => core ? Object.entries(data).forEach(([name, what]) => actions[name](what)) : early.push(data);

makeCvtflow()
    .then((made) => {
        const pick = (name, count) => made.cwrap(name, 'number', Array(count).fill('number'));
        call = {
            time: pick('live_time', 0),
            step: pick('live_step', 0),
            input: pick('live_input', 1),
            pins: pick('live_pins', 0),
            energy: pick('live_energy', 1)
        };
        core = made;
        early.forEach((data) => onmessage({data}));
    })
    .catch((error) => postMessage({fault: String(error)}));
