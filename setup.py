"""The wheel: package, library, program and ready scenes, all inside the package's folder. One for every Python from 3.9 on.

    pip install . --no-build-isolation                    # into build-wheel/; Debian: python3-pip python3-wheel
    CVTFLOW_BUILD=DIR CVTFLOW_JOBS=2 CMAKE_ARGS="-DCMAKE_CXX_COMPILER=clang++" pip wheel . --no-deps --no-build-isolation
    CVTFLOW_BUNDLE=1 pip wheel . --no-deps --no-build-isolation   # with the libraries it needs, for any distribution with this glibc
    CVTFLOW_WINDOWS=1 pip wheel . --no-deps --no-build-isolation   # for Windows: the core library, by mingw-w64, and no program

CMake builds library and program as for an installation, unless CVTFLOW_BUILT names a build folder that has both.
"""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile

from setuptools import Distribution, setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

TOP = pathlib.Path(__file__).resolve().parent
BUNDLE, WINDOWS = (os.environ.get("CVTFLOW_" + name, "") not in ("", "0") for name in ("BUNDLE", "WINDOWS"))
EVERYWHERE = re.compile(r"(lib(c|m|dl|rt|pthread|resolv|util|stdc\+\+|gcc_s)|ld-linux[\w-]*|linux-vdso)\.so")  # of PEP 600's profile


def built():
    """The build folder, with library and program in it."""
    if "CVTFLOW_BUILT" in os.environ:
        return pathlib.Path(os.environ["CVTFLOW_BUILT"])
    folder = pathlib.Path(os.environ.get("CVTFLOW_BUILD", TOP / "build-wheel")).resolve()
    # DT_RPATH instead of DT_RUNPATH: it also holds for the libraries that a library needs.
    bundle = [f"-DCMAKE_{kind}_LINKER_FLAGS=-Wl,--disable-new-dtags" for kind in ("SHARED", "EXE")] if BUNDLE else []
    subprocess.run(["cmake", "-S", TOP, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_INSTALL_LIBDIR=lib",
                    "-DCMAKE_BUILD_WITH_INSTALL_RPATH=ON", *bundle, *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
    targets = ["cvtflow_windows"] if WINDOWS else ["cvtflow", "cvtflow_library", "cvtflow_fmu"]
    subprocess.run(["cmake", "--build", folder, "--parallel", os.environ.get("CVTFLOW_JOBS", str(os.cpu_count())), "--target", *targets],
                   check=True)
    return folder


def needed(file):
    """Paths of the libraries that a file needs, without those that every distribution has."""
    listed = subprocess.run(["ldd", file], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\s*(\S+) => (\S+)", listed, re.MULTILINE)
    if missing := [name for name, path in found if path == "not"]:
        raise RuntimeError(f"cvtflow: {file} needs {', '.join(missing)}, which cannot be found")
    return [pathlib.Path(path) for name, path in found if not EVERYWHERE.match(name)]


class Build(build_py):
    def run(self):
        super().run()
        folder, package = built(), pathlib.Path(self.build_lib, "cvtflow")
        fmu = [folder / name for name in ("cvtflow_fmu.so", "cvtflow_fmu.dll") if (folder / name).exists()]
        if len(fmu) > 1 and fmu[1].stat().st_mtime_ns < fmu[0].stat().st_mtime_ns:
            if WINDOWS:
                raise RuntimeError("cvtflow: cvtflow_fmu.dll is older than cvtflow_fmu.so: cmake --build build --target cvtflow_windows")
            del fmu[1]  # of other sources
        programs = [] if WINDOWS else [folder / "cvtflow"]
        library = folder / ("cvtflow.dll" if WINDOWS else os.readlink(folder / "libcvtflow.so"))  # by the name that the package looks for
        libraries = [library, *(each for file in [library, *programs] * BUNDLE for each in needed(file))]
        for place, files in (("lib", libraries), ("lib/cvtflow", fmu), ("bin", programs), ("fmu", [TOP / "LICENSE"])):
            (package / place).mkdir(exist_ok=True)
            for file in files:
                shutil.copy(file, package / place / file.name)
        shutil.copytree(TOP / "scenes", package / "share/cvtflow/scenes", dirs_exist_ok=True)


class Wheel(bdist_wheel):
    def get_tag(self):  # no ABI of Python's in it
        if WINDOWS:
            return "py3", "none", "win_amd64"
        platform = super().get_tag()[2]
        glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_")  # PEP 600: the oldest that a bundle runs with
        return "py3", "none", platform.replace("linux", "manylinux_" + glibc) if BUNDLE else platform


class WithLibrary(Distribution):
    def has_ext_modules(self):  # into the folder of platforms
        return True


work = tempfile.TemporaryDirectory()  # what setuptools writes on the way; the tree stays as it is
setup(
    options={"build": {"build_base": work.name}, "egg_info": {"egg_base": work.name}},
    version=re.search(r"^project\(cvtflow VERSION (\S+) ", (TOP / "CMakeLists.txt").read_text(), re.MULTILINE).group(1),
    packages=["cvtflow", "cvtflow.commands"],
    package_dir={"": "api/python"},
    package_data={"cvtflow": ["*.mplstyle", "py.typed", "*.c", "page/*", "fmu/*"]},
    distclass=WithLibrary,
    cmdclass={"build_py": Build, "bdist_wheel": Wheel},
    zip_safe=False,
)
