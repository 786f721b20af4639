/// Boost.Asio as a thread pool: one queue of handlers, to which tasks are posted when those before them have finished.

#include "bench/executor/compared_executors.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

#if __has_include(<boost/asio/io_context.hpp>)
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/version.hpp>
#define CVTFLOW_HAS_ASIO
#endif

namespace cvtflow::bench {

using namespace engine;

#ifdef CVTFLOW_HAS_ASIO
namespace {

/// Memory of a task's handler while it waits in the queue; a task waits there once at a time.
struct alignas(128) Place {
    std::byte bytes[256];
};

/// Gives a handler its task's place. (What Asio makes of a handler takes about 60 bytes; were it ever more than the place, the heap.)
template <class Type>
struct PlaceAllocator {
    using value_type = Type;
    Place* place;

    explicit PlaceAllocator(Place* storage) noexcept : place(storage) {}
    template <class Other>
    PlaceAllocator(const PlaceAllocator<Other>& other) noexcept : place(other.place) {}  // NOLINT: as allocators do

    [[nodiscard]] static bool fits(std::size_t count) noexcept { return count * sizeof(Type) <= sizeof(Place); }
    [[nodiscard]] Type* allocate(std::size_t count) const {
        return static_cast<Type*>(fits(count) ? static_cast<void*>(place) : ::operator new(count * sizeof(Type)));
    }
    void deallocate(Type* memory, std::size_t count) const noexcept {
        if (!fits(count)) ::operator delete(memory);
    }
    template <class Other>
    [[nodiscard]] bool operator==(const PlaceAllocator<Other>& other) const noexcept {
        return place == other.place;
    }
};

/// Number of the calling thread in the run that it works for.
thread_local int asio_thread = 0;

/// Threads that run one io_context; the calling thread is the first of them. Asio has no graphs: a counter per task shows when it is ready,
/// and the thread that finishes the last task of a cycle calls the controller. Handlers are in memory of the run, one place per task, so
/// that nothing is allocated while it lasts. The pool runs without threads that the system refuses to start.
///
/// Proof that this is free of races: a task is posted by the one that takes its counter to zero (acquire and release), and the queue's lock
/// orders all writes before posting before the handler. Counters of a cycle are set by the thread that begins it, before it posts any task.
class Queue {
public:
    Queue(Run& run, const ExecutorOptions& options)
        : run_(run),
          options_(options),
          waits_(static_cast<std::size_t>(run.graph().size())),
          places_(waits_.size()),
          context_(options.threads) {}

    /// Runs `cycle` and all that follow.
    void run(int cycle) {
        const auto busy = boost::asio::require(context_.get_executor(), boost::asio::execution::outstanding_work.tracked);
        begin(cycle);
        const std::vector<std::jthread> others = start_others();
        work(0);
    }

private:
    struct Handler {
        using allocator_type = PlaceAllocator<std::byte>;
        Queue* queue;
        int task;
        [[nodiscard]] allocator_type get_allocator() const noexcept {
            return allocator_type(&queue->places_[static_cast<std::size_t>(task)]);
        }
        void operator()() const noexcept { queue->run_task(task); }
    };

    [[nodiscard]] std::vector<std::jthread> start_others() {
        std::vector<std::jthread> threads;
        threads.reserve(static_cast<std::size_t>(options_.threads));
        try {
            for (int number = 1; number < options_.threads; ++number) threads.emplace_back([this, number] { work(number); });
        } catch (const std::exception&) {
            // The system has no more threads for us: those that began suffice.
        }
        const int members = static_cast<int>(threads.size()) + 1;
        if (members < options_.threads) note_shortage(options_.threads, members);
        return threads;
    }
    void work(int number) {
        const Pin pin(options_.pin, processors_, number);
        const int before = std::exchange(asio_thread, number);  // a host's task may itself be one of another run
        context_.run();
        asio_thread = before;
    }

    void begin(int cycle) {
        const std::span<const int> tasks = run_.graph().topological(cycle);
        for (const int task : tasks) counter(task).store(run_.graph().predecessor_count(task), std::memory_order_relaxed);
        left_.store(static_cast<int>(tasks.size()), std::memory_order_relaxed);
        for (const int task : run_.graph().level(cycle, 0)) boost::asio::post(context_, Handler{this, task});
    }
    void run_task(int task) noexcept {
        run_.task(task, asio_thread);
        for (const int after : run_.graph().successors(task)) {
            if (counter(after).fetch_sub(1, std::memory_order_acq_rel) == 1) boost::asio::post(context_, Handler{this, after});
        }
        if (left_.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
        const int cycle = run_.decide(asio_thread);
        if (cycle == Controller::stop)
            context_.stop();
        else
            begin(cycle);
    }
    [[nodiscard]] std::atomic<int>& counter(int task) noexcept { return waits_[static_cast<std::size_t>(task)]; }

    Run& run_;
    const ExecutorOptions& options_;
    Processors processors_;
    std::vector<std::atomic<int>> waits_;  ///< [task] predecessors that have not finished
    std::vector<Place> places_;            ///< [task]
    std::atomic<int> left_{0};             ///< tasks of the cycle that have not finished
    boost::asio::io_context context_;      ///< last: it may still hold handlers, whose places must be there
};

constexpr Way asio_pool{"asio_pool", [](Run& run, const ExecutorOptions& options, int first) { Queue(run, options).run(first); }};

constexpr auto make_asio_pool = make<asio_pool>;

}  // namespace
#else
constexpr std::nullptr_t make_asio_pool = nullptr;
#define BOOST_LIB_VERSION ""
#endif

Runtime asio_runtime() {
    std::string version = BOOST_LIB_VERSION;  // 1_74
    std::ranges::replace(version, '_', '.');
    return {version.empty() ? "" : "Boost " + version,
            {{.name = "asio_pool",
              .description = "Boost.Asio: a pool of threads, tasks posted when they are ready",
              .parallel = true,
              .waiting = Waiting::fixed,
              .needs = "Boost.Asio (Debian: libboost-dev)",
              .make = make_asio_pool}}};
}

}  // namespace cvtflow::bench
