/// Any bytes are a record, a state, a table of cases, or a RecordError. Mutants are made by hdf5_mutant_fixture.hpp, which keeps them HDF5
/// files; headers are not forged, since HDF5 itself crashes on them (hdf5_open.hpp).

#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/record/case_table.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/engine/record/hdf5_mutant_fixture.hpp"
#include "tests/fuzz/fuzz_fixture.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t most);

namespace {

using namespace cvtflow::engine;

void read_run(const std::string& path) {
    const RunReader run(path);
    for (const ChannelInfo& channel : run.channels()) static_cast<void>(run.channel(channel.name));
    for (const TableInfo& table : run.tables()) static_cast<void>(run.table(table.name));
    if (const auto times = run.state_times(); !times.empty()) static_cast<void>(run.state(times.size() - 1));
}

void read_one_state(const std::string& path) { static_cast<void>(read_state(path)); }
void read_all_cases(const std::string& path) { static_cast<void>(read_cases(path)); }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const cvtflow::fuzz::MemoryFile file(bytes, size);
    for (const auto& read : {read_run, read_one_state, read_all_cases}) {
        try {
            read(file.path());
        } catch (const RecordError&) {}
    }
    return 0;
}

/// A true file, changed; or any of the inputs, with other bytes. Never a changed one through HDF5, which may not survive opening it for
/// writing.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size, std::size_t most, unsigned seed) {
    if (seed % 4 == 0) return LLVMFuzzerMutate(bytes, size, most);
    constexpr const char* originals[] = {"run.h5", "killed.h5", "state.h5", "cases.h5"};
    const std::filesystem::path corpus = std::string(CVTFLOW_SOURCE_DIR) + "/tests/fuzz/corpus/record";
    const std::string path = (std::filesystem::temp_directory_path() / ("cvtflow-fuzz-" + std::to_string(getpid()))).string();
    std::filesystem::remove(path);
    std::filesystem::copy_file(corpus / originals[seed / 4 % 4], path);
    static_cast<void>(mutate(path, seed, {.seal_anew = seed % 4 != 1, .forge = false}));
    std::ifstream file(path, std::ios::binary);
    const std::string mutant{std::istreambuf_iterator<char>(file), {}};
    if (mutant.empty() || mutant.size() > most) return size;
    std::copy(mutant.begin(), mutant.end(), reinterpret_cast<char*>(bytes));
    return mutant.size();
}
