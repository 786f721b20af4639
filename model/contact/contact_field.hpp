#pragma once
/// Every friction contact of the chain with all frozen but velocities, laid out component by component so that lanes can run over links:
/// [component][column], column = link + 1; column 0 repeats the last link, column links + 1 the first. For pin halves only.
///
/// In double precision velocities are what they are. In single precision they count from those at which the contacts were recorded, so that
/// small differences of large velocities are taken in double precision, once a step; a field then also holds how contacts slide at those.

#include <cstddef>
#include <vector>

#include "model/basis/columns.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/contact_components.hpp"

namespace cvtflow::model {

/// Arms from a sheave's origin to the contact points of a link's tips, for reactions on the sheaves [m].
struct TipArms {
    double x[tips_per_link], y[tips_per_link], z[tips_per_link];
};

template <class Number>
struct ContactFieldOf {
    explicit ContactFieldOf(const ChainModel& chain);
    /// As many columns, of contacts that have never touched.
    void make_columns(int count);

    [[nodiscard]] std::size_t bytes() const noexcept { return columns.bytes() + arms.size() * sizeof(TipArms); }

    ContactComponents components;
    ColumnsOf<Number> columns;
    std::vector<TipArms> arms;  ///< [links], where a tip touches
};
using ContactField = ContactFieldOf<double>;

/// The step in whose middle a field is recorded.
struct ContactDrift {
    double step = 0.0;         ///< h [s]
    SheaveMotion change[4]{};  ///< of the sheaves' velocities over the step
};

/// Output of the pass over links for friction in single precision.
struct SinglePrecisionRecord {
    const double* states;  ///< [unknowns] at the step's beginning, of the range's first link on
    ContactFieldOf<float>& field;
    ColumnsOf<float>& frictionless;  ///< accelerations by everything but friction [m/s², rad/s²]
    ColumnsOf<float>& velocity;      ///< at the step's beginning, counted from those at which contacts are recorded [m/s, rad/s]
};

}  // namespace cvtflow::model
