"""A locale with a decimal comma for tests, compiled into a temporary folder: no package of the system is needed."""

import os
import shutil
import subprocess
import sys
import tempfile

NAME = "de_DE.UTF-8"


def restart_with_decimal_comma():
    """Starts this test anew with LOCPATH set, since the C library reads it once. Exit status 77: there is no localedef."""
    if "CVTFLOW_LOCALE" in os.environ:
        return
    if shutil.which("localedef") is None:
        print("skipped: no localedef (Debian: libc-bin, locales)")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", f"{folder}/{NAME}"], capture_output=True, text=True)
        if not os.path.exists(f"{folder}/{NAME}/LC_NUMERIC"):
            print(f"skipped: localedef cannot compile {NAME} (Debian: locales): {made.stderr.strip()}")
            sys.exit(77)
        environment = {**os.environ, "LOCPATH": folder, "CVTFLOW_LOCALE": NAME, "PYTHONUTF8": "1"}
        sys.exit(subprocess.run([sys.executable, *sys.argv], env=environment).returncode)
