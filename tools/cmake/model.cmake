# The kernels, one source for every instruction set; which one runs is chosen at the start of a run (model/kernels/available_isas.hpp).
# Whatever is not in an unnamed namespace would be shared between them by the linker: tests/architecture looks at their symbols.
set(kernel_sources model/kernels/chain_kernels.cpp model/kernels/friction_kernels.cpp model/rigid/rigid_kernels.cpp
  model/rigid/rigid_step_kernels.cpp)
set(CVTFLOW_KERNEL_ROWS "")
set(CVTFLOW_KERNEL_DECLARATIONS "")
foreach(isa ${isas})
  add_library(cvtflow_kernels_${isa} OBJECT ${kernel_sources})
  cvtflow_kernels(cvtflow_kernels_${isa} ${isa})
  string(APPEND CVTFLOW_KERNEL_DECLARATIONS "template <>\nChainKernels chain_kernels<Isa::${isa}>() noexcept;\n"
    "template <>\nFrictionKernels friction_kernels<Isa::${isa}>() noexcept;\n"
    "template <>\nRigidKernels<double> rigid_kernels<Isa::${isa}, double>() noexcept;\n"
    "template <>\nRigidKernels<float> rigid_kernels<Isa::${isa}, float>() noexcept;\n")
  string(APPEND CVTFLOW_KERNEL_ROWS
    "        {Isa::${isa}, chain_kernels<Isa::${isa}>, friction_kernels<Isa::${isa}>, rigid_kernels<Isa::${isa}, double>,\n         rigid_kernels<Isa::${isa}, float>},\n")
  list(APPEND kernel_parts cvtflow_kernels_${isa})
endforeach()
configure_file(model/kernels/compiled_kernels.cpp.in ${PROJECT_BINARY_DIR}/compiled_kernels.cpp @ONLY)

file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/model/*.cpp)
list(FILTER sources EXCLUDE REGEX "/model/.*_kernels\\.cpp$")
add_library(cvtflow_model STATIC ${sources})
target_link_libraries(cvtflow_model PUBLIC cvtflow_flags)
# GCC 12 makes (v)fmaddsub of a product, a sum and a difference side by side, whatever -ffp-contract is: a test disassembles the library.
target_compile_options(cvtflow_model PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
cvtflow_in_groups(cvtflow_model)
target_sources(cvtflow_model PRIVATE ${PROJECT_BINARY_DIR}/compiled_kernels.cpp)
foreach(part ${kernel_parts})   # users of the model's objects name these as well: a static library has those of its sources only
  target_sources(cvtflow_model PRIVATE $<TARGET_OBJECTS:${part}>)
endforeach()
