"""The running chain of a page: where pins are at the recorded states, and what they carry."""

import numpy as np

from ._channels import shown, unit_of
from ._figures import Line, Panel, colour, draw
from ._numbers import mean
from ._page import packed, quantised

_BINS = 120  # of a round about a shaft
_TIPS = 4  # of a link: rear half -z, +z, front half -z, +z


class Motion:
    """[states, pins] each: x, y, z of the middles of the pins' rear halves [m]; pin_force: axial force of a pin on its sheaves, mean of
    both sides [N]; tension: of the link behind the pin [N]; slip: 1 - Ω/ω of a pin that touches sheaves, Ω about their axis, 0 elsewhere;
    side: 0 free, 1, 2 between the sheaves of that shaft. pin_force and tension are None where they were not recorded."""

    def __init__(self, record, most):
        scene, all_times = record.scene, record.states.time
        self.recorded, self.pins = len(all_times), int(scene["chain.pins"])
        self.rigid, self.order = scene["detail.pins"] == "rigid", 2 if scene["detail.pins"] == "rigid" else 3
        self.has_pulleys = scene["detail.pulleys"] != "absent"
        self.distance = float(scene["pulley.centre_distance"])
        count = min(self.recorded, most)
        chosen, kept = [k * self.recorded // count for k in range(count)], []
        states, phases = [], []
        for number in chosen:
            state, phase = machine_state(record, number, self.pins, self.pins * self._block())
            if np.isfinite(state).all() and np.isfinite(all_times[number]):  # a run that diverged has no chain to show
                kept.append(number)
                states.append(state[:self.pins * self._block()])
                phases.append(phase)
        self.times = all_times[kept]
        if kept:
            self._place(record, np.array(states), np.array(phases))

    def _block(self):
        """Unknowns of a link or a rigid pin: coordinates, then velocities."""
        return 2 * (1 if self.rigid else 2) * (2 * (self.order + 1) + 2)

    def _place(self, record, states, phases):
        bodies, lateral = 1 if self.rigid else 2, self.order + 1
        blocks = states.reshape(len(states), self.pins, 2, -1)
        self.x, self.y, self.z = (blocks[:, :, 0, at] for at in (0, bodies * lateral, 2 * bodies * lateral))
        speed = blocks[:, :, 1, 0], blocks[:, :, 1, bodies * lateral]
        rows = np.minimum(np.searchsorted(record["time"], self.times - 1e-12), record.rows - 1)
        turning = [self._rows(record, f"shaft_{shaft}/speed", rows) for shaft in (1, 2)]
        self.angle = [self._rows(record, f"shaft_{shaft}/angle", rows) for shaft in (1, 2)]
        touches = (_by_pin(phases.reshape(len(states), self.pins, _TIPS)) != 0).any(axis=2)
        shaft = np.where(self.x > 0.5 * self.distance, 1, 0)
        dx = self.x - np.where(shaft == 1, self.distance, 0.0)
        squared = np.maximum(dx**2 + self.y**2, 1e-30)
        omega = np.where(shaft == 1, turning[1][:, None], turning[0][:, None])
        about = (dx * speed[1] - self.y * speed[0]) / squared
        self.slip = np.where(touches & (omega != 0.0), 1.0 - about / np.where(omega == 0.0, 1.0, omega), 0.0)
        self.side = np.where(touches, shaft + 1, 0)
        on = [touches & (shaft == k) for k in (0, 1)]
        self.radius = [(np.sqrt(squared) * each).sum(axis=1) / np.maximum(1, each.sum(axis=1)) for each in on]
        forces = self._wide(record, "tips/", _TIPS * self.pins, rows)
        self.tension = self._wide(record, "links/", self.pins, rows)
        self.pin_force = None
        if forces is not None:
            of_pin = _by_pin(forces.reshape(len(states), self.pins, _TIPS))
            self.pin_force = 0.5 * (abs(of_pin[:, :, 0] + of_pin[:, :, 2]) + abs(of_pin[:, :, 1] + of_pin[:, :, 3]))  # signs are of sides

    @staticmethod
    def _rows(record, name, rows):
        return record[name][rows] if name in record.info else np.zeros(len(rows))

    @staticmethod
    def _wide(record, group, width, rows):
        """Rows of the channel of forces of that width; None if there is none."""
        name = next((name for name, column in record.info.items()
                     if column.unit == "N" and column.width == width and name.startswith(group)), "")
        return np.array([record.read(name, row, 1)[0] for row in rows]) if name else None


def machine_state(record, number, pins, size):
    """Unknowns and phases of a state, which are compared with the machine. size: number of unknowns at least. Raises ValueError."""
    try:
        state, phase = record.states[number], record._file["states/phases"][number]
        if len(phase) == _TIPS * pins and len(state) >= size and phase.max(initial=0) <= 3:
            return state, phase
    except (KeyError, IndexError, ValueError):  # arrays that are absent or shorter
        pass
    raise ValueError(f"{record.path}: state {number} does not match its machine")


def _by_pin(tips):
    """[states, pins, 4] of links as those of pins: a pin's rear half is on its own link, its front half on the link before."""
    return np.concatenate([tips[:, :, :2], np.roll(tips, 1, axis=1)[:, :, 2:]], axis=2)


def data(record, motion, si):
    """For chain.js. Labels of the shafts are by the power that flows into them."""
    scene = record.scene
    made = {"recorded": motion.recorded, "t": packed(motion.times, "<f8"), "pins": motion.pins, "pulleys": motion.has_pulleys,
            "x": quantised(motion.x), "y": quantised(motion.y), "z": quantised(motion.z), "flank": scene["tip.angle"],
            "length": scene["half.length"], "width": scene["half.width"], "span": scene["plate.span"], "plates": scene["plate.count"],
            "distance": motion.distance, "innermost": scene["pulley.innermost"], "outermost": scene["pulley.outermost"], "colours": []}
    for name, unit, values in (("pin force", "N", motion.pin_force), ("tension", "N", motion.tension),
                               ("slip", "1", motion.slip if motion.has_pulleys else None)):
        if values is not None:
            label, factor = shown(name, unit, si)
            made["colours"].append({"n": name, "u": unit_of(label), "v": quantised(factor * values)})
    first = not power_into(record, 1) < power_into(record, 2)
    made["labels"] = ["drive", "driven"] if first else ["driven", "drive"]
    made["shafts"] = [{"angle": packed(angle, "<f4"), "radius": packed(radius, "<f4")}
                      for angle, radius in zip(motion.angle, motion.radius)]
    return made


def power_into(record, shaft):
    """Mean power that flows into a shaft from outside [W]; NaN if the record does not contain it."""
    names = f"shaft_{shaft}/torque", f"shaft_{shaft}/speed"
    return mean(record[names[0]] * record[names[1]]) if all(name in record.info for name in names) else np.nan


def pin_forces(motions, labels, heading, si=False):
    """Axial force of the pins over the angle about the shaft: mean over all states, with minimum and maximum. The figure."""
    label, factor = shown("pin force", "N", si)
    unit = unit_of(label)
    panel = Panel("Axial force of the pins round the pulleys",
                  "angle about the shaft in its sense of turning, 0: away from the other shaft [°]",
                  f"force of both halves on each sheave [{unit}]", x_ends=(-130.0, 130.0))
    for number, (motion, of) in enumerate(zip(motions, labels)):
        for shaft, name in ((1, "driving sheaves"), (2, "driven sheaves")):
            angle, (low, middle, high) = _round(motion, shaft)
            tint = colour(2 * number + shaft - 1)
            panel.lines.append(Line(f"{name}, {of}" if of else name, angle, factor * middle, {"color": tint, "linewidth": 2.2}))
            for edge in (low, high) if len(motions) == 1 else ():
                panel.lines.append(Line("", angle, factor * edge, {"color": tint, "linewidth": 0.7}))
    return draw([panel], heading + (", mean over all states" + ("; thin: minimum and maximum" if len(motions) == 1 else "")))


def _round(motion, shaft):
    """Angles [°], and minimum, mean and maximum of the forces at them; NaN where no pin was."""
    touching = (motion.side == shaft) & np.isfinite(motion.pin_force)
    away, up = (motion.x - motion.distance, motion.y) if shaft == 2 else (-motion.x, -motion.y)
    bins = np.clip(((np.arctan2(up, away)[touching] / np.pi + 1.0) * 0.5 * _BINS).astype(int), 0, _BINS - 1)
    forces, count = motion.pin_force[touching], np.bincount(bins, minlength=_BINS)
    low, high = np.full(_BINS, np.inf), np.full(_BINS, -np.inf)
    np.minimum.at(low, bins, forces)
    np.maximum.at(high, bins, forces)
    with np.errstate(invalid="ignore"):
        middle = np.bincount(bins, forces, minlength=_BINS) / count
    empty = count == 0
    return -180.0 + 360.0 * (np.arange(_BINS) + 0.5) / _BINS, [np.where(empty, np.nan, each) for each in (low, middle, high)]
