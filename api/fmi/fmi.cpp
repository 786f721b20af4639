#include "api/fmi/fmi.hpp"

namespace cvtflow::fmi {

int not_offered(void* component, const char* function) noexcept {
    return guarded(component, [&](Component&) {
        throw Error(ErrorCode::argument, std::string(function) + ": this FMU does not offer it, as its description says");
    });
}

}  // namespace cvtflow::fmi
