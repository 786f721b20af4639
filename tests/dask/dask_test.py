#!/usr/bin/env python3
"""Runs the Dask program of docs/sweeps.md on a real local cluster of two processes and compares its results hash with one process's.

Usage: dask_test.py PROGRAM SOURCE_DIR. Exit status 77: python3-distributed is missing (ctest reports it as skipped).
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import distributed  # noqa: F401
except ImportError:
    print("no python3-distributed", file=sys.stderr)
    sys.exit(77)

program, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
page = (source / "docs/sweeps.md").read_text(encoding="utf-8")


def block(file):
    return re.search(rf"<!-- file: {re.escape(file)} -->\n```\w+\n(.*?)```", page, re.DOTALL)[1]


def results_hash(folder):
    return subprocess.run(["cvtflow", "table", folder], check=True, capture_output=True, text=True).stdout.split()[-1]


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["PATH"] = f"{program.parent}:{os.environ['PATH']}"
    os.environ["PYTHONPATH"] = str(program.parent / "python")
    for file in ["first.toml", "by_dask.py"]:
        pathlib.Path(file).write_text(block(file), encoding="utf-8")
    subprocess.run([sys.executable, "by_dask.py"], check=True)
    assert len(list(pathlib.Path("by_dask").glob("rows-*.csv"))) == 2, "not by two workers"
    subprocess.run(["cvtflow", "batch", "first.toml", "-o", "one", "-q"], check=True)
    print(f"results hash {results_hash('by_dask')}")
    assert results_hash("by_dask") == results_hash("one")
