/// The kernels are compiled once per instruction set. A function that two of these copies define under one name is shared by the linker,
/// which may then put AVX-512 code where the baseline's is meant: on an older processor that is an illegal instruction, on none a test
/// fails. So no object file of the kernels may define a symbol that the linker merges.

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "model/kernels/kernels.hpp"
#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

/// Letter of nm and name.
struct Symbol {
    char kind;
    std::string name;
};

/// Symbols that an object file defines.
std::vector<Symbol> symbols_of(const std::string& object) {
    std::vector<Symbol> symbols;
    std::istringstream listing(output_of(CVTFLOW_NM " -C --defined-only '" + object + "'"));
    for (std::string line; std::getline(listing, line);) {
        if (line.size() > 19) symbols.push_back({line[17], line.substr(19)});
    }
    return symbols;
}

/// Expects no symbol that the linker merges. @return how many functions the kernels below a folder of objects show
int entries_of(const char* objects) {
    int entries = 0;
    for (const auto& folder : std::filesystem::directory_iterator(objects)) {
        if (!folder.path().filename().string().starts_with("cvtflow_kernels_")) continue;
        for (const auto& file : std::filesystem::recursive_directory_iterator(folder.path())) {
            if (file.path().extension() != ".o") continue;
            for (const Symbol& symbol : symbols_of(file.path().string())) {
                entries += symbol.kind == 'T';
                if (symbol.name.starts_with("DW.ref.")) continue;  // the address of a run-time function, the same in every copy
                EXPECT_EQ(std::string("WVu").find(symbol.kind), std::string::npos) << file.path() << ": " << symbol.name;
            }
        }
    }
    return entries;
}

TEST(DeepKernelSymbols, NoneIsSharedBetweenInstructionSets) {
    EXPECT_GE(entries_of(CVTFLOW_OBJECTS_DIR), 5);         // native, chain, friction, single and rigid kernels of at least one
    EXPECT_GE(entries_of(CVTFLOW_STAGED_OBJECTS_DIR), 1);  // staged_kernels of the laboratory
}

/// A fused multiply-add here and not there would make bits depend on instruction sets and on how sources are grouped; GCC 12 makes some in
/// spite of -ffp-contract=off.
TEST(DeepKernelSymbols, NoMultiplyAddIsFusedInTheLibrary) {
    std::istringstream code(output_of(CVTFLOW_OBJDUMP " -d --no-show-raw-insn '" CVTFLOW_LIBRARY "'"));
    std::string function;
    long instructions = 0;
    for (std::string line; std::getline(code, line); ++instructions) {
        if (line.ends_with(">:")) function = line;
        EXPECT_EQ(line.find("\tvfm"), std::string::npos) << function << line;
        EXPECT_EQ(line.find("\tvfnm"), std::string::npos) << function << line;
    }
    EXPECT_GT(instructions, 100000);
}

}  // namespace
}  // namespace cvtflow::architecture
