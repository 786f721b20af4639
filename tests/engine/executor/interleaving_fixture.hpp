#pragma once
/// A machine that executes every interleaving of a few workers, one after the other: code between two operations on atomics runs at once,
/// and before each operation the next worker is chosen. A relaxed or acquiring load may return any store that coherence and the
/// happens-before order allow, not just the latest. Sleep sets leave out interleavings that only reorder independent operations.
///
/// Not covered: stores that enter an atomic's order of modification before an older one, loads of stores that execute later,
/// compare-and-swaps that fail for no reason, and sequentially consistent operations (which do not compile).

#include <ucontext.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/thread/executor_options.hpp"

namespace cvtflow::engine::test {

/// A program of a few workers that share atomics of the ModelMachine and cells. Created for every interleaving.
class Scenario {
public:
    virtual ~Scenario() = default;
    /// Work of a worker. Allocates nothing: an interleaving that is left early leaves it where it is.
    virtual void work(int worker) noexcept = 0;
    /// Fault after all workers have ended; empty: none.
    [[nodiscard]] virtual std::string fault() = 0;
};

/// Place of a call; std::source_location, which clang 14 does not have.
struct Place {
    const char* function;
    unsigned line;
};

/// An operation by its place in the sources.
struct Site {
    enum class Kind { load, store, add, swap };
    std::string place;  ///< "function:line"
    Kind kind;
    bool orders;  ///< anything but itself
};

/// Changes of the program that a test must detect.
enum class Sabotage {
    none,
    relaxed,  ///< the operation orders nothing
    torn,     ///< the operation reads and writes in two steps instead of one
};

class Interleavings;

/// Next operation of a worker.
struct Pending {
    enum class Kind { load, modify, change, rest, ended } kind = Kind::load;
    int atomic = -1;
    std::uint64_t old = 0;
    std::uint64_t seen = 0;  ///< rest: bits of the atomics that were read
};

/// Atomics and cells of an interleaving: the stores visible to each worker, and the happens-before order.
class ModelMemory {
public:
    static constexpr int max_workers = 4, max_atomics = 48;

    explicit ModelMemory(Interleavings& machine) : machine_(machine) {}
    /// Clears the memory for the next interleaving.
    void clear();

    // Operations of atomics. `order` determines visibility.
    [[nodiscard]] int add_atomic(std::uint64_t value);
    std::uint64_t load(int atomic, std::memory_order order, const Place& where);
    void store(int atomic, std::uint64_t value, std::memory_order order, const Place& where);
    std::uint64_t add(int atomic, std::uint64_t change, std::memory_order order, const Place& where);
    bool swap(int atomic, std::uint64_t& expected, std::uint64_t value, std::memory_order order, const Place& where);
    /// Waits until an atomic has another value.
    std::uint64_t change(int atomic, std::uint64_t old, const Place& where);
    /// Waits for a store that the worker's loads since its last rest did not return; from then on they return it.
    void rest();

    // Plain data.
    [[nodiscard]] int add_cell();
    void touch(int cell, bool write);

    /// Whether a worker need not wait any more.
    [[nodiscard]] bool enabled(int worker, const Pending& pending) const;

private:
    using Clock = std::array<std::uint32_t, max_workers>;
    using View = std::array<std::uint16_t, max_atomics>;  ///< [atomic] the oldest store that may be seen
    struct Store {
        std::uint64_t value = 0;
        Clock clock{};  ///< handed to the acquiring worker
        View view{};
    };
    struct Cell {
        int writer = -1;
        std::uint32_t written = 0;
        Clock read{};
    };
    struct Sight {
        Clock clock{};
        View view{};
        View seen{};  ///< newest store that was seen since the last rest
        std::uint64_t read = 0;
    };

    [[nodiscard]] Sight& self();
    [[nodiscard]] std::size_t newest(int atomic) const { return stores_[static_cast<std::size_t>(atomic)].size() - 1; }
    std::uint64_t see(int atomic, std::size_t which, bool acquires);
    void put(int atomic, std::uint64_t value, bool releases, bool continues);
    void replace(int atomic, std::uint64_t value, std::memory_order order, Sabotage sabotage);
    [[nodiscard]] std::size_t pick_store(int atomic, const std::function<bool(std::uint64_t)>& allowed);

    Interleavings& machine_;
    std::array<Sight, max_workers> sights_;
    std::vector<std::vector<Store>> stores_;  ///< [atomic] stores in their order of modification
    std::vector<Cell> cells_;
};

class Interleavings {
public:
    struct Options {
        int workers = 2;
        long most = 5'000'000;  ///< interleavings; more are a fault
        int absences = 0;       ///< number of times that a worker may go away
        Sabotage sabotage = Sabotage::none;
        std::string place{};  ///< place of the operation that is sabotaged
    };
    struct Outcome {
        long interleavings = 0;     ///< interleavings that ended
        long longest = 0;           ///< operations of the longest of them
        std::string fault{};        ///< first fault; empty: none
        std::vector<Site> sites{};  ///< operations that were met
    };
    using Make = std::function<std::unique_ptr<Scenario>()>;

    /// Runs all interleavings, up to the first fault: a race, a wrong result, workers that wait for ever.
    [[nodiscard]] static Outcome explore(const Options& options, const Make& make);
    /// The exploration that is under way, and its memory.
    [[nodiscard]] static Interleavings& now() noexcept { return *now_; }
    [[nodiscard]] static ModelMemory& memory() noexcept { return now_->memory_; }

    /// One of `possibilities`; all come in turn.
    [[nodiscard]] int pick(int possibilities);
    /// Whether the worker goes away now, if it may once more: both possibilities come in turn.
    [[nodiscard]] bool may_leave();

    // For the memory: the running worker (negative: none, or one that begins) …
    [[nodiscard]] int running() const noexcept { return running_; }
    /// … is before an operation: others may go first.
    void announce(Pending pending);
    /// … carries it out. Returns what is done to it.
    Sabotage met(const Place& where, Site::Kind kind, bool orders);
    void note(const char* verb, int object, std::uint64_t value) { deeds_.push_back({running_, verb, object, value}); }
    void leave(const char* fault);

    static constexpr int no_worker = -1;

private:
    struct Worker {
        ucontext_t context{};
        std::vector<char> stack;
        Pending pending{};
        int absences = 0;
    };
    struct Met {
        const char* function;
        unsigned line;
        Site site;
        Sabotage sabotage;
    };
    struct Deed {
        int worker;
        const char* verb;
        int object;
        std::uint64_t value;
    };
    struct Choice {
        bool of_worker = false;
        std::vector<int> options;
        std::size_t taken = 0;
        unsigned asleep = 0;  ///< workers whose next operation was tried here already
    };

    Interleavings(const Options& options, const Make& make);
    void run_one();
    void begin(int worker);
    static void entry(unsigned worker);
    [[nodiscard]] bool backtrack();
    void pass_on();
    [[nodiscard]] int choose_worker();
    [[nodiscard]] std::string story() const;
    [[nodiscard]] Worker& self() { return workers_[static_cast<std::size_t>(running_)]; }

    static inline Interleavings* now_ = nullptr;

    const Options options_;
    const Make& make_;
    std::unique_ptr<Scenario> scenario_;
    Outcome outcome_;
    std::vector<Met> met_;
    std::vector<Choice> choices_;
    std::size_t depth_ = 0;

    ucontext_t main_{};
    std::array<Worker, ModelMemory::max_workers> workers_;
    ModelMemory memory_{*this};
    int running_ = no_worker;
    bool left_ = false, pruned_ = false;
    unsigned asleep_ = 0;
    long operations_ = 0;
    std::vector<Deed> deeds_;
};

/// Machine of a board (engine/executor/tbb/resident_board.hpp) in this model.
struct ModelMachine {
    template <class Value>
    class Atomic {
    public:
        Atomic(Value value = {}) : id_(Interleavings::memory().add_atomic(static_cast<std::uint64_t>(value))) {}
        Value load(std::memory_order order, Place where = {__builtin_FUNCTION(), __builtin_LINE()}) const noexcept {
            return static_cast<Value>(Interleavings::memory().load(id_, order, where));
        }
        void store(Value value, std::memory_order order, Place where = {__builtin_FUNCTION(), __builtin_LINE()}) noexcept {
            Interleavings::memory().store(id_, static_cast<std::uint64_t>(value), order, where);
        }
        Value fetch_add(Value value, std::memory_order order, Place where = {__builtin_FUNCTION(), __builtin_LINE()}) noexcept {
            return static_cast<Value>(Interleavings::memory().add(id_, static_cast<std::uint64_t>(value), order, where));
        }
        Value fetch_sub(Value value, std::memory_order order, Place where = {__builtin_FUNCTION(), __builtin_LINE()}) noexcept {
            return static_cast<Value>(Interleavings::memory().add(id_, ~static_cast<std::uint64_t>(value) + 1, order, where));
        }
        bool compare_exchange_weak(Value& expected, Value value, std::memory_order order,
                                   Place where = {__builtin_FUNCTION(), __builtin_LINE()}) noexcept {
            auto seen = static_cast<std::uint64_t>(expected);
            const bool swapped = Interleavings::memory().swap(id_, seen, static_cast<std::uint64_t>(value), order, where);
            expected = static_cast<Value>(seen);
            return swapped;
        }
        [[nodiscard]] int id() const noexcept { return id_; }

    private:
        int id_;
    };
    static constexpr std::size_t numbers_together = 1;
    static constexpr int max_polls = 0;
    struct Waiter {
        explicit Waiter(const ExecutorOptions& /*options*/) {}
        template <class Value>
        Value change(const Atomic<Value>& word, Value old, Place where = {__builtin_FUNCTION(), __builtin_LINE()}) noexcept {
            return static_cast<Value>(Interleavings::memory().change(word.id(), static_cast<std::uint64_t>(old), where));
        }
        template <class Ready>
        void until(const Ready& ready) noexcept {
            while (!ready()) Interleavings::memory().rest();
        }
    };
    /// Goes away whenever it may, and comes back at any moment or not before the run is over.
    struct Presence {
        explicit Presence(const ExecutorOptions& /*options*/) {}
        bool due() noexcept { return Interleavings::now().may_leave(); }
        template <class Over>
        void away(const Over& over) noexcept {
            if (Interleavings::now().pick(2) == 0) return;
            while (!over()) Interleavings::memory().rest();
        }
        void returned() noexcept {}
    };
};

}  // namespace cvtflow::engine::test
