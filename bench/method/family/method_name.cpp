#include "bench/method/family/method_name.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

namespace cvtflow::bench {

std::optional<std::map<char, double>> name_values(std::string_view name, std::string_view family, std::string_view letters) {
    if (!name.starts_with(family)) return {};
    std::map<char, double> values;
    for (std::string_view rest = name.substr(family.size()); !rest.empty();) {
        if (rest.size() < 3 || rest[0] != '-' || letters.find(rest[1]) == std::string_view::npos) return {};
        const char key = rest[1];
        double value = 0.0;
        const auto [after, fault] = std::from_chars(rest.data() + 2, rest.data() + rest.size(), value, std::chars_format::fixed);
        if (fault != std::errc() || !std::isfinite(value) || !values.emplace(key, value).second) return {};
        rest.remove_prefix(static_cast<std::size_t>(after - rest.data()));
    }
    if (values.empty()) return {};
    return values;
}

}  // namespace cvtflow::bench
