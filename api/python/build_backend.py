"""What `pip install .` asks for a wheel (PEP 517), with the standard library alone: Debian 12 has no scikit-build-core.

CMake builds the module and libcvtflow.so, as `cmake --install` would; the wheel holds package, library and ready scenes, all inside the
package's folder. Needed on the machine: what building cvtflow needs (README), python3-dev and pybind11-dev.

    pip install .                                       # into build-wheel/
    pip install . --config-settings build-dir=DIR --config-settings jobs=2 --config-settings cmake-args="-DCMAKE_CXX_COMPILER=clang++"
    pip wheel . --no-deps --config-settings bundle=ON   # with the libraries it needs, for any distribution with this glibc or a newer one
"""

import base64
import hashlib
import io
import os
import pathlib
import re
import shlex
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

TOP = pathlib.Path(__file__).resolve().parent.parent.parent
PACKAGE = "cvtflow"


def version():
    return re.search(r"^project\(cvtflow VERSION (\S+) ", (TOP / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


def metadata():
    """Metadata 2.1; description, classifiers and requirements come from pyproject.toml if Python can read it (3.11)."""
    try:
        import tomllib

        project = tomllib.loads((TOP / "pyproject.toml").read_text())["project"]
    except ImportError:
        project = {"dependencies": ["numpy"]}
    lines = ["Metadata-Version: 2.1", f"Name: {PACKAGE}", f"Version: {version()}", "License: Apache-2.0"]
    lines += [f"Summary: {project[key]}" for key in ["description"] if key in project]
    lines += [f"Requires-Python: {project[key]}" for key in ["requires-python"] if key in project]
    lines += [f"Keywords: {','.join(project['keywords'])}"] if "keywords" in project else []
    lines += [f"Classifier: {each}" for each in project.get("classifiers", [])]
    lines += [f"Requires-Dist: {each}" for each in project["dependencies"]]
    for extra, needs in project.get("optional-dependencies", {}).items():
        lines += [f"Provides-Extra: {extra}"] + [f'Requires-Dist: {each}; extra == "{extra}"' for each in needs]
    if "readme" in project:
        lines += ["Description-Content-Type: text/markdown", "", (TOP / project["readme"]).read_text()]
    return "\n".join(lines) + "\n"


def tag(bundle=False):
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[^A-Za-z0-9]", "_", sysconfig.get_platform())
    if bundle:  # PEP 600: the oldest glibc that it runs with
        platform = platform.replace("linux", "manylinux_" + os.confstr("CS_GNU_LIBC_VERSION").split()[1].replace(".", "_"))
    return f"{python}-{python}-{platform}"


def infos(bundle=False):
    wheel = f"Wheel-Version: 1.0\nGenerator: cvtflow {version()}\nRoot-Is-Purelib: false\nTag: {tag(bundle)}\n"
    folder = f"{PACKAGE}-{version()}.dist-info"
    return {f"{folder}/METADATA": metadata().encode(), f"{folder}/WHEEL": wheel.encode()}


# DT_RPATH instead of DT_RUNPATH: it also holds for the libraries that a library needs.
BUNDLED = [f"-DCMAKE_{kind}_LINKER_FLAGS=-Wl,--disable-new-dtags" for kind in ("SHARED", "MODULE")]
EVERYWHERE = re.compile(r"(lib(c|m|dl|rt|pthread|resolv|util|stdc\+\+|gcc_s)|ld-linux[\w-]*|linux-vdso)\.so")  # of PEP 600's profile


def bundles(settings):
    return (settings or {}).get("bundle", "").upper() in ("ON", "YES", "TRUE", "1")


def needed(library):
    """Paths of the libraries that one needs, those that every distribution has left out."""
    listed = subprocess.run(["ldd", str(library)], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\s*(\S+) => (\S+)", listed, re.MULTILINE)
    missing = [name for name, path in found if path == "not"]
    if missing:
        raise RuntimeError(f"cvtflow: {library} needs {', '.join(missing)}, which cannot be found")
    return [pathlib.Path(path) for name, path in found if not EVERYWHERE.match(name)]


def build(settings):
    """Compiles and returns the build folder."""
    folder = pathlib.Path(settings.get("build-dir") or TOP / "build-wheel").resolve()
    # The package's folder is the prefix: the module looks for the library beside itself, the library for scenes beside itself.
    arguments = ["-DCMAKE_BUILD_TYPE=Release", "-DPython3_EXECUTABLE=" + sys.executable, "-DCMAKE_INSTALL_LIBDIR=lib",
                 "-DCMAKE_BUILD_WITH_INSTALL_RPATH=ON", *(BUNDLED if bundles(settings) else []), *shlex.split(settings.get("cmake-args") or "")]
    jobs = settings.get("jobs") or str(os.cpu_count())
    environment = dict(os.environ, LD_LIBRARY_PATH=f"{folder}:{os.environ.get('LD_LIBRARY_PATH', '')}")  # the type stub is asked of the module
    subprocess.run(["cmake", "-S", str(TOP), "-B", str(folder), *arguments], check=True)
    subprocess.run(["cmake", "--build", str(folder), "--target", "cvtflow_python", "--parallel", jobs], check=True, env=environment)
    return folder


def contents(folder, bundle=False):
    """Name in the wheel and file, for everything that the package holds. @param bundle with the libraries that it needs"""
    package = folder / "python" / PACKAGE
    if not list(package.glob("_cvtflow*.so")):
        raise RuntimeError("cvtflow: no Python module was built; CMake's output lists what is missing (Debian: python3-dev, pybind11-dev)")
    for file in sorted(package.rglob("*")):
        if file.is_file() and "__pycache__" not in file.parts:
            yield f"{PACKAGE}/{file.relative_to(package)}", file
    library = folder / os.readlink(folder / "libcvtflow.so")  # by the name that the module looks for
    yield f"{PACKAGE}/lib/{library.name}", library
    for file in needed(library) if bundle else []:
        yield f"{PACKAGE}/lib/{file.name}", file
    for file in sorted((TOP / "scenes").rglob("*")):
        if file.is_file():
            yield f"{PACKAGE}/share/cvtflow/scenes/{file.relative_to(TOP / 'scenes')}", file


def get_requires_for_build_wheel(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    for name, text in infos(bundles(config_settings)).items():
        path = pathlib.Path(metadata_directory) / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(text)
    return f"{PACKAGE}-{version()}.dist-info"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder, bundle = build(config_settings or {}), bundles(config_settings)
    name = f"{PACKAGE}-{version()}-{tag(bundle)}.whl"
    record = []
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:

        def add(inside, data, mode=0o644):
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{inside},sha256={digest},{len(data)}")
            info = zipfile.ZipInfo(inside, (1980, 1, 1, 0, 0, 0))
            info.external_attr, info.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            wheel.writestr(info, data)

        for inside, file in contents(folder, bundle):
            add(inside, file.read_bytes(), 0o755 if ".so" in inside else 0o644)
        for inside, data in infos(bundle).items():
            add(inside, data)
        place = f"{PACKAGE}-{version()}.dist-info/RECORD"
        wheel.writestr(place, "\n".join(record + [f"{place},,"]) + "\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Files that git tracks."""
    name = f"{PACKAGE}-{version()}"
    files = subprocess.run(["git", "-C", str(TOP), "ls-files", "-z"], check=True, capture_output=True, text=True).stdout.split("\0")
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
        for file in filter(None, files):
            archive.add(TOP / file, f"{name}/{file}", recursive=False)
        info = tarfile.TarInfo(f"{name}/PKG-INFO")
        info.size = len(metadata().encode())
        archive.addfile(info, io.BytesIO(metadata().encode()))
    return f"{name}.tar.gz"
