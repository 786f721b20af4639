#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_tree_fixture.hpp"

namespace cvtflow::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

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
