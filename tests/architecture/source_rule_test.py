"""Rules that no compiler checks: numbers without a locale, files written through the rule for files, local names unlike those of headers,
functions defined where their header is."""

import collections
import re

from source_tree import Rules, code_only, main, named_functions, source_files

# Numbers are read and written with a decimal point, whatever the locale of the host: std::from_chars (engine/base/text.hpp) and fmt.

LOCALE_CALLS = re.compile(r"\b(strto(d|f|ld)|atof|sto(d|f|ld)|[a-z]*printf|[a-z]*scanf|setlocale|localeconv)\b ?\("
                          r"|\b(basic_)?o?stringstream\b|\bstd::locale\(|\blocale::global\b|\bput_time\b")
STREAM, EXTRACTION = re.compile(r"\b(std::)?(ifstream|istringstream|istream)\b"), re.compile(r"[\w)] >> [a-z]\w*")
LOCALE_EXEMPT = {
    "tasks/scene/ready_scenes.cpp": "addresses in hexadecimal",
    "tasks/batch/sweep/scalar.cpp": "words",
    "tasks/schedule/schedule.cpp": "words, which number_of reads",
    "engine/record/hdf5/hdf5_open.cpp": "a word, which number_of reads",
    "tools/cmake/web/missing.hpp": "functions that a browser's library lacks: it has the C locale alone",
}


def localised(text):
    """Call that follows the locale, or ""."""
    code = code_only(text)
    found = LOCALE_CALLS.search(code)
    if not found and STREAM.search(code) and ".imbue(" not in code:
        found = EXTRACTION.search(code)
    return found[0] if found else "{:L}" if re.search(r"\{:[^{}\"]*L\}", text) else ""


class LocaleRule(Rules):
    def test_follows_no_locale(self):
        """Code that runs in a host's process or writes files. Other benchmarks are programs that leave the locale as it is: "C"."""
        parts, folders = ("engine", "model", "tasks", "api", "tools"), ("bench/lab/", "bench/study/")
        found = {file.path: localised(file.text) for file in source_files() if file.part in parts or file.path.startswith(folders)}
        self.only({path: what for path, what in found.items() if what}, LOCALE_EXEMPT)

    def test_the_scanner_finds_every_kind_of_call(self):
        for text in ("x = std::strtod(a, b);", "x = atof(a);", "x = std::stod(a);", "std::snprintf(a, n, f, x);", "printf(f, x);",
                     "std::ostringstream text;", "std::ifstream file(path);\ndouble x;\nfile >> x;", "std::sscanf(a, b)",
                     'fmt::format("{:L}", n)'):
            self.assertNotEqual(localised(text), "", text)
        for text in ("std::strtoul(a, b, 10);", "fmt::print(f, x);", "std::istringstream a(b);\na.imbue(c);\na >> x;", "x = y >> z;",
                     "std::ifstream file(path);\nstd::getline(file, line);"):
            self.assertEqual(localised(text), "", text)


# No file is written or removed around the rule for files (engine/record/run/output_rule.hpp).

CALLS = {
    "create": re.compile(r"\b(std::(o|basic_o)?fstream\b(?! ?&)|std::ofstream|f(re)?open|tmpfile|mkstemp|mkdtemp|creat)\b ?[({]?|"
                         r"\bO_(WRONLY|RDWR|CREAT|TRUNC)\b|\bH5Fcreate\b|\bH5F_ACC_(RDWR|TRUNC|EXCL)\b"),
    "remove": re.compile(r"\b(remove_all|copy_file|renameat2?|unlink(at)?|rmdir)\b ?\(|\b(fs|filesystem)::(rename|remove|copy)\(|"
                         r"\bstd::rename\("),
}
# Files that may, and the reason. All others write through engine::Permit: write_whole, write_state, write_cases, CaseWriter, RunFile.
WRITING_EXEMPT = {
    "create": {
        "engine/record/run/part_file.cpp": "the one writer: FILE.part, which asks for a Permit",
        "engine/record/run/output_rule.cpp": "the rule itself: devices and pipes",
        "engine/record/run/run_layout.cpp": "HDF5 on the .part that a PartFile holds",
        "engine/record/run/run_file.cpp": "HDF5 on the .part that a PartFile holds",
        "engine/record/run/state_file.cpp": "HDF5 in memory",
        "engine/record/case_table.cpp": "HDF5 on the .part that a PartFile holds; the empty lock of a folder",
        "tools/program/guard.cpp": "/dev/null"},
    "remove": {
        "engine/record/run/part_file.cpp": "its .part; the former record of a run that is resumed",
        "engine/record/run/output_rule.cpp": "the rule itself: files of a writer, by name",
        "tasks/run/checkpoint.cpp": "a checkpoint, and its .part",
        "tasks/run/run_recorder.cpp": "the former record of a run that was resumed",
        "tasks/batch/batch.cpp": "an empty folder",
        "tasks/batch/case_checkpoint.cpp": "the former record of a case that begins anew",
        "tools/program/view/vtk_series.cpp": "what it has just written"},
}


class OutputRule(Rules):
    """Of parts whose files are users' files; the laboratory and tests are not."""

    files = [file for file in source_files() if file.part in ("engine", "model", "tasks", "api") or file.path.startswith("tools/program/")]

    def test_no_source_writes_or_removes_files_around_it(self):
        for what, call in CALLS.items():
            found = {file.path: call.search(code_only(file.text)) for file in self.files}
            self.only({path: match[0] for path, match in found.items() if match}, WRITING_EXEMPT[what])

    def test_a_part_file_asks_for_a_permit(self):
        text = next(file.text for file in self.files if file.path == "engine/record/run/part_file.hpp")
        self.assertIn("explicit PartFile(const Permit& permit);", text)
        self.assertNotIn("PartFile(std::string", text)

    def test_only_the_option_and_code_that_checks_the_files_itself_force(self):
        may = ("tools/program/output.cpp", "tools/program/command/run/resume.cpp")
        self.none(file.path for file in self.files if ".force = true" in file.text and file.path not in may)

    def test_the_scanner_sees_every_kind_of_call(self):
        for text in ("std::ofstream file(path);", "fopen(path, mode)", "open(path, O_WRONLY)", "H5Fcreate(a, b)", "std::tmpfile()"):
            self.assertRegex(text, CALLS["create"])
        for text in ("fs::remove_all(folder)", "std::rename(a, b)", "fs::rename(a, b)", "std::filesystem::remove(a)", "unlink(a)"):
            self.assertRegex(text, CALLS["remove"])
        self.assertNotRegex("std::ifstream file(path);", CALLS["create"])


# Names of unnamed namespaces differ from those that headers declare in the same namespace. Sources are compiled in groups, where a file's
# local name would silently take the place of a header's in the files behind it.

TYPE = re.compile(r"^(?:struct|class|enum class|enum) (\w+) .*\{ *$|^using (\w+) =")
VALUE = re.compile(r"^(?:\[\[\w+\]\] )?(?:(?:inline|static|constexpr|const) )*[\w:<>,&* \[\]]+?[ &*](\w+)(?:\[[^\]]*\])?(?: = |\(|\{|;)")
OTHER = re.compile(r"^(?:namespace|template|TEST|TYPED_TEST|INSTANTIATE|friend|public|private|return|using|struct|class|enum)\b")


def declared(line):
    """Names that a line at the left margin declares."""
    if found := TYPE.search(line):
        return [found[1] or found[2]]
    if OTHER.search(line) or not (found := VALUE.search(line)):
        return []
    return [found[1]] + ([] if "(" in line else re.findall(r", (\w+) = ", line))  # in brackets they are parameters


def names_of(text):
    """Names with their namespaces, "cvtflow::tasks::min_slip": of unnamed namespaces, and of others."""
    local, shared, outer, unnamed, in_body = set(), set(), "", False, False
    for line in code_only(text).split("\n"):
        if in_body and line.startswith("}"):
            in_body = False
        elif found := re.search(r"^namespace ([\w:]+) \{", line):
            outer = found[1]
        elif line.startswith("namespace {"):
            unnamed = True
        elif line.startswith("}"):
            unnamed = False
        elif not in_body and line and line[0] != " ":
            (local if unnamed else shared).update(f"{outer}::{name}" for name in declared(line))
        if line.strip() and line[0] != " " and not line.startswith("namespace"):
            in_body = in_body or line.rstrip().endswith("{")
    return local, shared


class LocalNames(Rules):
    def test_differ_from_those_of_headers(self):
        shared = collections.defaultdict(set)  # headers by name
        for file in source_files():
            for name in names_of(file.text)[1] if file.header else ():
                shared[name].add(file.path)
        self.assertGreater(len(shared), 1000, "the scanner finds what headers declare")
        self.none(f"{file.path}: {name} is also declared by {min(shared[name])}" for file in source_files() if not file.header
                  for name in names_of(file.text)[0] if shared.get(name) and file.path[:-3] + "hpp" not in shared[name])

    def test_are_found(self):
        local, shared = names_of(
            "namespace cvtflow::tasks {\nnamespace {\nconstexpr double least = 1.0, most = 2.0;\nstruct Row {\n    int inner = 0;\n};\n"
            "double median(std::vector<double> values) {\n    return values[0];\n}\nusing Json = json;\n}  // namespace\n"
            "inline constexpr double shared = 1.0;\n[[nodiscard]] std::string text_of(int value);\nclass Run;\n}  // namespace "
            "cvtflow::tasks\n")
        self.assertEqual(local, {"cvtflow::tasks::" + name for name in ("least", "most", "Row", "median", "Json")})
        self.assertEqual(shared, {"cvtflow::tasks::shared", "cvtflow::tasks::text_of"})


class OwnSource(Rules):
    """Functions that a header declares are defined in sources of its folder, or of folders below it. Public headers (api/include) apart,
    which the sources of api implement."""

    def test_functions_of_a_header_are_defined_in_its_folder_or_below(self):
        defined, seen, wrong = collections.defaultdict(set), 0, []  # folders by part and name
        for file in source_files():
            if not file.header and file.part not in ("tests", "examples"):
                for name, has_body in named_functions(file.text):
                    defined[file.part, name].update({file.folder + "/"} if has_body else ())
        for file in source_files():
            if not file.header or file.path.startswith("api/include/"):
                continue
            for name, has_body in named_functions(file.text):
                folders = () if has_body else defined.get((file.part, name), ())
                seen += bool(folders)
                if folders and not any(folder.startswith(file.folder + "/") for folder in folders):
                    wrong.append(f"{file.path} declares {name}, which {min(folders)} defines")
        self.none(wrong)
        self.assertGreater(seen, 1000)  # a scanner that sees nothing finds nothing

    def test_the_scanner_sees_declarations_and_definitions(self):
        found = named_functions(
            "namespace a {\n[[nodiscard]] std::vector<int> free_one(int x = 3);\nstruct B {\n    explicit B(int x);\n"
            "    virtual void pure() = 0;\n    void (*pointer)(int);\n    std::function<void(int)> callable;\n"
            "    [[nodiscard]] int inside() const { return f(1); }\n    int number = g(2);\n};\nnamespace {\nvoid hidden() {}\n}\n"
            "static void local() {}\ntemplate <class T> void generic(T);\nint B::outside(int) const { if (true) { call(); } return 0; "
            "}\n}\n")
        self.assertEqual(found, [("free_one", False), ("B::B", False), ("B::inside", True), ("B::outside", True)])


if __name__ == "__main__":
    main()
