/// A header is implemented where it is: functions that it declares are defined in sources of its folder, or of folders below it. Public
/// headers (api/include) apart, which the sources of api implement.

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

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
