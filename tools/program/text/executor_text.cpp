#include "tools/program/text/executor_text.hpp"

#include <fmt/format.h>

#include "engine/executor/catalogue.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

std::string executor_table() {
    Table table({{"executor"}, {"threads"}, {"description"}});
    for (const engine::ExecutorRow& row : engine::executors())
        table.add({std::string(row.name), row.parallel ? "many" : "one", std::string(row.description)});
    return table.text();
}

std::string absent_executor_text() {
    std::string absent;
    for (const engine::ExecutorRow& row : engine::absent_executors())
        absent += fmt::format("  {:<12}{}\n  {:<12}requires {}\n", row.name, row.description, "", row.needs);
    return absent.empty() ? "" : "\nNot in this program:\n" + absent;
}

}  // namespace cvtflow::tools
