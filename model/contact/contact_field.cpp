#include "model/contact/contact_field.hpp"

#include <algorithm>

namespace cvtflow::model {

ContactField::ContactField(const ChainModel& chain)
    : components{chain.coefficients().joint_points.count, chain.coefficients().plates.count} {
    make_columns(chain.layout().links + 2);
}

void ContactField::make_columns(int count) {
    columns = FloatColumns(components.count(), count);
    arms = Columns(3 * tips_per_link, count);
    for (int corner = 0; corner < tips_per_link; ++corner) {  // a tip that has never touched must not divide by zero
        for (int column = 0; column < columns.stride(); ++column)
            *columns.at(components.tip(corner) + ContactComponents::Tip::least, column) = 1.0F;
    }
}

void ContactField::stop() noexcept {
    using Tip = ContactComponents::Tip;
    const auto clear = [this](int first, int last) { std::fill(columns.at(first, 0), columns.at(last, 0), 0.0F); };
    for (int corner = 0; corner < tips_per_link; ++corner)
        clear(components.tip(corner) + Tip::sheave, components.tip(corner) + Tip::friction_limit);
    clear(components.sliding(0), components.count());
}

}  // namespace cvtflow::model
