/// Tests over the catalogue of methods and over the assemblies run over those of the laboratory as well.

#include "bench/method/laboratory_methods.hpp"
#include "bench/staged/staged_assembly.hpp"

namespace cvtflow::test {
namespace {

[[maybe_unused]] const bool assembly_added = (bench::add_laboratory_methods(), bench::add_staged_assembly(), true);

}  // namespace
}  // namespace cvtflow::test
