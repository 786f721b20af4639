"""Drives 8 simulations of different loads from concurrent.futures: the interpreter's lock is free while they step.

    eight_simulations.py [MILLISECONDS]
"""

import sys
from concurrent.futures import ThreadPoolExecutor

import cvtflow


def slip_under(load: float, until: float) -> tuple[float, float, float]:
    """Mean slip [1] under a load [N m]."""
    scene = cvtflow.Scene.ready("tiny").with_(load__torque=load)
    rows = cvtflow.run(scene, until, channels=["slip", "shaft_2/torque"])
    return load, float(rows["slip"].mean()), float(rows["shaft_2/torque"].mean())


def main(milliseconds: float) -> None:
    loads = [4.0 + 2.0 * number for number in range(8)]
    with ThreadPoolExecutor(8) as pool:
        for load, slip, torque in pool.map(slip_under, loads, [1e-3 * milliseconds] * 8):
            print(f"load {load:5.1f} N m: mean slip {100 * slip:.3f} %, torque {torque:.2f} N m")


main(float(sys.argv[1]) if len(sys.argv) > 1 else 2.0)
