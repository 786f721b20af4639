"""Draws what the program requests: `python3 -I _draw.py`, one request as JSON on stdin, the bytes of the file on stdout, messages on stderr.

Exit status 0; 1: the message states why; 2: an option is invalid.
"""

import ctypes
import gc
import importlib
import importlib.util
import json
import os
import re
import shutil
import signal
import sys
import tempfile
import types

DEBIAN = {"matplotlib": "python3-matplotlib", "numpy": "python3-numpy", "h5py": "python3-h5py", "jinja2": "python3-jinja2"}


def _package():
    """Makes the modules beside this file importable as cvtflow.NAME, without the compiled one, which cvtflow/__init__.py requires."""
    package = types.ModuleType("cvtflow")
    package.__path__ = [os.path.dirname(os.path.abspath(__file__))]
    sys.modules["cvtflow"] = package


def _require(names):
    """Raises ImportError with what to install."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if missing:
        packages = " ".join(DEBIAN[name] for name in missing)
        raise ImportError(f"pictures, pages and load cycles require {', '.join(missing)} for {sys.executable} "
                          f"(Debian: apt-get install {packages})")


def _own_fonts(folder):
    """Gives matplotlib its own fonts alone, so that pictures are the same for every user and it does not search the machine for others. Its
    list of fonts is a file of its cache, whose name has a version: a later one makes its own."""
    place = importlib.util.find_spec("matplotlib").submodule_search_locations[0]
    with open(os.path.join(place, "font_manager.py"), encoding="utf-8") as source:
        version = re.search(r"^    __version__ = (\d+)$", source.read(), re.MULTILINE)
    kinds = {"DejaVuSans": ("normal", 400), "DejaVuSans-Bold": ("normal", 700), "DejaVuSans-Oblique": ("oblique", 400)}
    fonts = [{"fname": f"fonts/ttf/{name}.ttf", "name": "DejaVu Sans", "style": style, "variant": "normal", "weight": weight,
              "stretch": "normal", "size": "scalable", "__class__": "FontEntry"} for name, (style, weight) in kinds.items()]
    if version:
        listed = {"_version": int(version[1]), "_FontManager__default_weight": "normal", "default_size": None,
                  "defaultFamily": {"ttf": "DejaVu Sans", "afm": "Helvetica"}, "afmlist": [], "ttflist": fonts, "__class__": "FontManager"}
        with open(os.path.join(folder, f"fontlist-v{version[1]}.json"), "w", encoding="utf-8") as file:
            json.dump(listed, file)


def file_of(described):
    """The path of an input."""
    return os.fsdecode(described["file"].encode("latin-1"))


def _end_with_program():
    """Has SIGTERM end this process and the sweep that it runs, also when the program that started it is killed."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG


def main():
    gc.set_threshold(100_000)  # a process of two seconds: by default a tenth of them are searches for cycles
    request = json.load(sys.stdin.buffer)
    os.chdir("/")  # a matplotlibrc in the working folder has no effect
    sweeps = "axes" in request
    if sweeps:
        _end_with_program()
    _require(["numpy", "matplotlib"] + ["h5py"] * ("records" in request or sweeps)
             + ["jinja2"] * (request["command"] == "report"))
    _package()
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is a message
    folder = tempfile.mkdtemp(prefix="cvtflow-")
    try:
        os.environ["MPLCONFIGDIR"] = folder
        _own_fonts(folder)
        importlib.import_module("matplotlib.artist").kwdoc = lambda artist: ""  # help texts of 100 classes, a tenth of the time
        made = importlib.import_module("cvtflow._requested").made
        output.write(made(request))
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    output.close()


if __name__ == "__main__":
    sys.modules["cvtflow._draw"] = sys.modules["__main__"]
    try:
        main()
    except Exception as error:
        if os.environ.get("CVTFLOW_TRACE"):
            raise
        text = str(error.args[0] if isinstance(error, KeyError) and error.args else error) or type(error).__name__
        print(text if isinstance(error, (ValueError, KeyError, ImportError, OSError)) else f"{type(error).__name__}: {text}", file=sys.stderr)
        sys.exit(2 if "Misuse" in [kind.__name__ for kind in type(error).__mro__] else 1)
