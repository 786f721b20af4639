"""Commands of the program that Python carries out, and what `run` and `batch` have it do for an accuracy. `cvtflow NAME …` executes this file: `python3 -I -B -X utf8 __main__.py NAME …`.

Each command is a module of commands/ with `declare(parser)` and `act(arguments)`, which returns an exit status (None: 0). The package is
loaded from the folder of this file, whatever else has its name.
"""

import importlib.util
import os
import sys

COMMANDS = {"table": "table", "diff": "diff", "plot": "plot", "report": "report", "export-fmu": "export_fmu", "reduce": "reduce",
            "clamp": "clamp", "fit": "fit", "tune": "tune", "export": "export"}  # module of commands/ by name


def _load_package():
    """Loads the package of this folder as `cvtflow`."""
    here = os.path.dirname(os.path.abspath(__file__))
    spec = importlib.util.spec_from_file_location("cvtflow", os.path.join(here, "__init__.py"), submodule_search_locations=[here])
    sys.modules["cvtflow"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["cvtflow"])  # which imports next to nothing before a name of it is used


if __name__ == "__main__":
    _load_package()
    from cvtflow.commands import _front

    sys.exit(_front.main(COMMANDS | {"run": "run", "accuracy": "accuracy"}, sys.argv[1:]))
