/// Gates on size: files of 500 lines, functions of 40, classes of 20 methods, lines of 140 characters; and the scanner that measures
/// functions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <sstream>
#include <string>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int max_file_lines = 500;
constexpr int max_function_lines = 40;
constexpr int max_methods = 20;
constexpr std::ptrdiff_t most_columns = 140;

/// The only files with longer functions, which are tables: path and what is tabulated.
const std::map<std::string, std::string> tables{
    {"tasks/scene/parameter_table.cpp", "one row per parameter"},
};

/// Classes of more methods, and how many: only the interface of hosts, which a division would break. Numbers may only shrink.
const std::map<std::string, int> large_classes{
    {"api/include/cvtflow/simulation.hpp: Simulation", 27},
};

TEST(Size, FilesAreShort) {
    for (const SourceFile& file : source_files()) EXPECT_LE(line_count(file.text), max_file_lines) << file.path;
}

TEST(Size, FunctionsAreShort) {
    for (const SourceFile& file : source_files()) {
        if (tables.contains(file.path)) continue;
        for (const FunctionBody& function : functions_of(file.text)) {
            EXPECT_LE(function.lines, max_function_lines) << file.path << ":" << function.line << ": " << function.head;
        }
    }
}

TEST(Size, ClassesHaveFewMethods) {
    std::map<std::string, int> large;
    for (const SourceFile& file : source_files()) {
        for (const ClassSize& each : classes_of(file.text)) {
            if (each.methods > max_methods) large[file.path + ": " + each.name] = each.methods;
        }
    }
    EXPECT_EQ(large, large_classes) << "a class of more than " << max_methods
                                    << " methods has several subjects: divide it; where one has shrunk, write its number into the table";
}

TEST(Size, TheScannerCountsMethods) {
    const auto classes = classes_of(R"(
        namespace a {
        template <class Number>
        class alignas(64) Sum final : public Base<Number> {
        public:
            explicit Sum(int size) : size_(size) {}
            Sum(const Sum&) = delete;
            ~Sum();
            Sum& operator=(const Sum&) = delete;
            [[nodiscard]] int size() const noexcept { return size_; }
            template <class Other>
            void add(const Other& other);
            static double zero();
            virtual void done() = 0;
            struct Part {
                std::vector<int> numbers = std::vector<int>(3);
                void clear() { numbers.clear(); }
            };
            using Call = void(int);
            enum class Kind { small, large };

        private:
            int size_ = first(0);
            double share_{1.0};
        };
        int first(int);
        })");
    ASSERT_EQ(classes.size(), 2u);
    EXPECT_EQ(classes[0].name, "Sum");
    EXPECT_EQ(classes[0].methods, 4) << "size, add, zero, done";
    EXPECT_EQ(classes[0].line, 4);
    EXPECT_EQ(classes[1].name, "Part");
    EXPECT_EQ(classes[1].methods, 1);
}

/// The formatter breaks no text in quotes.
TEST(Size, LinesAreShort) {
    for (const SourceFile& file : source_files()) {
        std::istringstream lines(file.text);
        int number = 0;
        for (std::string line; std::getline(lines, line);) {
            ++number;
            const auto characters = std::count_if(line.begin(), line.end(), [](char byte) { return (byte & 0xC0) != 0x80; });  // UTF-8
            EXPECT_LE(characters, most_columns) << file.path << ":" << number;
        }
    }
}

TEST(Size, ExemptionsAreNeeded) {
    for (const SourceFile& file : source_files()) {
        if (!tables.contains(file.path)) continue;
        const auto functions = functions_of(file.text);
        const bool needed =
            std::any_of(functions.begin(), functions.end(), [](const FunctionBody& each) { return each.lines > max_function_lines; });
        EXPECT_TRUE(needed) << file.path << " has no long function any more: take it off the list";
    }
}

TEST(Size, TheScannerSeesTheCode) {
    std::size_t functions = 0;
    for (const SourceFile& file : source_files()) functions += functions_of(file.text).size();
    EXPECT_GT(functions, 100u);
}

std::vector<int> lengths(const std::string& text) {
    std::vector<int> result;
    for (const FunctionBody& body : functions_of(text)) result.push_back(body.lines);
    return result;
}

TEST(FunctionScanner, MeasuresFromTheHeadToTheClosingBrace) {
    EXPECT_THAT(lengths("int f() { return 1; }\n"), ElementsAre(1));
    EXPECT_THAT(lengths("int f(int a,\n      int b) {\n    if (a) {\n        b = 1;\n    }\n    return b;\n}\n"), ElementsAre(7));
}

TEST(FunctionScanner, SearchesNamespacesAndTypesButNotFunctions) {
    EXPECT_THAT(
        lengths("namespace a::b {\nnamespace {\nstruct S : T {\n int f() { return 1; }\n};\n}\nvoid g() {\n auto h = [] {\n };\n}\n}\n"),
        ElementsAre(1, 4));
    EXPECT_THAT(lengths("extern \"C\" {\nvoid f() {\n}\n}\n"), ElementsAre(2));
    EXPECT_THAT(lengths("template <class T>\nclass C {\n    C() : a_(1) {\n    }\n};\n"), ElementsAre(2));
    EXPECT_THAT(lengths("template <int W>\nrequires(W < 0) struct S<W> {\n    int f() { return 1; }\n};\n"), ElementsAre(1));
}

TEST(FunctionScanner, TablesAreNotFunctions) {
    EXPECT_THAT(lengths("const int a[] = {\n1,\n2};\nconstexpr std::array b{\n1,\n2};\nenum class E {\nx,\ny };\n"), IsEmpty());
}

TEST(FunctionScanner, CommentsLiteralsAndDirectivesCountForNothing) {
    EXPECT_THAT(lengths("// f() {\n/* g() { */\n#define H() {\nvoid k() { s = \"{\\\"\"; c = '{'; n = 1'000; }\n"), ElementsAre(1));
    EXPECT_THAT(lengths("void k() { s = R\"x({ \" )x\"; }\nvoid l() {\n}\n"), ElementsAre(1, 2));
}

TEST(FunctionScanner, FindsIncludes) {
    const std::vector<Include> includes = includes_of("#include <vector>\n  #  include \"model/x.hpp\"  // why\n// #include <no>\n");
    ASSERT_EQ(includes.size(), 2u);
    EXPECT_EQ(includes[0].name, "vector");
    EXPECT_FALSE(includes[0].quoted);
    EXPECT_EQ(includes[1].name, "model/x.hpp");
    EXPECT_EQ(includes[1].line, 2);
}

}  // namespace
}  // namespace cvtflow::architecture
