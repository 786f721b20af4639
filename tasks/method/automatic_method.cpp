#include "tasks/method/automatic_method.hpp"

#include <algorithm>
#include <array>

#include "tasks/method/friction/sweep_leapfrog.hpp"

namespace cvtflow::tasks {

std::span<const AutomaticChoice> automatic_choices() noexcept {
    static constexpr std::array choices{
        AutomaticChoice{"leapfrog-rigid", "rigid pins",
                        [](const model::Parameters& parameters) { return parameters.detail.pins == model::PinDetail::rigid; }},
        AutomaticChoice{"leapfrog-sweep", "pin halves with the piecewise friction law", sweeps_suit},
        AutomaticChoice{"leapfrog-chebyshev", "other friction laws, saturation speeds below a hundredth of the usual ones",
                        [](const model::Parameters&) { return true; }},
    };
    return choices;
}

std::string_view resolved_method(std::string_view method, const model::Parameters& parameters) {
    if (method != automatic_method) return method;
    const auto choices = automatic_choices();
    return std::ranges::find_if(choices, [&](const AutomaticChoice& choice) { return choice.suits(parameters); })->method;
}

}  // namespace cvtflow::tasks
