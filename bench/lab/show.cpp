#include "bench/lab/show.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bench/executor/further_executors.hpp"
#include "bench/study/compiler_flags.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/program/front.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/report_columns.hpp"

namespace cvtflow::bench {

Json named(std::string_view keys, std::initializer_list<Json> values) {
    Json object;
    const Json* value = values.begin();
    for (std::size_t end = 0; end != std::string_view::npos; keys.remove_prefix(end == std::string_view::npos ? 0 : end + 1)) {
        end = keys.find(',');
        if (value == values.end()) throw std::invalid_argument("more keys than values");
        object[std::string(keys.substr(0, end))] = *value++;
    }
    if (value != values.end()) throw std::invalid_argument("more values than keys");
    return object;
}

Json number_json(double value) { return std::isinf(value) ? Json("inf") : Json(value); }

Json values_json(std::span<const std::complex<double>> values) {
    Json list = Json::array();
    for (const auto& value : values) list.push_back({value.real(), value.imag()});
    return list;
}

Json machine_json() {
    Json machine = tools::provenance_json();
    machine["compiler"] = machine["compiler"].get<std::string>() + " " + machine["build_type"].get<std::string>();
    machine["flags"] = compiler_flags();
    machine["runtimes"] = runtime_versions();
    machine["tbb"] = engine::tbb_version();
    machine["openmp"] = openmp_version();
    machine["usable"] = tasks::usable_threads();
    return machine;
}

void show(const char* command, Json results, const tools::OutputArguments& output) {
    results["program"] = tools::program_name();
    results["output"] = {{"folder", output.folder}, {"csv", output.csv}, {"json", output.json}, {"svg", output.svg}};
    const std::string text = results.dump(-1, ' ', false, Json::error_handler_t::replace);
    const int file = memfd_create("results", MFD_CLOEXEC);
    std::string_view rest = text;
    while (file >= 0 && !rest.empty()) {
        const ssize_t some = write(file, rest.data(), rest.size());
        if (some < 0) break;
        rest.remove_prefix(static_cast<std::size_t>(some));
    }
    if (file < 0 || !rest.empty() || lseek(file, 0, SEEK_SET) != 0 || dup2(file, STDIN_FILENO) < 0)
        throw std::runtime_error(fmt::format("no file in memory for the results: {}", std::strerror(errno)));
    tools::print_notices();
    std::fflush(stdout);
    tools::become_python(std::array{std::string(command)}, "_laboratory.py");
}

}  // namespace cvtflow::bench
