#include "tools/program/output/fmu/generation_date.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "tools/program/guard.hpp"

namespace cvtflow::tools {

std::string generation_date() {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    if (epoch == nullptr || *epoch == '\0') return CVTFLOW_COMMIT_DATE;
    std::int64_t seconds = 0;
    const char* end = epoch + std::strlen(epoch);
    constexpr std::int64_t year_9999 = 253402300799;
    if (std::from_chars(epoch, end, seconds).ptr != end || seconds < 0 || seconds > year_9999)
        throw UsageError(fmt::format("SOURCE_DATE_EPOCH: '{}' is no number of seconds since 1970", epoch));
    const std::time_t time = seconds;
    std::tm parts{};
    gmtime_r(&time, &parts);
    char text[32] = {};
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

}  // namespace cvtflow::tools
