/// Tests over the catalogue of methods run over those of the laboratory as well.

#include "bench/method/laboratory_methods.hpp"

namespace cvtflow::test {
namespace {

[[maybe_unused]] const bool methods_added = (bench::add_laboratory_methods(), true);

}  // namespace
}  // namespace cvtflow::test
