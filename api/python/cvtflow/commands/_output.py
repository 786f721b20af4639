"""Files that commands write: which existing ones they may replace (docs/records.md), and how a file takes its name.

A file is replaced only where it is of the kind that the command writes and of the same scene, run or sweep, or with --force. An input is
never replaced. Until a file is complete its name is FILE.part.
"""

import errno
import fcntl
import os
import re
import stat

from ._front import visible


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


def mark_of(kind, of):
    """A text in the head of a page or picture: the program that made it, and a hash of the name of its scene or sweep (64-bit FNV-1a)."""
    value = 0xcbf29ce484222325
    for byte in os.fsencode(of):
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return f"cvtflow {kind} {value:016x}"


def marked(text, mark):
    """A page or picture (bytes of HTML, SVG, XML) with its mark as a comment behind its first tag."""
    head, tag, rest = text.partition(b">")
    return head + tag + f"\n<!-- {mark} -->".encode() + rest if tag else text


def with_marks(*marks):
    """Whether a file has all of these texts in its first 4 KiB."""
    def own(path):
        try:
            with open(path, "rb") as file:
                head = file.read(4096)
        except OSError:
            return False
        return all(os.fsencode(mark) in head for mark in marks)

    return own


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


def _version(path):
    """Identity of the file under a name; None: there is none."""
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns


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


class Output:
    """The permission to write a file, asked before the work whose result goes there.

    path     of the file; its folder exists
    what     noun in messages: "FILE: already exists and is not a WHAT"
    own      whether an existing file may be replaced; None: none may
    inputs   files that are never replaced, under whatever name
    force    any file may be replaced (--force)
    named    the user chose the name, so `own` does not count without force
    devices  devices and pipes are written as by a shell's `>`
    """

    def __init__(self, path, what="file that may be replaced", own=None, inputs=(), force=False, named=False, devices=False):
        self.path, self._what, self._own, self._force, self._named = path, what, own or (lambda _: False), force, named
        require_no_input(path, inputs)
        self._device = devices and _is_device(path)
        if self._device:
            return
        if path.endswith("/"):
            _refuse(path, "a folder, not a file")
        for name in (path, path + ".part"):
            if other := _other_than_file(name):
                _refuse(name, other)
        folder = os.path.dirname(path) or "."
        if not os.path.isdir(folder):
            _refuse(path, f"the folder '{folder}' does not exist")
        if not os.access(folder, os.W_OK):
            _refuse(path, os.strerror(errno.EROFS if os.statvfs(folder).f_flag & os.ST_RDONLY else errno.EACCES))
        self._seen = _version(path)
        if self._seen and not force:
            self._require_own(path, named)
        self._require_part()

    @property
    def notice(self):
        """"FILE: the existing file is replaced"; empty: nothing was there."""
        return f"{self.path}: the existing file is replaced" if not self._device and self._seen else ""

    def _require_own(self, path, named):
        if named:
            raise OutputError(f"{path}: already exists; --force replaces it")
        if not self._own(path):
            raise OutputError(f"{path}: already exists and is not a {self._what}; --force replaces it")
        if not os.stat(path).st_mode & 0o222 or not os.access(path, os.W_OK):
            raise OutputError(f"{path}: already exists and is write-protected; --force replaces it")

    def _require_part(self):
        """Refuses the .part of another file, but for one without contents, or of zeros, as a power cut leaves it. One that is being written
        is noticed when it is locked."""
        part = self.path + ".part"
        if self._force or not os.path.exists(part):
            return
        with open(part, "rb") as file:
            blank = not file.read(4096).strip(b"\0")
        if not blank and not self._own(part):
            raise OutputError(f"{part}: already exists and is not a {self._what}; --force replaces it")

    def write(self, data):
        """Writes bytes as the whole file, which takes its name when it is complete. Raises OSError."""
        try:
            if self._device:
                self._write_device(data)
            else:
                self._write_file(data)
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

    def _open_part(self):
        """A new file, or the plain one that a killed run left: never through a link, and none that has a second name elsewhere."""
        part, flags = self.path + ".part", os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC
        try:
            number = os.open(part, flags | os.O_CREAT, 0o666)
        except OSError as error:
            _refuse(part, error.strerror)
        found = os.fstat(number)
        if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
            os.close(number)
            _refuse(part, os.strerror(errno.EEXIST))
        file = open(number, "wb")
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            _refuse(part, "another run is writing it")
        if _version(part) is None or os.stat(part).st_ino != found.st_ino:
            _refuse(part, "another run is writing it")
        return file

    def _write_file(self, data):
        part = self.path + ".part"
        self._require_part()
        with self._open_part() as file:
            try:
                file.truncate(0)
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            except OSError:
                os.unlink(part)
                raise
            self._give_name(part)
        folder = os.open(os.path.dirname(self.path) or ".", os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        os.fsync(folder)
        os.close(folder)

    def _give_name(self, part):
        """Renames a complete file, which has the mode of the one that it replaces."""
        now = _version(self.path)
        if now is not None and (now == self._seen or self._force and not _other_than_file(self.path)):
            os.chmod(part, stat.S_IMODE(os.stat(self.path).st_mode))
            os.rename(part, self.path)
            return
        try:
            if now is None:
                os.link(part, self.path)
                os.unlink(part)
                return
        except FileExistsError:
            pass
        except OSError:  # a file system without links
            os.rename(part, self.path)
            return
        raise OutputError(f"{self.path}: another program has written it meanwhile and it stays; the file of this one is {part}")


def require_no_input(path, inputs):
    """Raises OutputError where a file that is written, or its .part, is one of the inputs, under whatever name."""
    for written in (path, path + ".part"):
        for each in inputs:
            if os.path.exists(written) and os.path.exists(each) and os.path.samefile(written, each):
                _refuse(path, f"{'it' if written == path else 'its .part'} would replace the input {each}")


def marked_output(kind, of, path, inputs=(), force=False):
    """An Output for a page or picture that carries its mark."""
    return Output(path, f"{kind} that cvtflow made of '{of}'", with_marks(mark_of(kind, of)), inputs, force, devices=True)


def report_written(path):
    """Prints the path of a file."""
    print(visible(path))
