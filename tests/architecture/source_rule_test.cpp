/// Rules that no compiler checks: numbers without a locale, files written through the rule for files, local names unlike those of headers,
/// functions defined where their header is.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

// Numbers are read and written with a decimal point, whatever the locale of the host: std::from_chars (engine/base/text.hpp) and fmt.

/// Calls that follow the locale of C or C++.
const std::regex locale_calls(R"(\b(strto(d|f|ld)|atof|sto(d|f|ld)|[a-z]*printf|[a-z]*scanf|setlocale|localeconv)\b ?\()"
                              R"(|\b(basic_)?o?stringstream\b|\bstd::locale\(|\blocale::global\b|\bput_time\b)");
const std::regex stream(R"(\b(std::)?(ifstream|istringstream|istream)\b)"), extraction(R"([\w)] >> [a-z]\w*)"), grouped(R"(\{:[^{}"]*L\})");

/// Files that may, and the reason.
const std::map<std::string, std::string> locale_exempt{
    {"tasks/scene/ready_scenes.cpp", "addresses in hexadecimal"},
    {"tasks/batch/sweep/scalar.cpp", "words"},
    {"tasks/schedule/schedule.cpp", "words, which number_of reads"},
    {"engine/record/hdf5/hdf5_open.cpp", "a word, which number_of reads"},
    {"tools/cmake/web/missing.hpp", "functions that a browser's library lacks: it has the C locale alone"},
};

/// Whether a file's code runs in a host's process or writes files. Other benchmarks are programs that leave the locale as it is: "C".
bool reads_numbers(const SourceFile& file) {
    static const std::set<std::string> parts{"engine", "model", "tasks", "api", "tools"};
    return parts.contains(file.part()) || file.path.starts_with("bench/lab/") || file.path.starts_with("bench/study/");
}

/// Call that follows the locale, or "".
std::string localised(const std::string& text) {
    const std::string code = code_only(text);
    std::smatch found;
    if (std::regex_search(code, found, locale_calls)) return found.str();
    const bool read = std::regex_search(code, stream) && code.find(".imbue(") == std::string::npos;
    if (read && std::regex_search(code, found, extraction)) return found.str();
    return std::regex_search(text, grouped) ? "{:L}" : "";
}

TEST(NumberText, FollowsNoLocale) {
    std::set<std::string> used;
    for (const SourceFile& file : source_files()) {
        if (!reads_numbers(file)) continue;
        const std::string found = localised(file.text);
        if (found.empty()) continue;
        used.insert(file.path);
        EXPECT_TRUE(locale_exempt.contains(file.path))
            << file.path << ": '" << found << "' follows the locale: use engine::number_of and fmt";
    }
    for (const auto& [path, reason] : locale_exempt) EXPECT_TRUE(used.contains(path)) << path << " is exempt and need not be: " << reason;
}

TEST(NumberText, TheScannerFindsEveryKindOfCall) {
    for (const char* text :
         {"x = std::strtod(a, b);", "x = atof(a);", "x = std::stod(a);", "std::snprintf(a, n, f, x);", "printf(f, x);",
          "std::ostringstream text;", "std::ifstream file(path);\ndouble x;\nfile >> x;", "std::sscanf(a, b)", "fmt::format(\"{:L}\", n)"})
        EXPECT_NE(localised(text), "") << text;
    for (const char* text : {"std::strtoul(a, b, 10);", "fmt::print(f, x);", "std::istringstream a(b);\na.imbue(c);\na >> x;",
                             "x = y >> z;", "std::ifstream file(path);\nstd::getline(file, line);"})
        EXPECT_EQ(localised(text), "") << text;
}

// No file is written or removed around the rule for files (engine/record/run/output_rule.hpp).

/// Calls that create, empty, rename or remove files.
const std::map<std::string, std::regex> calls{
    {"create", std::regex(R"(\b(std::(o|basic_o)?fstream\b(?! ?&)|std::ofstream|f(re)?open|tmpfile|mkstemp|mkdtemp|creat)\b ?[({]?|)"
                          R"(\bO_(WRONLY|RDWR|CREAT|TRUNC)\b|\bH5Fcreate\b|\bH5F_ACC_(RDWR|TRUNC|EXCL)\b)")},
    {"remove",
     std::regex(
         R"(\b(remove_all|copy_file|renameat2?|unlink(at)?|rmdir)\b ?\(|\b(fs|filesystem)::(rename|remove|copy)\(|\bstd::rename\()")},
};

/// Files that may, and the reason. All others write through engine::Permit: write_whole, write_state, write_cases, CaseWriter, RunFile.
const std::map<std::string, std::map<std::string, std::string>> exempt{
    {"create",
     {{"engine/record/run/part_file.cpp", "the one writer: FILE.part, which asks for a Permit"},
      {"engine/record/run/output_rule.cpp", "the rule itself: devices and pipes"},
      {"engine/record/run/run_layout.cpp", "HDF5 on the .part that a PartFile holds"},
      {"engine/record/run/run_file.cpp", "HDF5 on the .part that a PartFile holds"},
      {"engine/record/run/state_file.cpp", "HDF5 in memory"},
      {"engine/record/case_table.cpp", "HDF5 on the .part that a PartFile holds; the empty lock of a folder"},
      {"tools/program/guard.cpp", "/dev/null"}}},
    {"remove",
     {{"engine/record/run/part_file.cpp", "its .part; the former record of a run that is resumed"},
      {"engine/record/run/output_rule.cpp", "the rule itself: files of a writer, by name"},
      {"tasks/run/checkpoint.cpp", "a checkpoint, and its .part"},
      {"tasks/run/run_recorder.cpp", "the former record of a run that was resumed"},
      {"tasks/batch/batch.cpp", "an empty folder"},
      {"tasks/batch/case_checkpoint.cpp", "the former record of a case that begins anew"},
      {"tools/program/view/vtk_series.cpp", "what it has just written"}}},
};

/// Parts whose files are users' files. The laboratory and tests are not.
bool concerned(const SourceFile& file) {
    static const std::set<std::string> parts{"engine", "model", "tasks", "api"};
    return parts.contains(file.part()) || file.path.starts_with("tools/program/");
}

TEST(OutputRule, NoSourceWritesOrRemovesFilesAroundIt) {
    for (const auto& [what, call] : calls) {
        std::set<std::string> used;
        for (const SourceFile& file : source_files()) {
            if (!concerned(file)) continue;
            const std::string code = code_only(file.text);
            std::smatch found;
            if (!std::regex_search(code, found, call)) continue;
            used.insert(file.path);
            EXPECT_TRUE(exempt.at(what).contains(file.path)) << file.path << ": '" << found.str() << "': write through engine::Permit";
        }
        for (const auto& [path, reason] : exempt.at(what))
            EXPECT_TRUE(used.contains(path)) << path << " is exempt and need not be: " << reason;
    }
}

TEST(OutputRule, APartFileAsksForAPermit) {
    for (const SourceFile& file : source_files()) {
        if (file.path == "engine/record/run/part_file.hpp") {
            EXPECT_NE(file.text.find("explicit PartFile(const Permit& permit);"), std::string::npos);
            EXPECT_EQ(file.text.find("PartFile(std::string"), std::string::npos);
        }
    }
}

/// Only --force, and code that checks the files itself, may set it.
TEST(OutputRule, OnlyTheOptionForces) {
    const std::set<std::string> may{"tools/program/output.cpp", "tools/program/command/run/resume.cpp"};
    for (const SourceFile& file : source_files()) {
        if (!concerned(file) || file.text.find(".force = true") == std::string::npos) continue;
        EXPECT_TRUE(may.contains(file.path)) << file.path;
    }
}

TEST(OutputRule, TheScannerSeesEveryKindOfCall) {
    for (const char* text : {"std::ofstream file(path);", "fopen(path, mode)", "open(path, O_WRONLY)", "H5Fcreate(a, b)", "std::tmpfile()"})
        EXPECT_TRUE(std::regex_search(text, calls.at("create"))) << text;
    for (const char* text : {"fs::remove_all(folder)", "std::rename(a, b)", "fs::rename(a, b)", "std::filesystem::remove(a)", "unlink(a)"})
        EXPECT_TRUE(std::regex_search(text, calls.at("remove"))) << text;
    EXPECT_FALSE(std::regex_search("std::ifstream file(path);", calls.at("create")));
}

// DeclaredNames of unnamed namespaces differ from those that headers declare in the same namespace. Sources are compiled in groups, where
// a file's local name would silently take the place of a header's in the files behind it.

/// Names with their namespaces: "cvtflow::tasks::min_slip".
struct DeclaredNames {
    std::set<std::string> local, shared;
};

/// DeclaredNames that a line at the left margin declares.
std::set<std::string> declared(const std::string& line) {
    static const std::regex type(R"(^(?:struct|class|enum class|enum) (\w+) .*\{ *$|^using (\w+) =)"), further(R"(, (\w+) = )");
    static const std::regex value(
        R"(^(?:\[\[\w+\]\] )?(?:(?:inline|static|constexpr|const) )*[\w:<>,&* \[\]]+?[ &*](\w+)(?:\[[^\]]*\])?(?: = |\(|\{|;))");
    static const std::regex other(
        R"(^(?:namespace|template|TEST|TYPED_TEST|INSTANTIATE|friend|public|private|return|using|struct|class|enum)\b)");
    std::smatch found;
    if (std::regex_search(line, found, type)) return {found[1].matched ? found[1] : found[2]};
    if (std::regex_search(line, other) || !std::regex_search(line, found, value)) return {};
    std::set<std::string> names{found[1]};
    if (line.find('(') != std::string::npos) return names;  // of parameters
    for (std::sregex_iterator each(line.begin(), line.end(), further); each != std::sregex_iterator(); ++each) names.insert((*each)[1]);
    return names;
}

DeclaredNames names_of(const std::string& text) {
    static const std::regex opens(R"(^namespace ([\w:]+) \{)");
    DeclaredNames names;
    std::istringstream lines(code_only(text));
    std::string outer;
    bool unnamed = false, in_body = false;
    for (std::string line; std::getline(lines, line);) {
        std::smatch found;
        const bool body_ends = in_body && (line.starts_with("}") || line.starts_with("};"));
        if (body_ends) {
            in_body = false;
        } else if (std::regex_search(line, found, opens)) {
            outer = found[1];
        } else if (line.starts_with("namespace {")) {
            unnamed = true;
        } else if (line.starts_with("}")) {
            unnamed = false;
        } else if (!in_body && !line.empty() && line.front() != ' ') {
            for (const std::string& name : declared(line))
                (unnamed ? names.local : names.shared).insert(fmt::format("{}::{}", outer, name));
        }
        if (!line.empty() && line.front() != ' ' && !line.starts_with("namespace") && line.find_last_not_of(' ') != std::string::npos)
            in_body = in_body || line[line.find_last_not_of(' ')] == '{';
    }
    return names;
}

TEST(LocalNames, DifferFromThoseOfHeaders) {
    std::map<std::string, std::set<std::string>> shared;  // name, headers
    for (const SourceFile& file : source_files())
        if (file.header())
            for (const std::string& name : names_of(file.text).shared) shared[name].insert(file.path);
    EXPECT_GT(shared.size(), 1000u) << "the scanner finds what headers declare";
    for (const SourceFile& file : source_files()) {
        if (file.header()) continue;
        const std::string same_name = file.path.substr(0, file.path.rfind('.')) + ".hpp";
        for (const std::string& name : names_of(file.text).local) {
            const auto found = shared.find(name);
            if (found == shared.end() || found->second.contains(same_name)) continue;
            ADD_FAILURE() << file.path << ": " << name << " is also declared by " << *found->second.begin();
        }
    }
}

TEST(LocalNames, AreFound) {
    const DeclaredNames names = names_of(
        "namespace cvtflow::tasks {\nnamespace {\nconstexpr double least = 1.0, most = 2.0;\nstruct Row {\n    int inner = 0;\n};\n"
        "double median(std::vector<double> values) {\n    return values[0];\n}\nusing Json = json;\n}  // namespace\n"
        "inline constexpr double shared = 1.0;\n[[nodiscard]] std::string text_of(int value);\nclass Run;\n}  // namespace "
        "cvtflow::tasks\n");
    EXPECT_EQ(names.local, (std::set<std::string>{"cvtflow::tasks::least", "cvtflow::tasks::most", "cvtflow::tasks::Row",
                                                  "cvtflow::tasks::median", "cvtflow::tasks::Json"}));
    EXPECT_EQ(names.shared, (std::set<std::string>{"cvtflow::tasks::shared", "cvtflow::tasks::text_of"}));
}

// A header is implemented where it is: functions that it declares are defined in sources of its folder, or of folders below it. Public
// headers (api/include) apart, which the sources of api implement.

/// Folders of the sources that define a function, by part and name.
using Definitions = std::map<std::pair<std::string, std::string>, std::set<std::string>>;

Definitions definitions(const std::vector<SourceFile>& files) {
    Definitions folders;
    for (const SourceFile& file : files) {
        if (file.header() || file.part() == "tests" || file.part() == "examples") continue;
        for (const NamedFunction& function : named_functions(file.text)) {
            if (function.defined) folders[{file.part(), function.name}].insert(file.folder() + "/");
        }
    }
    return folders;
}

bool any_below(const std::set<std::string>& folders, const std::string& folder) {
    const auto found = folders.lower_bound(folder + "/");
    return found != folders.end() && found->starts_with(folder + "/");
}

TEST(OwnSource, FunctionsOfAHeaderAreDefinedInItsFolderOrBelow) {
    const std::vector<SourceFile> files = source_files();
    const Definitions defined = definitions(files);
    int seen = 0;
    for (const SourceFile& file : files) {
        if (!file.header() || file.path.starts_with("api/include/")) continue;
        for (const NamedFunction& function : named_functions(file.text)) {
            const auto found = defined.find({file.part(), function.name});
            if (function.defined || found == defined.end()) continue;
            ++seen;
            EXPECT_TRUE(any_below(found->second, file.folder()))
                << file.path << " declares " << function.name << ", which " << *found->second.begin() << " defines";
        }
    }
    EXPECT_GT(seen, 1000);  // a scanner that sees nothing finds nothing
}

TEST(OwnSource, TheScannerSeesDeclarationsAndDefinitions) {
    const std::string text =
        "namespace a {\n"
        "[[nodiscard]] std::vector<int> free_one(int x = 3);\n"
        "struct B {\n"
        "    explicit B(int x);\n"
        "    virtual void pure() = 0;\n"
        "    void (*pointer)(int);\n"
        "    std::function<void(int)> callable;\n"
        "    [[nodiscard]] int inside() const { return f(1); }\n"
        "    int number = g(2);\n"
        "};\n"
        "namespace {\n"
        "void hidden() {}\n"
        "}\n"
        "static void local() {}\n"
        "template <class T> void generic(T);\n"
        "int B::outside(int) const { if (true) { call(); } return 0; }\n"
        "}\n";
    std::vector<std::string> declared, defined;
    for (const NamedFunction& function : named_functions(text)) (function.defined ? defined : declared).push_back(function.name);
    EXPECT_EQ(declared, (std::vector<std::string>{"free_one", "B::B"}));
    EXPECT_EQ(defined, (std::vector<std::string>{"B::inside", "B::outside"}));
}

}  // namespace
}  // namespace cvtflow::architecture
