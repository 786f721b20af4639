"""Tunes the ratio controller with SciPy: which gains bring a variator to a new ratio with the least mean square error?

    tune_controller.py [EVALUATIONS]
"""

import sys
from typing import Any

import numpy as np
from scipy.optimize import minimize

import cvtflow

WANTED, SPAN = 1.005, 2e-3  # [1], [s]


def settled(scene: cvtflow.Scene) -> cvtflow.Simulation:
    """A settled state, from which every trial begins; gains belong to the scene, so each has others."""
    simulation = cvtflow.Simulation(scene)
    simulation.advance_to(0.0)
    simulation.set_input("ratio", WANTED)
    return simulation


def error(logarithms: Any, scene: cvtflow.Scene) -> float:
    """Mean square distance of the ratio from the target one."""
    gain, integral = np.exp(logarithms)
    trial = settled(scene.with_(proportional=gain, integral=integral))
    rows = cvtflow.run(trial, SPAN, channels=["ratio"], interval=5e-5)
    return float(np.mean((rows["ratio"] - WANTED) ** 2))


def main(evaluations: int) -> None:
    scene = cvtflow.Scene.ready("tiny").with_(control={"enabled": True, "ratio": 1}, start={"settling_time": "1 ms", "ramp_time": "0.5 ms"})
    begin = np.log([scene["control.proportional"], scene["control.integral"]])
    found = minimize(error, begin, args=(scene,), method="Nelder-Mead", options={"maxfev": evaluations, "xatol": 0.05, "fatol": 1e-12})
    print(f"gain {np.exp(found.x[0]):.4g} N, integral {np.exp(found.x[1]):.4g} N/s: "
          f"root mean square {found.fun ** 0.5:.4g}, was {error(begin, scene) ** 0.5:.4g} ({found.nfev} evaluations)")


main(int(sys.argv[1]) if len(sys.argv) > 1 else 40)
