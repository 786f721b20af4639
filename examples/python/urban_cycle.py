"""Writes the operating points of a variator over two minutes of the European urban driving cycle, as a table for scenes.

    python3 urban_cycle.py urban_cycle.csv          # the file of the scene "urban_cycle"

The speed of the vehicle is that of the cycle ECE-15 (directive 70/220/EEC, type I test) from its 75th to its last second: a trace of straight
lines. What the variator has to do follows from it by these assumptions, all of them constants below:

- a passenger car: mass with rotating parts, rolling resistance, drag of air;
- a final drive between shaft 2 and the wheels without losses, and a starting clutch in it: below the speed at which shaft 2 turns at the
  engine's idling speed and the largest ratio, the clutch slips; it transmits the torque that the vehicle needs. Brakes take all torque
  beyond the engine's drag, and the clutch is open while the vehicle stands or rolls out below 10 km/h;
- the engine turns at one speed that the ratio keeps, as far as its range allows;
- the driven side is clamped by the torque with a safety factor, in the scene; S_1 of the table is the first guess of ratio control.
"""
import math
import sys

# Speed of the vehicle at times of the cycle: s, km/h (tables I.1 and I.3 of the directive, gear changes included as straight lines).
CYCLE = [(61, 32), (85, 32), (93, 10), (96, 0), (117, 0), (122, 15), (124, 15), (133, 35), (135, 35), (143, 50), (155, 50), (163, 35),
         (176, 35), (178, 32), (185, 10), (188, 0), (195, 0)]
BEGIN, DURATION, INTERVAL = 75.0, 120.0, 0.5  # s
MASS, ROTATING = 1200.0, 1.05                 # kg; factor for rotating parts
ROLLING, DRAG_AREA, AIR = 0.012, 0.62, 1.2    # 1; c_w A [m^2]; kg/m^3
WHEEL, FINAL_DRIVE = 0.30, 5.5                # m, 1
RATIO = (0.6, 2.2)                            # range of the ratio in use
IDLING, CRUISING = 900.0, 1450.0              # rpm
ENGINE_DRAG = -15.0                           # N m on shaft 2, the least that the variator transmits
CLUTCH_OPENS = 10.0                           # km/h, in deceleration
FRICTION, ANGLE, RADIUS = 0.09, math.radians(11.0), 54.44e-3  # of tips; flank; running radius at ratio 1 [m]
GUESS, LEAST = 1.6, 5e3                       # safety factor and smallest force of the first guess [1, N]
SMOOTHING = 0.25                              # s: time over which torque and ratio are means; pedals do not jump


def vehicle(time):
    """Speed [m/s] and acceleration [m/s^2] of the cycle."""
    for (t0, v0), (t1, v1) in zip(CYCLE, CYCLE[1:]):
        if time < t1 or t1 == CYCLE[-1][0]:
            rate = (v1 - v0) / (t1 - t0) / 3.6
            return max(0.0, v0 / 3.6 + rate * (time - t0)), rate
    return 0.0, 0.0


def demand(time):
    """Speed of shaft 1 [rad/s], torque on shaft 2 [N m], ratio."""
    rpm = math.pi / 30.0
    speed, rate = vehicle(time)
    wheels = speed / WHEEL * FINAL_DRIVE  # speed of shaft 2 with the clutch closed
    driven = max(wheels, IDLING * rpm / RATIO[1])
    ratio = min(RATIO[1], max(RATIO[0], CRUISING * rpm / driven))
    force = MASS * ROTATING * rate
    if speed > 0.0:
        force += MASS * 9.81 * ROLLING + 0.5 * AIR * DRAG_AREA * speed * speed
    torque = force * WHEEL / FINAL_DRIVE
    rolls_out = rate < 0.0 and speed < CLUTCH_OPENS / 3.6
    return driven * ratio, 0.0 if rolls_out else max(torque, ENGINE_DRAG), ratio


def rows():
    """Time from BEGIN [s], speed [rpm], torque [N m], ratio, first guess of both forces [N]; values are means over SMOOTHING."""
    points = 20
    for step in range(int(DURATION / INTERVAL) + 1):
        time = BEGIN + step * INTERVAL
        span = [demand(min(time + SMOOTHING * (2.0 * k / points - 1.0), BEGIN + DURATION)) for k in range(points + 1)]
        speed, torque, ratio = (sum(values) / len(span) for values in zip(*span))
        radius = RADIUS * 2.0 * ratio / (1.0 + ratio)
        force = max(LEAST, GUESS * abs(torque) * math.cos(ANGLE) / (2.0 * FRICTION * radius))
        yield step * INTERVAL, speed * 30.0 / math.pi, torque, ratio, force


def text():
    lines = ["# Two minutes of the urban cycle ECE-15 from its 75th second on, by examples/python/urban_cycle.py, which states all assumptions",
             "t [s],speed [rpm],torque [N*m],ratio,S [kN]"]
    lines += ["{:g},{:.1f},{:.2f},{:.4f},{:.3f}".format(t, speed, torque, ratio, force / 1e3) for t, speed, torque, ratio, force in rows()]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) > 1:
        with open(sys.argv[1], "w", encoding="ascii") as file:
            file.write(text())
    else:
        sys.stdout.write(text())
