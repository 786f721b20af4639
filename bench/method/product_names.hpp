#pragma once
/// The methods of the laboratory are written in the words of the product, whose methods most of them were.

namespace cvtflow::engine {}
namespace cvtflow::model {}
namespace cvtflow::tasks {}

namespace cvtflow::bench {

using namespace engine;
using namespace model;
using namespace tasks;

}  // namespace cvtflow::bench
