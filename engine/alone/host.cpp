/// Substitutes for threads and files in the core library: one thread, the caller's, and an error for every file. These are all functions
/// that its sources call and that need oneTBB, OpenMP, HDF5 or POSIX elsewhere. The texts of embedded files are added by the build.

#include "engine/base/input_file.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/record/run/state_file.hpp"
#include "engine/thread/worker_threads.hpp"

namespace cvtflow::engine {

std::span<const ExecutorRow> threaded_executors() noexcept { return {}; }
int usable_processors() { return 1; }
Provenance current_provenance() {
    Provenance here;
    here.commit = "unknown";
    return here;
}
std::string version_text() { return "core library"; }
ThreadShortage thread_shortage() noexcept { return {}; }
long process_number() noexcept { return 0; }

SavedState last_state_of_record(const std::string& path) { throw RecordError(path + ": this library reads no records, only states"); }
FileIdentity identity_of(const std::string&) noexcept { return {}; }

std::string read_text_input(const std::string& path, std::uint64_t) {
    for (const EmbeddedFile& file : embedded_files())
        if (path.starts_with(embedded_folder) && path.substr(embedded_folder.size() + 1) == file.name) return std::string(file.text);
    throw InputError("this library reads no files: pass a scene as text (Scene::parse), and tables as points in it");
}

}  // namespace cvtflow::engine
