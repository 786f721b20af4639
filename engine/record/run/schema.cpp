#include "engine/record/run/schema.hpp"

#include <hdf5.h>

namespace cvtflow::engine {

std::vector<Attribute> attributes_of(const Provenance& provenance) {
    unsigned major = 0;
    unsigned minor = 0;
    unsigned release = 0;
    H5get_libversion(&major, &minor, &release);
    return {{"program_version", provenance.version},
            {"commit", provenance.commit},
            {"compiler", provenance.compiler},
            {"build_type", provenance.build_type},
            {"instruction_set", provenance.instruction_set},
            {"cpu", provenance.cpu},
            {"cores", std::int64_t{provenance.cores}},
            {"os", provenance.os},
            {"date", provenance.date},
            {"hdf5_version", std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release)}};
}

void disable_hdf5_atexit() noexcept { static_cast<void>(H5dont_atexit()); }  // fails only where HDF5 is at work already

}  // namespace cvtflow::engine
