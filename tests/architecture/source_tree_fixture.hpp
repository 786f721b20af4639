#pragma once
/// The source tree for the architecture tests.

#include <set>
#include <string>
#include <vector>

namespace cvtflow::architecture {

struct SourceFile {
    std::string path;  ///< relative to the top level, with slashes
    std::string text;

    [[nodiscard]] bool header() const { return path.ends_with(".hpp"); }
    /// Folder of the top level: "model", "engine" …
    [[nodiscard]] std::string part() const { return path.substr(0, path.find('/')); }
    /// Folder of the file: "engine/graph".
    [[nodiscard]] std::string folder() const { return path.substr(0, path.rfind('/')); }
};

struct Include {
    int line;          ///< line number, from 1
    std::string name;  ///< name between the quotes or brackets
    bool quoted;
};

/// A block that opens outside all functions: the body of a function or lambda at namespace or class scope.
struct FunctionBody {
    std::string head;  ///< first line
    int line;          ///< line number of the head, from 1
    int lines;         ///< number of lines from head to closing brace
    std::string body;  ///< text between the braces, without comments and literals
};

/// A function at namespace or class scope that other files may call.
struct NamedFunction {
    std::string name;  ///< "name", or "Class::name"
    bool defined;      ///< else it is declared only
};

/// A class, struct or union.
struct ClassSize {
    std::string name;
    int line;                          ///< line number of the head, from 1
    std::vector<std::string> bases;    ///< names, without namespaces and template arguments
    std::vector<std::string> methods;  ///< functions that it declares, of every access; not constructors, destructor, operators, and what
                                       ///< is deleted or defaulted
};

/// All .cpp and .hpp files below the source folders, ascending by path.
[[nodiscard]] std::vector<SourceFile> source_files();

/// Output of a command, empty if it fails.
[[nodiscard]] std::string output_of(const std::string& command);

/// Command that asks git about the sources, also where another user owns them.
inline const std::string git = "git -c safe.directory='*' -C '" CVTFLOW_SOURCE_DIR "' ";

/// Names on the top level that git tracks; empty where there is no git to ask.
[[nodiscard]] std::set<std::string> tracked_top_level();

[[nodiscard]] std::vector<Include> includes_of(const std::string& text);
[[nodiscard]] int line_count(const std::string& text);
/// The text with comments, literals and preprocessor lines blanked out; lines stay where they are.
[[nodiscard]] std::string code_only(const std::string& text);
[[nodiscard]] std::vector<FunctionBody> functions_of(const std::string& text);
/// Functions without templates, operators, and those that are static, pure, defaulted, deleted or in an unnamed namespace.
[[nodiscard]] std::vector<NamedFunction> named_functions(const std::string& text);
[[nodiscard]] std::vector<ClassSize> classes_of(const std::string& text);

}  // namespace cvtflow::architecture
