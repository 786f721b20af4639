"""Command lines, help, messages and exit status of Python's commands, as those of the program's other commands."""

import argparse
import atexit
import contextlib
import difflib
import importlib
import importlib.util
import json
import os
import re
import shutil
import signal
import sys
import tempfile
import textwrap

DEBIAN = {"matplotlib": "python3-matplotlib", "numpy": "python3-numpy", "h5py": "python3-h5py", "jinja2": "python3-jinja2",
          "scipy": "python3-scipy"}
SI = "Show SI units (default: bar, l/min, rpm, kN, mm, %)"
FORCE = "Replace existing output files"


class UsageError(ValueError):
    """An invalid option or argument: exit status 2."""


class Parser(argparse.ArgumentParser):
    """Arguments of a command. name, description: of the command; footer: text below its help."""

    def __init__(self, name, description, footer=""):
        super().__init__(prog=f"cvtflow {name}", description=description, allow_abbrev=False, add_help=False)
        self.footer = footer
        self.add_argument("-h", "--help", action="help", help="Print this help message and exit")

    def error(self, message):
        message = re.sub(r"^argument (?:-\w, ?/?|-\w/)?", "", message)
        message = re.sub(r"^the following arguments are required: (?:-\w/)?([^\s,]+).*", r"\1 is required", message)
        raise UsageError(f"{message} ({self.prog} --help)")

    def read(self, words):
        """The arguments of a command line; options may stand between positional ones. Raises UsageError."""
        found, unknown = self.parse_known_intermixed_args(words)
        if unknown:
            names = [name for action in self._actions[1:] for name in action.option_strings if name.startswith("--")]  # but --help
            option = next((each.partition("=")[0] for each in unknown if each.startswith("--")), "")
            near = difflib.get_close_matches(option, names, 1)
            several = "s were" if len(unknown) > 1 else " was"
            meant = f", did you mean '{near[0]}'?" if near else ""
            self.error(f"The following argument{several} not expected: {' '.join(reversed(unknown))}{meant}")
        return found

    def format_help(self):
        shown = [action for action in self._actions if action.help != argparse.SUPPRESS]
        words = [action for action in shown if not action.option_strings]
        lines = [f"{self.description}.", f"Usage: {self.prog} [OPTIONS] {' '.join(map(_usage_word, words))}".rstrip(), ""]
        if words:
            lines += ["Positionals:", *map(_help_line, words), ""]
        lines += ["Options:", *(_help_line(action) for action in shown if action.option_strings), ""]
        return "\n".join([*lines, *([textwrap.dedent(self.footer).strip("\n"), ""] if self.footer else []),
                          "Exit status: 0 finished; the other numbers are in cvtflow --help."]) + "\n"


def _usage_word(action):
    """FILE..., [CHANNEL]"""
    word = (action.metavar or action.dest.upper()).split()[0] + ("..." if action.nargs in ("+", "*") else "")
    return word if action.required else f"[{word}]"


def _help_line(action):
    """`  -o,--output FILE              Picture to write`"""
    value = "" if action.nargs == 0 else action.metavar or ("" if action.option_strings else action.dest.upper())
    name = " ".join(filter(None, [",".join(action.option_strings), value, "REQUIRED" if action.required else ""]))
    return f"  {name:<30}{action.help}" if len(name) < 30 else f"  {name}\n{'':32}{action.help}"


def file_or_result(files=False):
    """A type of arguments: an input, which may be NAME alone where only results/NAME exists, with a line on stderr. files: not of folders"""
    def found(name):
        there = os.path.join("results", name)
        if os.path.basename(name) == name and not os.path.exists(name) and (os.path.isfile if files else os.path.exists)(there):
            say(f"{visible(name)}: reading {visible(there)}")
            return there
        return name

    return found


def between(kind, least, most):
    """A type of arguments: a number, or with int a whole one, from least to most."""
    def read(text):
        if not least <= (value := kind(text)) <= most:
            raise ValueError(text)
        return value

    read.__name__ = f"{'whole ' * (kind is int)}number from {least:g} to {most:g}"
    return read


def visible(text):
    """A text whose control characters are shown as \\x1b, so that no file's name or contents change the terminal."""
    return re.sub(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", lambda each: "".join(f"\\x{byte:02x}" for byte in each[0].encode()), text)


def say(message):
    """Writes a message to stderr, with `cvtflow: ` before each line that is not indented."""
    for line in str(message).split("\n"):
        sys.stderr.write(("" if line.startswith("  ") else "cvtflow: ") + visible(line) + "\n")
    sys.stderr.flush()


def require(command, *modules):
    """Raises ImportError with what to install where one of the modules is missing."""
    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if missing:
        raise ImportError(f"{command} requires {', '.join(missing)} for {sys.executable} (Debian: apt-get install "
                          f"{' '.join(DEBIAN[name] for name in missing)})")


def matplotlib():
    """Makes Matplotlib draw the same for every user: with its own fonts alone, and no settings but the package's."""
    folder = tempfile.mkdtemp(prefix="cvtflow-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    os.environ["MPLCONFIGDIR"] = folder
    place = importlib.util.find_spec("matplotlib").submodule_search_locations[0]
    with open(os.path.join(place, "font_manager.py"), encoding="utf-8") as source:
        version = re.search(r"^    __version__ = (\d+)$", source.read(), re.MULTILINE)
    kinds = {"DejaVuSans": ("normal", 400), "DejaVuSans-Bold": ("normal", 700), "DejaVuSans-Oblique": ("oblique", 400)}
    fonts = [{"fname": f"fonts/ttf/{name}.ttf", "name": "DejaVu Sans", "style": style, "variant": "normal", "weight": weight,
              "stretch": "normal", "size": "scalable", "__class__": "FontEntry"} for name, (style, weight) in kinds.items()]
    if version:  # its list of fonts is a file of its cache, whose name has a version: a later one makes its own
        listed = {"_version": int(version[1]), "_FontManager__default_weight": "normal", "default_size": None,
                  "defaultFamily": {"ttf": "DejaVu Sans", "afm": "Helvetica"}, "afmlist": [], "ttflist": fonts, "__class__": "FontManager"}
        with open(os.path.join(folder, f"fontlist-v{version[1]}.json"), "w", encoding="utf-8") as file:
            json.dump(listed, file)
    here = os.open(".", os.O_PATH)
    os.chdir("/")  # a matplotlibrc in the working folder has no effect
    importlib.import_module("matplotlib.artist").kwdoc = lambda artist: ""  # help texts of 100 classes, a tenth of the time
    os.fchdir(here)
    os.close(here)


@contextlib.contextmanager
def interruptible():
    """Inside, signals that end a process raise KeyboardInterrupt, so that it tidies up; outside they end it at once."""
    signals = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.signal(number, signal.default_int_handler) for number in signals]
    yield
    for number, handler in zip(signals, before):
        signal.signal(number, handler)


def become_program(words):
    """Replaces this process by the program that has started it. words: command and arguments"""
    sys.stdout.flush()
    program = os.environ["CVTFLOW_PROGRAM"]
    os.execv(program, [program, *words])


def _message(error):
    """What is said of an error."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: {error.strerror}"
    text = str(error.args[0] if isinstance(error, KeyError) and error.args else error) or type(error).__name__
    known = isinstance(error, (ValueError, KeyError, ImportError, OSError)) or hasattr(error, "code")
    return text if known else f"{type(error).__name__}: {text}"


def _status(commands, words):
    """Runs the command that the words name. Returns its exit status."""
    try:
        module = importlib.import_module(f"cvtflow.commands.{commands[words[0]]}")
        parser = Parser(words[0], module.DESCRIPTION, getattr(module, "FOOTER", ""))
        if not hasattr(module, "declare"):  # of the program, not of users
            return module.act(*words[1:]) or 0
        module.declare(parser)
        return module.act(parser.read(words[1:])) or 0
    except SystemExit as end:  # --help
        return end.code
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # its message is what the user gets
        if os.environ.get("CVTFLOW_TRACE"):
            raise
        say(_message(error))
        kinds = {kind.__name__ for kind in type(error).__mro__}
        return 7 if "AccuracyError" in kinds else 2 if {"UsageError", "Misuse"} & kinds else 1


def main(commands, words):
    """Runs a command. commands: modules by name; words: its name and arguments. Returns the exit status of the process."""
    for number in (signal.SIGINT, signal.SIGPIPE):
        signal.signal(number, signal.SIG_DFL)
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.reconfigure(errors="surrogateescape")
    status = _status(commands, words)
    try:
        sys.stdout.flush()
    except OSError as error:
        say(f"standard output: cannot write: {'it is closed' if error.errno == 9 else error.strerror}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python flushes once more at its end
        return status or 1
    return status
