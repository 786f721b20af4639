# Embeds licences into the program.
set(files ${PROJECT_SOURCE_DIR}/api/python/cvtflow/page/licenses.txt)
set(CVTFLOW_EMBEDDED_DATA "")
set(CVTFLOW_EMBEDDED_ROWS "")
foreach(file ${files})
  cmake_path(GET file FILENAME name)
  string(MAKE_C_IDENTIFIER "cvtflow_embedded_${name}" symbol)
  string(APPEND CVTFLOW_EMBEDDED_DATA
    "asm(\".pushsection .rodata\\n.hidden ${symbol}\\n.hidden ${symbol}_end\\n.globl ${symbol}\\n.globl ${symbol}_end\\n\"\n"
    "    \"${symbol}:\\n.incbin \\\"${file}\\\"\\n${symbol}_end:\\n.byte 0\\n.popsection\\n\");\n"
    "extern \"C\" __attribute__((visibility(\"hidden\"))) const char ${symbol}[], ${symbol}_end[];\n")
  string(APPEND CVTFLOW_EMBEDDED_ROWS
    "    if (name == \"${name}\") return {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})};\n")
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/embedded.cpp @ONLY CONTENT [[
#include "tools/program/embedded.hpp"

@CVTFLOW_EMBEDDED_DATA@
std::string_view cvtflow::tools::embedded(std::string_view name) {
@CVTFLOW_EMBEDDED_ROWS@    return {};
}
]])
target_sources(cvtflow_program_common PRIVATE ${PROJECT_BINARY_DIR}/embedded.cpp)
set_source_files_properties(${PROJECT_BINARY_DIR}/embedded.cpp PROPERTIES OBJECT_DEPENDS "${files}")
