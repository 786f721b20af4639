#include "engine/record/hdf5/hdf5_exit.hpp"

#include <hdf5.h>

namespace cvtflow::engine {

void disable_hdf5_atexit() noexcept { static_cast<void>(H5dont_atexit()); }  // fails only where HDF5 is at work already

}  // namespace cvtflow::engine
