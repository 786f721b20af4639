"""The program `cvtflow` of a wheel, which has it inside the package."""

import os
import sys


def main() -> None:
    """Becomes the program, which takes this interpreter for the commands that need one."""
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin", "cvtflow")
    environment = {"CVTFLOW_PYTHON": os.path.abspath(sys.executable), **os.environ}
    try:
        os.execve(program, ["cvtflow", *sys.argv[1:]], environment)
    except OSError as error:
        sys.exit(f"cvtflow: {program}: {error.strerror}: this package has the core library alone, which runs inside Python; the program is in "
                 "packages for Linux")
