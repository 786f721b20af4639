"""Files that commands and sweeps write, by the one rule of docs/records.md: FILE.part is written, synced and renamed to FILE. A file that
exists is refused without --force, but for default names in results/. An input is never replaced.
"""

import errno
import fcntl
import os
import re
import stat


class OutputError(OSError):
    """A file that cannot or must not be written."""


def beside(file, ending):
    """The name of a file beside a record or sweep, with another ending: "run_0.1.h5" gives "run_0.1.html"."""
    name = file.removesuffix(".part") if os.path.basename(file) != ".part" else file
    for own in (".h5", ".csv", ".toml"):
        if name.endswith(own) and os.path.basename(name) != own:
            return name[:-len(own)] + ending
    return name + ending


def picture_path(named, source, inside):
    """The path of a picture or page: the name that the user gave, else the file `inside` a folder, or beside a file."""
    if named:
        return named
    return os.path.join(source, inside) if os.path.isdir(source) else beside(source, os.path.splitext(inside)[1])


def inputs_of(files):
    """The files that a command line names, and the tables of folders."""
    return [path for file in files if file for path in (file, os.path.join(file, "results.csv"))]


def default_place(name):
    """The path results/NAME of what no -o names. Creates the folder; raises OutputError where this user must not."""
    try:
        os.makedirs("results", exist_ok=True)
    except OSError as error:
        if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS):
            raise OutputError(f"results/{name}: cannot create: no permission to create the folder 'results' here (choose a place with -o)"
                              ) from None
    return f"results/{name}"


def _refuse(path, why):
    raise OutputError(f"{path}: cannot create: {why}")


def _other_than_file(path):
    """What is under a name that can never be replaced; empty: nothing, or a plain file."""
    try:
        mode = os.lstat(path).st_mode
    except OSError:
        return ""
    if stat.S_ISREG(mode):
        return ""
    if stat.S_ISLNK(mode):
        return "a symbolic link; name its target"
    return "a folder, not a file" if stat.S_ISDIR(mode) else "a device, pipe or socket, not a file"


def _descriptor(path):
    """The descriptor that a shell gave this process, of a name that leads to it; None: another name."""
    named = {"/dev/stdout": 1, "/dev/stderr": 2}.get(path)
    found = re.fullmatch(r"(?:/dev|/proc/self)/fd/(\d+)", path)
    return int(found[1]) if found else named


def _is_device(path):
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return _descriptor(path) is not None or stat.S_ISCHR(mode) or stat.S_ISFIFO(mode)


def require_no_input(path, inputs):
    """Raises OutputError where a file that is written, or its .part, is one of the inputs, under whatever name."""
    for written in (path, path + ".part"):
        for each in inputs:
            if each and os.path.exists(written) and os.path.exists(each) and os.path.samefile(written, each):
                _refuse(path, f"{'it' if written == path else 'its .part'} would replace the input {each}")


class Output:
    """A file that a command writes; its place is checked before the work whose result goes there.

    path     of the file, or of a device or pipe, which is written as by a shell's `>`
    inputs   files that are never replaced, under whatever name
    force    any file may be replaced (--force)
    named    the user chose the name, so that also one in results/ is not replaced
    """

    def __init__(self, path, inputs=(), force=False, named=True):
        self.path, self._force, self._default = path, force, not named and path.startswith("results/")
        require_no_input(path, inputs)
        if not _is_device(path):
            self._require_place()
        self.notice = f"{path}: the existing file is replaced" if os.path.isfile(path) else ""

    def _require_place(self):
        path, part, folder = self.path, self.path + ".part", os.path.dirname(self.path) or "."
        if path.endswith("/"):
            _refuse(path, "a folder, not a file")
        for name in (path, part):
            if other := _other_than_file(name):
                _refuse(name, other)
        if not os.path.isdir(folder):
            _refuse(path, f"the folder '{folder}' does not exist")
        if not os.access(folder, os.W_OK):
            _refuse(path, os.strerror(errno.EROFS if os.statvfs(folder).f_flag & os.ST_RDONLY else errno.EACCES))
        if os.path.exists(path) and not self._replaces():
            raise OutputError(f"{path}: already exists; --force replaces it")
        if not self._force and os.path.exists(part) and os.path.getsize(part) > 0:
            raise OutputError(f"{part}: already exists, left by a command that was killed; --force replaces it")

    def _replaces(self):
        return self._force or self._default and os.stat(self.path).st_mode & 0o200

    def write(self, data):
        """Writes bytes as the whole file. Raises OutputError."""
        try:
            self._write_device(data) if _is_device(self.path) else self._write_file(data)
        except OutputError:
            raise
        except OSError as error:
            why = "no process reads from this pipe" if error.errno == errno.ENXIO else error.strerror
            raise OutputError(f"{self.path}: cannot write: {why}") from None

    def _write_device(self, data):
        given = _descriptor(self.path)
        flags = os.O_WRONLY | os.O_TRUNC | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY  # without waiting for a reader
        number = os.open(self.path, flags) if given is None else os.dup(given)
        os.set_blocking(number, True)
        with open(number, "wb") as file:
            file.write(data)

    def _write_file(self, data):
        part = self.path + ".part"
        self._require_place()
        with open(os.open(part, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666), "wb") as file:
            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                _refuse(part, "another process is writing it")
            if os.fstat(file.fileno()).st_nlink != 1:
                _refuse(part, os.strerror(errno.EEXIST))  # it has a second name elsewhere, or its writer has just finished
            try:
                file.truncate(0)
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            except OSError:
                os.unlink(part)
                raise
            give_name(part, self.path, self._replaces)
        sync_folder(os.path.dirname(self.path) or ".")


def sync_folder(folder):
    """Brings the names in a folder to disk."""
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    os.fsync(number)
    os.close(number)


def give_name(part, path, replaces):
    """Renames a complete file, with the mode of the one that it replaces, if replaces() permits that. Raises OutputError otherwise."""
    try:
        os.link(part, path)
        os.unlink(part)
    except OSError:  # it exists, or this file system has no hard links
        if os.path.lexists(path):
            if _other_than_file(path) or not replaces():
                raise OutputError(f"{path}: another program has written it meanwhile and it stays; the file of this one is {part}") from None
            os.chmod(part, stat.S_IMODE(os.stat(path).st_mode))
        os.rename(part, path)
