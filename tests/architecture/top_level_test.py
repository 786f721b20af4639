"""The repository as a whole: names on its top level, the format of its sources, one version everywhere; symbols of its kernels."""

import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from source_tree import GIT, TOP, Rules, main, output_of, tracked_top_level

# The top level is the first thing that a newcomer sees: nothing lands there by accident.
ALLOWED = {
    ".ci", ".clang-format", ".clang-tidy", ".gitignore", "ARCHITECTURE.md", "CHANGELOG.md", "CMakeLists.txt", "CMakePresets.json",
    "LICENSE",
    "README.md", "bench", "engine", "model", "scenes", "tasks", "tests", "tools",
    "CITATION.cff",  # read there by the sites that offer to cite a repository
    "CONTRIBUTING.md", "SECURITY.md",  # where contributors expect them
    "debian",  # dpkg-buildpackage searches nowhere else
    "docs",  # pages for users, decisions, gallery
    "api",  # what host programs include and link: must be found without knowing the inside
    "examples",  # the first thing that an author of a host program opens; a separate project as well
    "pyproject.toml",  # pip searches nowhere else
}


class TopLevel(Rules):
    def test_holds_what_every_build_needs_and_only_what_is_allowed(self):
        self.none(sorted(tracked_top_level() - ALLOWED))
        self.assertLessEqual({"CMakeLists.txt", "LICENSE", "engine", "model", "tests"}, tracked_top_level())


class DeepFormat(Rules):
    def test_of_every_source_is_that_of_the_file(self):
        """A change then shows only what changed. Other versions break lines elsewhere."""
        if not shutil.which("clang-format-14"):
            self.skipTest("needs clang-format-14")
        tracked_top_level()
        changed = output_of(f"cd '{TOP}' && {GIT} ls-files -z '*.cpp' '*.hpp' 2>/dev/null | xargs -0 -r clang-format-14 --dry-run 2>&1 | "
                            "grep -o '^[^:]*:[0-9]*:[0-9]*: warning' | sort -u | head -40; true")
        self.assertEqual(changed, "", "clang-format-14 -i FILE corrects it")


class Release(Rules):
    """One version everywhere: tools/release compares, and writes, here into copies of its files."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for part in ("CMakeLists.txt", "CITATION.cff", "debian", "api/include", "api/install/cvtflow-config.cmake.in", "docs/embedding.md",
                     "examples/CMakeLists.txt", "tests/api/consumer", "tools/release"):
            (self.folder / part).parent.mkdir(parents=True, exist_ok=True)
            (shutil.copytree if (TOP / part).is_dir() else shutil.copy)(TOP / part, self.folder / part)

    def release(self, *arguments):
        done = subprocess.run([self.folder / "tools/release", *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def test_every_place_states_the_version_of_the_project_and_one_with_another_is_named(self):
        self.assertEqual(self.release()[0], 0)
        for stated, named in (("version: 0.0.9", "0.0.9"), ("no version", "nothing")):
            (self.folder / "CITATION.cff").write_text(stated + "\n")
            status, text = self.release()
            self.assertEqual((status, text.startswith(f"CITATION.cff: {named}, not ")), (1, True), text)

    def test_a_new_version_is_written_into_all_of_them(self):
        self.assertEqual(self.release("12.34.56"), (0, "12.34.56\n"))
        self.assertEqual(self.release()[0], 0)
        for file, words in (("CMakeLists.txt", r"project\(cvtflow VERSION 12.34.56 "), ("debian/changelog", r"\Acvtflow \(12.34.56\) "
                                                                                                            r"unstable"),
                            ("api/include/cvtflow/version.hpp", "VERSION_MINOR 34\n")):
            self.assertRegex((self.folder / file).read_text(), words)
        self.assertEqual(self.release("12.34")[0], 2, "three numbers")


@unittest.skipUnless("CVTFLOW_NM" in os.environ, "sanitizers add symbols")
class DeepKernelSymbols(Rules):
    """The kernels are compiled once per instruction set. A function that two of these copies define under one name is shared by the linker,
    which may then put AVX-512 code where the baseline's is meant: on an older processor that is an illegal instruction, on none a test
    fails."""

    def entries(self, objects):
        """Functions that the kernels below a folder of objects show; none is a symbol that the linker merges."""
        files = [str(file) for folder in Path(objects).glob("cvtflow_kernels_*") for file in folder.rglob("*.o")]
        shown = subprocess.run([os.environ["CVTFLOW_NM"], "-A", "-C", "--defined-only", *files], capture_output=True, text=True).stdout
        symbols = re.findall(r"^(.*\.o):[0-9a-f]+ (\w) (.*)$", shown, re.MULTILINE)
        # DW.ref: the address of a run-time function, the same in every copy.
        self.none(f"{file}: {name}" for file, kind, name in symbols if kind in "WVu" and not name.startswith("DW.ref."))
        return len([kind for _, kind, _ in symbols if kind == "T"])

    def test_none_is_shared_between_instruction_sets(self):
        objects = Path(os.environ["CVTFLOW_BUILD"])
        self.assertGreaterEqual(self.entries(objects / "CMakeFiles"), 5)  # chain, friction, single and rigid kernels of one set at least
        self.assertGreaterEqual(self.entries(objects / "bench/staged/CMakeFiles"), 1)  # staged_kernels of the laboratory

    def test_no_multiply_add_is_fused_in_the_library(self):
        """One here and not there would make bits depend on instruction sets and on how sources are grouped; GCC 12 makes some in spite of
        -ffp-contract=off."""
        words = [os.environ["CVTFLOW_OBJDUMP"], "-d", "--no-show-raw-insn", os.environ["CVTFLOW_LIBRARY"]]
        code = subprocess.run(words, capture_output=True, text=True).stdout
        self.none(re.findall(r".*\t(?:vfm|vfnm).*", code))
        self.assertGreater(code.count("\n"), 100000)


if __name__ == "__main__":
    main()
