"""Claim of docs/validation.md: over the urban cycle, with its wear.coefficient, pins' ends lose the published 0.1 to 0.2 mm in 300,000 km.

    urban_wear_check.py [RECORD]    RECORD: one of the scene urban_cycle; without, the scene runs
"""

import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: this interpreter has no NumPy")
    sys.exit(77)

import cvtflow
from cvtflow._numbers import integral
from cvtflow._wear import worn_depth

PUBLISHED, DISTANCE = (0.1e-3, 0.2e-3), 3e8  # [m]
WHEEL, FINAL_DRIVE = 0.3, 5.5  # of urban_cycle.csv


def depths(path):
    """Worn depth of each tip after the distance."""
    record = cvtflow.Record(path)
    worn, scene, time = record.wear(), record.scene, record["time"]
    driven = integral(time, record["shaft_2/speed"]) * WHEEL / FINAL_DRIVE
    hours = 1000.0 * DISTANCE / driven * (time[-1] - time[0]) / 3.6e6  # Record.wear() is of 1,000 hours
    return worn_depth(worn["tip_volume"] * hours / 1000.0, worn["tip_spot"], scene["tip.radius"], scene["half.area"])


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = sys.argv[1] if len(sys.argv) > 1 else os.path.join(folder, "urban_cycle.h5")
        if len(sys.argv) < 2:
            subprocess.run([os.environ["CVTFLOW_PROGRAM"], "run", "urban_cycle", "-q", "-o", path], check=True)
        found = depths(path)
    print(f"in {DISTANCE / 1e3:g} km: {1e3 * np.mean(found):.3f} mm, {1e3 * np.min(found):.3f} to {1e3 * np.max(found):.3f}")
    return 0 if PUBLISHED[0] <= np.min(found) and np.max(found) <= PUBLISHED[1] else 1


if __name__ == "__main__":
    sys.exit(main())
