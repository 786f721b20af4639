/// Gates on size: files of 500 lines, functions of 40, classes of 20 methods with those of their bases, lines of 140 characters; and the
/// scanner that measures functions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
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

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int max_file_lines = 500;
constexpr int max_function_lines = 40;
constexpr std::size_t max_methods = 20;
constexpr std::ptrdiff_t most_columns = 140;

/// The only files with longer functions, which are tables: path and what is tabulated.
const std::map<std::string, std::string> tables{
    {"tasks/scene/parameter_table.cpp", "one row per parameter"},
};

/// Classes of more methods, those of their bases included, and how many. Numbers may only shrink. Simulation is the interface of hosts,
/// which a division would break; the others are to be composed of members.
const std::map<std::string, std::size_t> large_classes{
    {"api/include/cvtflow/simulation.hpp: Simulation", 27},         {"bench/method/implicit/implicit_method.hpp: ImplicitMethod", 32},
    {"bench/method/implicit/linear_method.hpp: LinearMethod", 38},  {"bench/method/implicit/trapezoidal.hpp: TrapezoidalMethod", 58},
    {"bench/method/implicit/trapezoidal.hpp: TrapezoidalRule", 44}, {"tasks/method/friction/rigid_leapfrog.hpp: RigidLeapfrog", 26},
};

/// Functions with more than one `if constexpr`, and how many; overloads replace them. Numbers may only shrink.
const std::map<std::string, std::size_t> choices_by_type{{"model/basis/lanes.hpp: sums", 3}};

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

TEST(Size, FunctionsChooseByTypeOnce) {
    std::map<std::string, std::size_t> several;
    const std::regex choice(R"(\bif constexpr\b)"), name(R"((\w+) ?\()");
    for (const SourceFile& file : source_files()) {
        for (const FunctionBody& function : functions_of(file.text)) {
            const auto count = std::distance(std::sregex_iterator(function.body.begin(), function.body.end(), choice), {});
            std::smatch called;
            const bool counts = count > 1 && (file.part() == "model" || file.part() == "tasks");
            if (counts && std::regex_search(function.head, called, name)) several[file.path + ": " + called[1].str()] += std::size_t(count);
        }
    }
    EXPECT_EQ(several, choices_by_type);
}

/// Classes of all sources, to sum up methods along inheritance.
class Classes {
public:
    explicit Classes(const std::vector<SourceFile>& files) {
        for (const SourceFile& file : files)
            for (ClassSize& each : classes_of(file.text)) found_[each.name].push_back({file.path, std::move(each)});
    }

    /// Classes with more than max_methods.
    [[nodiscard]] std::map<std::string, std::size_t> large() const {
        std::map<std::string, std::size_t> large;
        for (const auto& [name, places] : found_) {
            for (const Place& place : places)
                if (const auto count = methods(place).size(); count > max_methods) large[place.path + ": " + name] = count;
        }
        return large;
    }

private:
    struct Place {
        std::string path;
        ClassSize size;
    };

    /// Methods of a class and its bases. One that is declared again in a derived class counts once.
    [[nodiscard]] std::vector<std::string> methods(const Place& place) const {
        std::vector<std::string> all;
        const bool fixture = place.path.starts_with("tests/");  // inherits what its tests share
        for (const std::string& base : fixture ? std::vector<std::string>() : place.size.bases)
            if (const Place* found = nearest(base, place)) std::ranges::copy(methods(*found), std::back_inserter(all));
        const std::set<std::string> inherited(all.begin(), all.end());
        std::ranges::copy_if(place.size.methods, std::back_inserter(all),
                             [&](const std::string& name) { return !inherited.contains(name); });
        return all;
    }

    /// The class of that name, of several the first whose path has most folders in common with that of the derived class; nullptr: of a
    /// library.
    [[nodiscard]] const Place* nearest(const std::string& name, const Place& derived) const {
        const auto places = found_.find(name);
        if (places == found_.end() || name == derived.size.name) return nullptr;
        const auto common = [&](const Place& each) {
            return std::count(each.path.begin(), std::ranges::mismatch(each.path, derived.path).in1, '/');
        };
        return &*std::ranges::max_element(places->second, {}, common);
    }

    std::map<std::string, std::vector<Place>> found_;
};

TEST(Size, ClassesWithTheirBasesHaveFewMethods) {
    EXPECT_EQ(Classes(source_files()).large(), large_classes)
        << "an object of more than " << max_methods
        << " methods has several subjects: compose it of members; where one has shrunk, write its number into the table";
}

TEST(Size, MethodsOfBasesCountOnce) {
    std::string many;
    for (int k = 0; k < 11; ++k) many += "void f" + std::to_string(k) + "();";
    const SourceFile base{"a/b/base.hpp", "struct Base {" + many + "};"}, other{"c/base.hpp", "struct Base {};"};
    const auto derived = [&](const std::string& members) {
        return SourceFile{"a/derived.hpp", "template <class T> class Derived final : private n::Base<std::map<T, int>> {" + members + "};"};
    };
    EXPECT_THAT(Classes({base, other, derived(many)}).large(), IsEmpty()) << "all override";
    std::string further = many;
    std::ranges::replace(further, 'f', 'g');
    EXPECT_THAT(Classes({base, other, derived(further)}).large(), ElementsAre(std::pair("a/derived.hpp: Derived", 22)));
    EXPECT_THAT(Classes({other, derived(further)}).large(), IsEmpty());
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
    EXPECT_THAT(classes[0].methods, ElementsAre("size", "add", "zero", "done"));
    EXPECT_THAT(classes[0].bases, ElementsAre("Base"));
    EXPECT_EQ(classes[0].line, 4);
    EXPECT_EQ(classes[1].name, "Part");
    EXPECT_THAT(classes[1].methods, ElementsAre("clear"));
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
