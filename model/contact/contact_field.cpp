#include "model/contact/contact_field.hpp"

namespace cvtflow::model {

ContactField::ContactField(const ChainModel& chain)
    : components{chain.coefficients().joint_points.count, chain.coefficients().plates.count} {
    make_columns(chain.layout().links + 2);
}

void ContactField::make_columns(int count) {
    columns = FloatColumns(components.count(), count);
    arms = Columns(3 * tips_per_link, count);
}

}  // namespace cvtflow::model
