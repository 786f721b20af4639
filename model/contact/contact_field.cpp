#include "model/contact/contact_field.hpp"

#include <type_traits>

namespace cvtflow::model {

template <class Number>
ContactFieldOf<Number>::ContactFieldOf(const ChainModel& chain)
    : components{chain.coefficients().joint_points.count, chain.coefficients().plates.count, std::is_same_v<Number, float>} {
    make_columns(chain.layout().links + 2);
}

template <class Number>
void ContactFieldOf<Number>::make_columns(int count) {
    columns = ColumnsOf<Number>(components.count(), count);
    arms = Columns(3 * tips_per_link, count);
    for (int corner = 0; corner < tips_per_link; ++corner) {  // a tip that has never touched must not divide by zero
        for (int column = 0; column < columns.stride(); ++column)
            *columns.at(components.tip(corner) + ContactComponents::Tip::least, column) = Number(1);
    }
}
template struct ContactFieldOf<double>;
template struct ContactFieldOf<float>;

}  // namespace cvtflow::model
