/// Tests over the catalogue of executors run over those of the laboratory as well.

#include "bench/executor/further_executors.hpp"

namespace cvtflow::test {
namespace {

[[maybe_unused]] const bool added = (bench::add_further_executors(), true);

}  // namespace
}  // namespace cvtflow::test
