"""`cvtflow report`: a page of records or of sweeps."""

from .._output import Output, inputs_of, picture_path
from ._front import FORCE, SI, UsageError, file_or_result, matplotlib, require, say, visible

DESCRIPTION = "Write a self-contained HTML page of records or a sweep: curves, the running chain, tables"
FOOTER = """
The page is one file and needs no network: status and warnings, key figures and differences, vehicle, scene, curves, running
chain, pin forces, losses, wear, spectra, provenance. A file that exists is replaced with --force, or under its default name in
results/. Long records are thinned to minima and maxima, and the page states it.
"""


def declare(parser):
    add = parser.add_argument
    add("files", metavar="FILE ...", nargs="+", type=file_or_result(),
        help="Records, or sweeps (folder, or CSV); several are shown beside each other")
    add("-o", "--output", metavar="FILE", help="Page to write (default: beside the input, .html)")
    add("--with", metavar="FILE", dest="measured", help="Measured data beside the results: a CSV as plot --with takes it")
    add("--si", action="store_true", help=SI)
    add("--force", action="store_true", help=FORCE)


def _warn_without_machine(record):
    """The page shows what was recorded; the chain needs the machine as well."""
    from .. import _known

    if record.scene is None and "parameters" in record.attributes:
        try:
            _known.read_scene(record.attributes["parameters"])
        except ValueError as error:
            say(f"{record.path}: the page shows no chain: cannot read the parameters of its machine: {error}")


def act(given):
    require("report", "numpy", "matplotlib", "h5py", "jinja2")
    path = picture_path(given.output, given.files[0], "report.html")
    output = Output(path, inputs_of([*given.files, given.measured]), given.force, named=bool(given.output))
    matplotlib()
    from .. import _figures, pages
    from . import _inputs

    _figures.in_notebooks = False
    sweeps = [_inputs.is_sweep(file) for file in given.files]
    if len(set(sweeps)) > 1:
        raise UsageError("a report covers records, or sweeps")
    of = [_inputs.results(file) for file in given.files] if sweeps[0] else _inputs.records(given.files)
    if not sweeps[0]:
        for record in of:
            _warn_without_machine(record)
    page = pages.report(of, with_=_inputs.measured(given.measured), si=given.si).encode()
    output.write(page)
    size = f"{1e-3 * len(page):.1f} kB" if len(page) < 1e6 else f"{1e-6 * len(page):.1f} MB"
    print(f"{visible(path)} ({size})")
