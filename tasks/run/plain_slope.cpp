#include "tasks/run/plain_slope.hpp"

namespace cvtflow::tasks {

PlainSlope::PlainSlope(const model::Variator& variator, const model::PhaseRule& rule)
    : variator_(variator),
      rule_(rule),
      scratch_(variator.layout()),
      phases_(static_cast<std::size_t>(model::tips_per_link * variator.layout().links), model::Phase::free) {}

void PlainSlope::operator()(double t, const double* x, double* out) noexcept {
    const model::ChainLayout& at = variator_.layout();
    if (at.pulley_size != 0) {
        variator_.pulleys().motions(x + at.pulley_begin(), scratch_.sheaves);
        for (int link = 0; link < at.links; ++link) {
            model::TipProbe probe;
            model::NeighbourWindow strip;
            variator_.chain().probe(strip.of(at, x, link), scratch_.sheaves, true, probe);
            for (int tip = 0; tip < model::tips_per_link; ++tip) {
                phases_[static_cast<std::size_t>(model::tips_per_link * link + tip)] =
                    rule_.next(model::Phase::free, {probe.depth[tip], probe.slip[tip]});
            }
        }
    }
    model::right_hand_side(variator_, t, x, phases_.data(), out, scratch_);
}

}  // namespace cvtflow::tasks
