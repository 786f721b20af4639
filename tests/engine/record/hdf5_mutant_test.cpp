/// Every reader against files that lie: thousands of mutants, each read in a child process that may neither crash, nor take over 5 s of
/// processor time, 60 s by the clock, or 1 GB.

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <new>
#include <utility>

#include "engine/record/case_table.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/engine/record/hdf5_mutant_fixture.hpp"
#include "tests/engine/record/reader_limits_fixture.hpp"
#include "tests/engine/record/record_fixture.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::engine {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool instrumented = true;  ///< the sanitizer's shadow takes terabytes of addresses
#else
constexpr bool instrumented = false;
#endif

enum class Fate { unread, ok, refused, memory, crash, hang };

/// Notes of a child on the present mutant, for its parent to read after its death.
struct Notes {
    long next = 0;
    Mutation mutation{};
    Fate fate[5'000]{};
    Mutation of[5'000]{};
};

void read_run(const std::string& path) {
    const RunReader run(path);
    (void)run.times();
    for (const ChannelInfo& channel : run.channels()) {
        (void)run.last(channel.name);
        (void)run.channel(channel.name);
    }
    for (const TableInfo& table : run.tables()) (void)run.table(table.name);
    if (const auto times = run.state_times(); !times.empty()) {
        (void)run.state(0);
        (void)run.state(times.size() - 1);
    }
}

struct Reader {
    std::string_view of;
    void (*read)(const std::string& path);
};

const Reader readers[] = {{"run", read_run},
                          {"killed", read_run},
                          {"state", [](const std::string& file) { (void)read_state(file); }},
                          {"cases", [](const std::string& file) { (void)read_cases(file); }},
                          {"growing", [](const std::string& file) { (void)read_cases(file); }}};

/// @return refused if the mutant is not taken
Fate fate_of(const std::string& path, const Reader& reader) {
    end_after(reader_limits);
    try {
        reader.read(path);
        return Fate::ok;
    } catch (const RecordError&) {
        return Fate::refused;
    } catch (const std::bad_alloc&) {
        return Fate::memory;
    }
}

class Hdf5MutantTest : public RecordTest {
protected:
    Hdf5MutantTest() : notes_(new (mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Notes) {}
    ~Hdf5MutantTest() override { munmap(notes_, sizeof(Notes)); }

    /// Files in the order of the readers: a finished record, one after a kill, a state, a finished table of cases, and one that was being
    /// written.
    [[nodiscard]] std::vector<std::string> originals() const {
        const auto fill = [](RunFile& file) {
            for (int i = 0; i < 40; ++i) append_example(file, i);
            for (int i = 0; i < 9; ++i) append_example_state(file, i);
            file.append_row("transitions", std::array{0.5, 80.0});
        };
        {
            RunFile file(path("run.h5"), example_contents(), {.deflate_states = 3});
            fill(file);
            file.close();
        }
        EXPECT_EQ(wait_for(start_child([&] {
                      RunFile file(path("killed.h5"), example_contents());
                      fill(file);
                      file.flush();
                      _exit(0);
                  })),
                  0);
        write_state(path("state.h5"), {.time = 0.5,
                                       .state = std::vector<double>(200, 1.5),
                                       .phases = std::vector<std::uint8_t>(30, 1),
                                       .fingerprint = "0123",
                                       .attributes = {{"scene", std::string(300, 's')}, {"step", 1e-6}},
                                       .more = {{"a", {1.0, 2.0}}, {"method", {}}}});
        write_cases(path("cases.h5"), example_cases());
        EXPECT_EQ(wait_for(start_child([&] {
                      CaseWriter writer(path("growing.h5"), example_cases());
                      writer.append(example_cases().row(3));
                      _exit(0);
                  })),
                  0);
        return {path("run.h5"), path("killed.h5.part"), path("state.h5"), path("cases.h5"), path("growing.h5")};
    }

    /// Reads mutants until there are `count`, or one ends the child.
    void work(const std::vector<std::string>& files, std::uint64_t seed, long count, bool seal_anew) const {
        if (!instrumented) {
            const rlimit gigabyte{rlim_t{1} << 30U, RLIM_INFINITY};
            setrlimit(RLIMIT_AS, &gigabyte);
        }
        const rlimit none{0, 0};
        setrlimit(RLIMIT_CORE, &none);
        try_files_first();  // as the program does
        for (; notes_->next < count; ++notes_->next) {
            end_after({60, 600});  // making some of them means writing many megabytes
            const auto number = static_cast<std::uint64_t>(notes_->next);
            const std::string mutant = path("mutant.h5");
            std::filesystem::remove(mutant);  // file systems write out at once what is cut and written anew
            std::filesystem::copy_file(files[number % files.size()], mutant);
            notes_->of[number] = mutate(mutant, seed * 1'000'003 + number, {seal_anew});
            const std::size_t kind = number % files.size();
            notes_->fate[number] = fate_of(mutant, readers[kind]);
            if (number % 8 != 0) continue;
            const Fate other = fate_of(mutant, readers[(kind + 2) % files.size()]);  // the reader of another kind of file
            if (other != Fate::refused) notes_->fate[number] = other;
        }
    }

    void run_children(std::uint64_t seed, long count, bool seal_anew) {
        ASSERT_LE(count, static_cast<long>(std::size(notes_->fate)));
        const std::vector<std::string> files = originals();
        *notes_ = {};
        long late = -1;  // a mutant that took too long by the clock: once more, since the disk may be busy elsewhere
        while (notes_->next < count) {
            const int status = wait_for(start_child([&] { work(files, seed, count, seal_anew); }));
            if (status == 0) break;
            if (took_its_clock_time(status) && std::exchange(late, notes_->next) != notes_->next) continue;
            const auto number = static_cast<std::size_t>(notes_->next++);
            notes_->fate[number] = took_its_clock_time(status) || took_its_processor_time(status) ? Fate::hang : Fate::crash;
            const std::string kept = "cvtflow_mutant_" + std::to_string(seed) + "_" + std::to_string(number) + ".h5";
            std::filesystem::copy_file(path("mutant.h5"), std::filesystem::temp_directory_path() / kept,
                                       std::filesystem::copy_options::overwrite_existing);
            ADD_FAILURE() << "mutant " << number << " of seed " << seed << " of " << files[number % files.size()]
                          << " ended its reader with " << status << "; kept as " << kept;
        }
    }

    /// Counts by kind, and what may not be.
    void judge(long count) const {
        std::map<Mutation, std::map<Fate, long>> counts;
        for (long i = 0; i < count; ++i) ++counts[notes_->of[i]][notes_->fate[i]];
        std::printf("%-10s %8s %8s %8s %8s %10s\n", "mutants", "ok", "refused", "crash", "over 5 s", "over 1 GB");
        long read = 0, refused = 0;
        for (auto& [mutation, fates] : counts) {
            std::printf("%-10s %8ld %8ld %8ld %8ld %10ld\n", mutation_names[static_cast<std::size_t>(mutation)].data(), fates[Fate::ok],
                        fates[Fate::refused], fates[Fate::crash], fates[Fate::hang], fates[Fate::memory]);
            EXPECT_EQ(fates[Fate::memory] + fates[Fate::crash] + fates[Fate::hang], 0)
                << mutation_names[static_cast<std::size_t>(mutation)];
            read += fates[Fate::ok];
            refused += fates[Fate::refused];
        }
        std::fflush(stdout);  // the next ones take minutes
        EXPECT_EQ(read + refused, count);
        EXPECT_GT(refused, count / 10);  // the mutants are some
    }

    void try_mutants(std::uint64_t seed, long count, bool seal_anew) {
        run_children(seed, count, seal_anew);
        judge(count);
    }

    Notes* notes_;
};

TEST(ReaderLimits, EndWhatComputesAndWhatSleepsButNotWhatWaitsForItsTurn) {
    const auto status_of = [](const TimeLimits& limits, void (*read)()) {
        return wait_for(start_child([&] {
            end_after(limits);
            read();
        }));
    };
    EXPECT_TRUE(took_its_processor_time(status_of({1, 600}, [] {
        while (getpid() != 0) {}
    })));
    EXPECT_TRUE(took_its_clock_time(status_of({600, 1}, [] {
        while (getpid() != 0) pause();
    })));
    EXPECT_EQ(status_of({1, 600}, [] { usleep(1'500'000); }), 0);  // on a busy machine the clock runs, too, and processor time does not
}

TEST_F(Hdf5MutantTest, EveryReaderSurvivesThemAsTheyCome) { try_mutants(1, cvtflow::test::depth(100, 500), false); }
TEST_F(Hdf5MutantTest, EveryReaderSurvivesThemSealedAnew) { try_mutants(2, cvtflow::test::depth(100, 500), true); }

/// A hundred thousand.
class NightlyHdf5MutantTest : public Hdf5MutantTest, public testing::WithParamInterface<int> {};

TEST_P(NightlyHdf5MutantTest, EveryReaderSurvivesFiveThousand) {
    try_mutants(static_cast<std::uint64_t>(GetParam()), 5'000, GetParam() % 2 == 0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, NightlyHdf5MutantTest, testing::Range(100, 120));

}  // namespace
}  // namespace cvtflow::engine
