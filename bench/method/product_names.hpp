#pragma once
/// Names of the product that the laboratory's methods use.

namespace cvtflow::engine {}
namespace cvtflow::model {}
namespace cvtflow::tasks {}

namespace cvtflow::bench {

using namespace engine;
using namespace model;
using namespace tasks;

}  // namespace cvtflow::bench
