/// Substitutes for threads and files in the core library: one thread, the caller's, and an error for every file. These are all functions
/// that its sources call and that need oneTBB, OpenMP, HDF5 or POSIX elsewhere.

#include <limits>

#include "engine/base/input_file.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/record/run/state_file.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::engine {

std::span<const ExecutorRow> threaded_executors() noexcept { return {}; }
int usable_processors() { return 1; }
ThreadShortage thread_shortage() noexcept { return {}; }
long process_number() noexcept { return 0; }
double bare_barrier_cycle(int, double, double) noexcept { return std::numeric_limits<double>::infinity(); }

SavedState read_state(const std::string& path) { throw RecordError(path + ": this library cannot read state files"); }
FileIdentity identity_of(const std::string&) noexcept { return {}; }
std::string read_text_input(const std::string&, std::uint64_t, double) { throw InputError("this library reads no files"); }

}  // namespace cvtflow::engine
