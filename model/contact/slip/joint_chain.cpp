#include "model/contact/slip/joint_chain.hpp"

namespace cvtflow::model {

SlipChain::SlipChain(const SlipStretches& links, int unknowns_of_joint)
    : stretches(links), size(unknowns_of_joint), elements(static_cast<std::size_t>(links.length())) {
    const SlipElement element{size};
    const SlipStep step{size};
    for (int count = stretches.count(); counts.empty() || counts.back() > 1; count = (count + 1) / 2) counts.push_back(count);
    for (int k = 0; k < stretches.length() - 1 + levels(); ++k) steps.emplace_back(step.count());
    for (FloatRows* rows : {&left, &right}) *rows = FloatRows(element.count());
    scaled = FloatRows(size * (2 * size + 1));
    sides = FloatRows(stretches.length() * size);
    unknowns = FloatRows((stretches.length() + 1) * size);
    ends = FloatRows((levels() + 1) * size);
}

}  // namespace cvtflow::model
