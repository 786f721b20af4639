#include "tasks/scene/accuracy.hpp"

#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {

std::optional<double> read_accuracy(std::string_view text) {
    constexpr double most = 0.5;
    const auto parsed = parse_quantity(text);
    const auto* quantity = std::get_if<Quantity>(&parsed);
    if (quantity == nullptr || !(quantity->dimension == dimension_of("1")) || !(quantity->value > 0.0) || quantity->value > most)
        return std::nullopt;
    return quantity->value;
}

}  // namespace cvtflow::tasks
