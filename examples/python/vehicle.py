"""A vehicle behind the variator: one inertia that a torsional spring and damper couples to shaft 2.

    vehicle.py [MILLISECONDS] [--fmu FILE]

The driver tips in (the drive's torque rises), then a ramp begins (the road's slope rises). The vehicle is solved here, by SciPy if it is
there, and exchanges with the variator every millisecond: it gives the speed of the coupling's far end and takes the torque's impulse.
With --fmu the variator is an FMU in FMPy instead; vehicle.py --scene vehicle.toml writes its scene and prints how to make it.
The script prints the balance of energy of everything: engine, variator, coupling, vehicle and road.
"""

import argparse

import cvtflow

try:
    from scipy.integrate import solve_ivp
except ImportError:
    solve_ivp = None

STEP = 1e-3  # [s] between two exchanges
MASS, WHEEL, FINAL_DRIVE, GRAVITY = 1400.0, 0.3, 5.0, 9.81  # [kg], [m], speed of shaft 2 over the wheels', [m/s2]
INERTIA = MASS * (WHEEL / FINAL_DRIVE) ** 2  # of the vehicle at shaft 2 [kg m2]
SETTINGS = {
    "drive": {"mode": "torque", "torque": "152.4 N*m", "inertia": 0.1},
    "load": {"mode": "coupling", "torque": "150 N*m", "speed": "208.9 rad/s", "coupling_stiffness": 800.0, "coupling_damping": 1.0},
    "control": {"enabled": False},
    "clamping": {"driving": "27.1 kN", "driven": "20 kN"},
}
OUTPUTS = ["shaft_1/impulse", "shaft_2/impulse", "shaft_2/speed", "work/drive", "work/load", "work/clamping", "dissipated/total",
           "shaft_2/coupling_work", "shaft_2/coupling_energy", "shaft_2/coupling_dissipated", "energy/kinetic", "energy/inner", "energy/pack",
           "energy/plates", "energy/joints", "energy/tips", "energy/supports"]


def drive_torque(time):
    """Tip-in from 152 to 170 N m within 5 ms [N m]."""
    return 152.4 + 17.6 * min(1.0, max(0.0, (time - 10e-3) / 5e-3))


def road_torque(time, speed):
    """Level road at 150 N m, air that resists with the speed squared, and a slope of 3 % that begins within 20 ms [N m at shaft 2]."""
    slope = 0.03 * min(1.0, max(0.0, (time - 30e-3) / 20e-3))
    return 130.0 + 20.0 * (speed / 208.9) ** 2 + MASS * GRAVITY * slope * WHEEL / FINAL_DRIVE


class Vehicle:
    """Speed of the far end of the coupling, and where its energy goes."""

    def __init__(self, speed):
        self.speed, self.rate, self.time = speed, 0.0, 0.0  # [rad/s], [rad/s2], [s]
        self.start = self.energy()
        self.road = 0.0  # work against the road so far [J]

    def energy(self):
        return 0.5 * INERTIA * self.speed**2

    def middle(self):
        """Speed expected in the middle of the coming step: held over the step, it does the work that the vehicle takes, to second order."""
        return self.speed + 0.5 * STEP * self.rate

    def advance(self, torque):
        """A step under the mean torque of the coupling [N m]."""
        def slopes(time, state):
            rate = (torque - road_torque(time, state[0])) / INERTIA
            return [rate, road_torque(time, state[0]) * state[0]]

        begin, state = self.speed, [self.speed, self.road]
        if solve_ivp is not None:
            state = solve_ivp(slopes, (self.time, self.time + STEP), state, rtol=1e-10, atol=1e-10).y[:, -1]
        else:  # the midpoint rule
            half = [value + 0.5 * STEP * rate for value, rate in zip(state, slopes(self.time, state))]
            state = [value + STEP * rate for value, rate in zip(state, slopes(self.time + 0.5 * STEP, half))]
        self.time += STEP
        self.speed, self.road = float(state[0]), float(state[1])
        self.rate = (self.speed - begin) / STEP


class Variator:
    """The variator in this process."""

    def __init__(self):
        self.simulation = cvtflow.Simulation(scene())
        self.simulation.advance_to(0.0)

    def set(self, name, value):
        self.simulation.set_input(name, value)

    def get(self, name):
        return self.simulation.channels[name]

    def advance(self, time):
        self.simulation.advance_to(time)

    def reliable(self):
        return self.simulation.energy().reliable


class VariatorFmu:
    """The variator as an FMU in FMPy."""

    def __init__(self, file):
        from fmpy import extract, read_model_description
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        description, folder = read_model_description(file), extract(file)
        self.references = {row.name: row.valueReference for row in description.modelVariables}
        self.third = description.fmiVersion.startswith("3")
        self.fmu = (FMU3Slave if self.third else FMU2Slave)(guid=description.guid, unzipDirectory=folder, instanceName="variator",
                                                            modelIdentifier=description.coSimulation.modelIdentifier)
        self.fmu.instantiate()
        if self.third:
            self.fmu.enterInitializationMode(startTime=0.0)
        else:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def set(self, name, value):  # inputs have the same names, channels a dot for the slash
        (self.fmu.setFloat64 if self.third else self.fmu.setReal)([self.references[name]], [value])

    def get(self, name):
        return (self.fmu.getFloat64 if self.third else self.fmu.getReal)([self.references[name.replace("/", ".")]])[0]

    def advance(self, time):
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=time - self.time)
        self.time = time

    def reliable(self):
        return True  # an FMU that is not reports it as a warning


def scene():
    return cvtflow.Scene.ready("control").with_(SETTINGS)


def stored(variator):
    kinds = ("kinetic", "inner", "pack", "plates", "joints", "tips", "supports")
    return sum(variator.get("energy/" + kind) for kind in kinds) + variator.get("shaft_2/coupling_energy")


def drive(variator, steps):
    vehicle = Vehicle(variator.get("shaft_2/speed"))
    begin, impulse = stored(variator), variator.get("shaft_2/impulse")
    print("  time [ms]   shaft 2 [rad/s]   vehicle [rad/s]   coupling [N m]")
    for step in range(steps):
        variator.set("drive_torque", drive_torque((step + 0.5) * STEP))
        variator.set("load_speed", vehicle.middle())
        variator.advance((step + 1) * STEP)
        now = variator.get("shaft_2/impulse")
        vehicle.advance(-(now - impulse) / STEP)
        if (step + 1) % 10 == 0:
            print(f"  {step + 1:9d}   {variator.get('shaft_2/speed'):15.3f}   {vehicle.speed:15.3f}   {-(now - impulse) / STEP:14.2f}")
        impulse = now
    brought = variator.get("work/drive") + variator.get("work/clamping")
    parts = {"stored in the variator and its coupling": stored(variator) - begin,
             "lost in the variator": variator.get("dissipated/total"),
             "lost in the coupling": variator.get("shaft_2/coupling_dissipated"),
             "stored in the vehicle": vehicle.energy() - vehicle.start,
             "taken by the road": vehicle.road}
    print(f"brought by the drive and the cylinders: {brought:.4f} J")
    for name, joules in parts.items():
        print(f"  {name}: {joules:.4f} J")
    left = brought - sum(parts.values())
    print(f"  left over: {left:.4f} J, {abs(left / brought):.2e} of what was brought")
    return abs(left / brought), variator.reliable()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("milliseconds", nargs="?", type=int, default=60)
    arguments.add_argument("--fmu", help="the variator as this FMU")
    arguments.add_argument("--scene", help="write the variator's scene to this file, and nothing else")
    given = arguments.parse_args()
    if given.scene:
        with open(given.scene, "w", encoding="utf-8") as file:
            file.write(scene().text)
        print(f"cvtflow export-fmu {given.scene} -o vehicle.fmu --outputs {','.join(OUTPUTS)}")
        return
    error, reliable = drive(VariatorFmu(given.fmu) if given.fmu else Variator(), given.milliseconds)
    if not reliable or error > 1e-3:
        raise SystemExit("the balance of energy does not close")


if __name__ == "__main__":
    main()
