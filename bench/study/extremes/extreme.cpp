#include "bench/study/extremes/extreme.hpp"

namespace cvtflow::bench {

using namespace tasks;

const std::vector<Extreme>& extremes() {
    static const std::vector<Extreme> rows = [] {
        std::vector<Extreme> all;
        add_friction_rows(all);
        add_size_rows(all);
        add_operation_rows(all);
        add_contact_rows(all);
        add_step_rows(all);
        add_number_rows(all);
        add_limit_rows(all);
        return all;
    }();
    return rows;
}

}  // namespace cvtflow::bench
