"""Gates on size: files of 500 lines, functions of 40, classes of 20 methods with those of their bases, lines of 140 characters; and the
scanner that measures functions."""

import collections
import os
import re
import textwrap

from source_tree import Include, Rules, SourceFile, classes_of, functions_of, includes_of, main, source_files

MAX_FILE_LINES, MAX_FUNCTION_LINES, MAX_METHODS, MAX_COLUMNS = 500, 40, 20, 140

# The only files with longer functions, which are tables, and what is tabulated.
TABLES = {"tasks/scene/parameter_table.cpp": "one row per parameter"}

# Classes of more methods, those of their bases included, and how many. Numbers may only shrink. Simulation is the interface of hosts, which
# a division would break; the others are to be composed of members.
LARGE_CLASSES = {
    "api/include/cvtflow/simulation.hpp: Simulation": 27,
    "bench/method/implicit/implicit_method.hpp: ImplicitMethod": 32,
    "bench/method/implicit/linear_method.hpp: LinearMethod": 38,
    "bench/method/implicit/trapezoidal.hpp: TrapezoidalMethod": 58,
    "bench/method/implicit/trapezoidal.hpp: TrapezoidalRule": 44,
    "tasks/method/friction/rigid_leapfrog.hpp: RigidLeapfrog": 25,
}

# Functions with more than one `if constexpr`, and how many; overloads replace them. Numbers may only shrink.
CHOICES_BY_TYPE = {"model/basis/lanes.hpp: sums": 3}


def large_classes(files):
    """Classes with more than MAX_METHODS; a method that is declared again in a derived class counts once."""
    places = collections.defaultdict(list)  # by name
    for file in files:
        for each in classes_of(file.text):
            places[each.name].append((file.path, each))

    def nearest(name, path):
        """The class of that name, of several the first whose path has most folders in common; None: of a library."""
        return max(places[name], key=lambda place: os.path.commonprefix([place[0], path]).count("/")) if name in places else None

    def methods(path, each):
        found = []
        fixture = path.startswith("tests/")  # inherits what its tests share
        for base in [] if fixture else each.bases:
            if base != each.name and (place := nearest(base, path)):
                found += methods(*place)
        return found + [name for name in each.methods if name not in set(found)]

    counts = {f"{path}: {name}": len(methods(path, each)) for name, all_of in places.items() for path, each in all_of}
    return {place: count for place, count in counts.items() if count > MAX_METHODS}


class Size(Rules):
    def test_files_are_short(self):
        self.none(file.path for file in source_files() if len(file.text.splitlines()) > MAX_FILE_LINES)

    def test_functions_are_short_but_for_exemptions_that_are_needed(self):
        seen, long = 0, collections.defaultdict(list)
        for file in source_files():
            functions = functions_of(file.text)
            seen += len(functions)
            for each in functions:
                if each.lines > MAX_FUNCTION_LINES:
                    long[file.path].append(f"{file.path}:{each.line}: {each.head}")
        self.none(place for path, places in long.items() if path not in TABLES for place in places)
        self.none(path for path in TABLES if path not in long)
        self.assertGreater(seen, 5000, "the scanner sees the code")

    def test_functions_choose_by_type_once(self):
        several = collections.Counter()
        for file in source_files():
            for each in functions_of(file.text) if file.part in ("model", "tasks") else []:
                count = len(re.findall(r"\bif constexpr\b", each.body))
                if count > 1 and (name := re.search(r"(\w+) ?\(", each.head)):
                    several[f"{file.path}: {name[1]}"] += count
        self.assertEqual(several, CHOICES_BY_TYPE)

    def test_classes_with_their_bases_have_few_methods(self):
        self.assertEqual(large_classes(source_files()), LARGE_CLASSES,
                         f"an object of more than {MAX_METHODS} methods has several subjects: compose it of members; where one has shrunk, "
                         "write its number into the table")

    def test_lines_are_short(self):
        """The formatter breaks no text in quotes."""
        self.none(f"{file.path}:{number}" for file in source_files() for number, line in enumerate(file.text.split("\n"), 1)
                  if len(line) > MAX_COLUMNS)


class ClassScanner(Rules):
    def test_methods_of_bases_count_once(self):
        many = "".join(f"void f{k}();" for k in range(11))
        base, other = SourceFile("a/b/base.hpp", f"struct Base {{{many}}};"), SourceFile("c/base.hpp", "struct Base {};")

        def derived(members):
            head = "template <class T> class Derived final : private n::Base<std::map<T, int>> "
            return SourceFile("a/derived.hpp", f"{head}{{{members}}};")

        further = many.replace("f", "g")
        self.assertEqual(large_classes([base, other, derived(many)]), {}, "all override")
        self.assertEqual(large_classes([base, other, derived(further)]), {"a/derived.hpp: Derived": 22})
        self.assertEqual(large_classes([other, derived(further)]), {})

    def test_finds_methods_and_bases(self):
        total, part = classes_of(textwrap.dedent("""
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
            }"""))
        self.assertEqual((total.name, total.line, total.bases, total.methods), ("Sum", 4, ["Base"], ["size", "add", "zero", "done"]))
        self.assertEqual((part.name, part.methods), ("Part", ["clear"]))


class FunctionScanner(Rules):
    def test_measures_from_the_head_to_the_closing_brace_outside_other_functions_and_tables(self):
        for text, lengths in (
                ("int f() { return 1; }\n", [1]),
                ("int f(int a,\n      int b) {\n    if (a) {\n        b = 1;\n    }\n    return b;\n}\n", [7]),
                ("namespace a::b {\nnamespace {\nstruct S : T {\n int f() { return 1; }\n};\n}\nvoid g() {\n auto h = [] {\n };\n}\n}\n",
                 [1, 4]),
                ('extern "C" {\nvoid f() {\n}\n}\n', [2]),
                ("template <class T>\nclass C {\n    C() : a_(1) {\n    }\n};\n", [2]),
                ("template <int W>\nrequires(W < 0) struct S<W> {\n    int f() { return 1; }\n};\n", [1]),
                ("const int a[] = {\n1,\n2};\nconstexpr std::array b{\n1,\n2};\nenum class E {\nx,\ny };\n", []),  # tables
                # Comments, literals and directives count for nothing.
                ("// f() {\n/* g() { */\n#define H() {\nvoid k() { s = \"{\\\"\"; c = '{'; n = 1'000; }\n", [1]),
                ('void k() { s = R"x({ " )x"; }\nvoid l() {\n}\n', [1, 2])):
            self.assertEqual([each.lines for each in functions_of(text)], lengths, text)

    def test_finds_includes(self):
        self.assertEqual(includes_of('#include <vector>\n  #  include "model/x.hpp"  // why\n// #include <no>\n'),
                         [Include(1, "vector", False), Include(2, "model/x.hpp", True)])


if __name__ == "__main__":
    main()
