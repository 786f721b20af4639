"""The running variator for ParaView and VTK: pin halves, plates and sheaves as a mesh that moves, with the recorded forces on them.

A .pvd lists the times and their files, FILE/FILE_000000.vtu ...: not VTKHDF, whose time series are newer than the readers of distributions. Arrays
of cells: part (0 pin halves, 1 plates, 2 sheaves), number, axial_force, bending_moment, tension, joint_force; of points: tip_force. A force that was not
recorded is NaN.
"""

import numpy as np

from ._motion import machine_state

_ALONG = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])  # ξ of the points of a half
_SECTORS = 72  # of a sheave
_LEGENDRE = np.array([np.ones(5), _ALONG, 1.5 * _ALONG**2 - 0.5, 2.5 * _ALONG**3 - 1.5 * _ALONG])  # [order, points]
_LINE, _POLYLINE, _QUAD = 3, 4, 9  # types of cells


def _document(kind, inside):
    return (f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n{inside}</VTKFile>\n')


def collection(rows):
    """The text of a .pvd. rows: (time [s], path of a file, as XML)"""
    sets = "".join(f'<DataSet timestep="{time!r}" file="{file}"/>\n' for time, file in rows)
    return _document("Collection", f"<Collection>\n{sets}</Collection>\n")


class Solids:
    """The mesh of a record's machine, and its points and forces at each state."""

    def __init__(self, record):
        self.record, self.scene, self._kept = record, (scene := record.scene), {}
        self.pins, self.rigid = scene["chain.pins"], scene["detail.pins"] == "rigid"
        self.pulleys = {"elastic": 36, "rigid": 4, "absent": 0}[scene["detail.pulleys"]]
        self.size = 16 if self.rigid else 40  # unknowns of a link or of a rigid pin
        spread = np.linspace(-1.0, 1.0, scene["plate.count"]) if scene["plate.count"] > 1 else np.zeros(1)
        if scene["detail.plates"] == "lumped":
            spread = np.array([-1.0, 1.0]) * np.sqrt(np.mean(spread**2))
        self.positions, self.plates = 2.0 * scene["plate.span"] / scene["half.length"] * spread, len(spread)
        lines = np.arange(10 * self.pins + 2 * self.plates * self.pins)
        sheaves = np.arange(4 * _SECTORS).reshape(4, _SECTORS) if self.pulleys else np.empty((0, _SECTORS), dtype=int)
        first, following = lines.size + 2 * sheaves, lines.size + 2 * np.roll(sheaves, -1, axis=1)
        quads = np.stack([first, first + 1, following + 1, following], axis=-1)
        counts = [2 * self.pins, self.plates * self.pins, quads.size // 4]
        self.connectivity = np.concatenate([lines, quads.ravel()])
        self.offsets = np.cumsum(np.repeat([5, 2, 4], counts))
        self.types = np.repeat([_POLYLINE, _LINE, _QUAD], counts).astype("u1")
        self.part = np.repeat([0, 1, 2], counts)
        self.number = np.concatenate([np.arange(counts[0]), np.arange(counts[1]), np.repeat(np.arange(len(sheaves)), _SECTORS)])

    def _channel(self, name, row, width):
        """Numbers of a channel at a row; NaN where it was not recorded."""
        return self.record.read(name, row, 1)[0] if name in self.record.info else np.full(width, np.nan)

    def _halves(self, q):
        """[halves, 3, 5] points of the axes of halves 2 link + (front half)."""
        bodies, terms, half = (1, 3, 0.5 * self.scene["half.length"]) if self.rigid else (2, 4, 0.5 * self.scene["half.length"])
        lateral, ends = q[:, :2 * bodies * terms].reshape(-1, 2, bodies, terms), q[:, 2 * bodies * terms:].reshape(-1, bodies, 2)
        if self.rigid:  # the rear half on its own pin, the front half on the next one; ζ apart
            step = np.roll(lateral[:, :, 0, 0], -1, axis=0) - lateral[:, :, 0, 0]
            step = step / np.hypot(*step.T)[:, None]
            along, radius = step + np.roll(step, 1, axis=0), self.scene["joint.radius"]
            reach = (radius / np.hypot(*along.T) - 0.5 * (radius - 0.5 * self.scene["half.width"]))[:, None] * along  # halves roll on each other
            rear, front = lateral.copy(), lateral.copy()
            rear[:, :, 0, 0] -= reach
            front[:, :, 0, 0] += reach
            lateral = np.concatenate([rear, np.roll(front, -1, axis=0)], axis=2)
            z, apart = ends[:, 0, 0], 0.5 * ends[:, 0, 1]
            ends = np.stack([np.stack([z - apart, np.roll(z + apart, -1)], axis=1), np.zeros((self.pins, 2))], axis=2)
        xy = np.einsum("pabm,mk->pbak", lateral, _LEGENDRE[:terms])
        z = ends[:, :, :1] + _ALONG * (half + ends[:, :, 1:])
        return np.concatenate([xy, z[:, :, None]], axis=2).reshape(-1, 3, 5)

    def _plates(self, halves):
        """[plates, 3, 2] ends of every plate."""
        ends = [np.stack([_at(half, position) for half in (halves[::2], halves[1::2])], axis=-1) for position in self.positions]
        return np.stack(ends, axis=1).reshape(-1, 3, 2)

    def _sheaves(self, pulleys, row):
        """[sheaves, sectors, 2, 3] points at the innermost and the outermost radius."""
        scene, made = self.scene, np.empty((4, _SECTORS, 2, 3))
        for number in range(4):
            shaft, side = divmod(number, 2)
            x = y = tilt_x = tilt_y = 0.0
            if self.pulleys == 36:
                x, y, tilt_x, tilt_y, moved = pulleys[6 * (2 + number):6 * (2 + number) + 5]
            else:
                moved = pulleys[2 + shaft] if side != shaft else 0.0  # movable: 1+ and 2-
            outward = -1.0 if side == 0 else 1.0
            plane = outward * 0.5 * scene["half.length"] + shaft * scene["imperfection.misalignment"] + moved
            angle = self._channel(f"shaft_{shaft + 1}/angle", row, 1) + 2.0 * np.pi * np.arange(_SECTORS) / _SECTORS
            for end, radius in enumerate((scene["pulley.innermost"], scene["pulley.outermost"])):
                u, v = radius * np.cos(angle), radius * np.sin(angle)
                w = outward * (radius - scene["pulley.arc_position"]) * np.tan(scene["tip.angle"])
                made[number, :, end] = np.stack([shaft * scene["pulley.centre_distance"] + x + u + tilt_y * w, y + v - tilt_x * w,
                                                 plane + w + tilt_x * v - tilt_y * u], axis=-1)
        return made

    def _tips(self, row, halves):
        """[halves, 5, 3] forces of tips on their sheaves, at the ends of their halves."""
        width, made = 4 * self.pins, np.zeros((2 * self.pins, 5, 3))
        axial, radial, tangential = (self._channel(f"tips/{name}_force", row, width) for name in ("axial", "radial", "tangential"))
        for end in (0, 4):
            own = [each.reshape(-1, 2)[:, end // 4] for each in (axial, radial, tangential)]
            x, y = halves[:, 0, end], halves[:, 1, end]
            x = x - self.scene["pulley.centre_distance"] * (x > 0.5 * self.scene["pulley.centre_distance"])
            radius = np.hypot(x, y)
            made[:, end] = np.stack([(own[1] * x - own[2] * y) / radius, (own[1] * y + own[2] * x) / radius, own[0]], axis=-1)
        return made

    def file(self, number):
        """Bytes of the .vtu of a state. Raises ValueError where it is not finite or does not match its machine."""
        record = self.record
        state, _ = machine_state(record, number, self.pins, self.size * self.pins + 2 * self.pulleys)
        if not np.isfinite(state).all():
            raise ValueError(f"{record.path}: state {number} is not finite")
        row = min(np.searchsorted(record["time"], record.states.time[number] - 1e-12), record.rows - 1)
        halves = self._halves(state[:self.size * self.pins].reshape(self.pins, 2, -1)[:, 0])
        plates = self._plates(halves)
        points = [halves.transpose(0, 2, 1).reshape(-1, 3), plates.transpose(0, 2, 1).reshape(-1, 3)]
        if self.pulleys:
            points.append(self._sheaves(state[self.size * self.pins:], row).reshape(-1, 3))
        forces = np.zeros((len(self.offsets), 4), dtype="<f4")  # axial force, bending moment, tension, joint force
        width = 2 * self.pins
        forces[:width, 0] = self._channel("halves/axial_force", row, width)
        forces[:width, 1] = np.hypot(*(self._channel(f"halves/bending_moment_{name}", row, width) for name in ("travel", "height")))
        joints = self._channel("joints/normal_force", row, self.pins)
        forces[:width, 3] = np.stack([joints, np.roll(joints, -1)], axis=1).ravel()
        tension = np.repeat(self._channel("links/tension", row, self.pins) / self.plates, self.plates)
        if "plates/tension" in record.info:
            tension = record.read("plates/tension", row, 1)[0]
        forces[width:width + len(tension), 2] = tension
        if self.pulleys:
            forces[-4 * _SECTORS:, 0] = np.repeat(self._channel("sheaves/axial_force", row, 4), _SECTORS)
        points = np.concatenate(points)
        tips = np.zeros((len(points), 3), dtype="<f4")
        if self.pulleys:
            tips[:5 * width] = self._tips(row, halves).reshape(-1, 3)
        return self._document(points, tips, forces)

    def _document(self, points, tips, forces):
        blocks, size = [], 0

        def array(name, values, kind, components=1):
            nonlocal size
            data = np.ascontiguousarray(values).astype(kind).tobytes()
            named = {"<i8": "Int64", "u1": "UInt8", "<i4": "Int32", "<f4": "Float32"}[kind]
            line = f'<DataArray type="{named}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{size}"/>\n'
            blocks.append(len(data).to_bytes(8, "little") + data)
            size += 8 + len(data)
            return line

        names = ("axial_force", "bending_moment", "tension", "joint_force")
        parts = {"Points": array("Points", points, "<f4", 3),
                 "Cells": array("connectivity", self.connectivity, "<i8") + array("offsets", self.offsets, "<i8") + array("types", self.types, "u1"),
                 "PointData": array("tip_force", tips, "<f4", 3),
                 "CellData": array("part", self.part, "<i4") + array("number", self.number, "<i4")
                 + "".join(array(name, forces[:, k], "<f4") for k, name in enumerate(names))}
        inside = "".join(f"<{name}>\n{lines}</{name}>\n" for name, lines in parts.items())
        text = _document("UnstructuredGrid", f'<UnstructuredGrid>\n<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(self.offsets)}">\n{inside}'
                                             '</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_@\n</AppendedData>\n')
        head, _, tail = text.partition("@")
        return head.encode() + b"".join(blocks) + tail.encode()


def _at(halves, position):
    """[halves, 3] the points of axes at ξ: between points by their cubic."""
    weights = np.array([np.prod([(position - other) / (own - other) for other in _ALONG if other != own]) for own in _ALONG])
    return halves @ weights
