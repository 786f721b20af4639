/// No file is written or removed around the rule for files (engine/record/run/output_rule.hpp).

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

/// Calls that create, empty, rename or remove files.
const std::map<std::string, std::regex> calls{
    {"create", std::regex(R"(\b(std::(o|basic_o)?fstream\b(?! ?&)|std::ofstream|f(re)?open|tmpfile|mkstemp|mkdtemp|creat)\b ?[({]?|)"
                          R"(\bO_(WRONLY|RDWR|CREAT|TRUNC)\b|\bH5Fcreate\b|\bH5F_ACC_(RDWR|TRUNC|EXCL)\b)")},
    {"remove",
     std::regex(
         R"(\b(remove_all|copy_file|renameat2?|unlink(at)?|rmdir)\b ?\(|\b(fs|filesystem)::(rename|remove|copy)\(|\bstd::rename\()")},
};

/// Who may, and why. Everybody else writes through engine::Permit: write_whole, write_state, write_cases, CaseWriter, RunFile.
const std::map<std::string, std::map<std::string, std::string>> exempt{
    {"create",
     {{"engine/record/run/part_file.cpp", "the one writer: FILE.part, which asks for a Permit"},
      {"engine/record/run/output_rule.cpp", "the rule itself: devices and pipes"},
      {"engine/record/run/run_layout.cpp", "HDF5 on the .part that a PartFile holds"},
      {"engine/record/run/run_file.cpp", "HDF5 on the .part that a PartFile holds"},
      {"engine/record/run/state_file.cpp", "HDF5 in memory"},
      {"engine/record/case_table.cpp", "HDF5 on the .part that a PartFile holds; the empty lock of a folder"},
      {"tools/program/guard.cpp", "/dev/null"},
      {"tools/program/command/record/plot.cpp", "temporary files without a name"}}},
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

}  // namespace
}  // namespace cvtflow::architecture
