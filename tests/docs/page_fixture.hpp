#pragma once
/// Pages of the documents for tests: Markdown with fenced blocks, and comments above blocks that state how a block is used.

#include <filesystem>
#include <string>
#include <vector>

namespace cvtflow::docs {

/// A fenced block of a page.
struct Block {
    int line = 0;          ///< line number of the opening fence, from 1
    std::string language;  ///< "sh", "toml", "text" …
    std::string text;      ///< text between the fences, with the last line's end
    std::string file;      ///< name of the file that it is written to; empty: none
    std::string nightly;   ///< time that it takes, if longer than seconds; empty: it is quick
    std::string deep;      ///< suite that has its promise in quick runs, where it is left out; empty: it is in all
    std::string not_run;   ///< reason why it cannot run; empty: it can

    /// Whether it is run, as commands or as Python.
    [[nodiscard]] bool runs() const { return (language == "sh" || (language == "python" && file.empty())) && not_run.empty(); }
    /// Whether it needs full depth: by its comment, or for the laboratory.
    [[nodiscard]] bool is_deep() const {
        return !deep.empty() || text.find("cvtflow-lab") != text.npos || text.find("bench/") != text.npos;
    }
};

/// A line of a page outside blocks.
struct Line {
    int number = 0;  ///< line number, from 1
    std::string text;
};

struct Page {
    std::string path;  ///< relative to the top level, with slashes
    std::string text;

    [[nodiscard]] std::vector<Block> blocks() const;
    [[nodiscard]] std::vector<Line> text_lines() const;
    /// Targets of links and pictures, as written, without blocks and code.
    [[nodiscard]] std::vector<std::string> links() const;
    /// Names under which headings can be reached: lower case, punctuation left out, spaces as hyphens.
    [[nodiscard]] std::vector<std::string> anchors() const;
};

/// Text of a file; empty if it cannot be read.
[[nodiscard]] std::string text_of(const std::filesystem::path& path);

/// Every page that documents the project: *.md at the top level, in docs, model and tools; ascending by path.
[[nodiscard]] const std::vector<Page>& pages();

/// The page of that path. @throws std::invalid_argument if there is none
[[nodiscard]] Page page(const std::string& path);

/// Words in italics in the third column of a table `| word | means | not |`.
[[nodiscard]] std::vector<std::string> avoided_words(const Page& glossary);

}  // namespace cvtflow::docs
