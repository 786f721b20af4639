/// DeclaredNames of unnamed namespaces differ from those that headers declare in the same namespace. Sources are compiled in groups, where
/// a file's local name would silently take the place of a header's in the files behind it.

#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

/// With their namespaces: "cvtflow::tasks::min_slip".
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
            for (const std::string& name : declared(line)) (unnamed ? names.local : names.shared).insert(outer + "::" + name);
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
        const std::string own = file.path.substr(0, file.path.rfind('.')) + ".hpp";
        for (const std::string& name : names_of(file.text).local) {
            const auto found = shared.find(name);
            if (found == shared.end() || found->second.contains(own)) continue;
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

}  // namespace
}  // namespace cvtflow::architecture
