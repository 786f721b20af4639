/// The machine of interleaving_fixture.hpp: its interleavings, its atomics and cells.

#include "interleaving_fixture.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace cvtflow::engine::test {
namespace {

constexpr std::size_t stack_size = std::size_t{64} << 10;
constexpr long max_operations = 2000;  // of one interleaving: more and a worker goes round for ever

std::string place_of(const Place& where) {
    std::string name = where.function;
    name = name.substr(0, name.find('('));
    return name.substr(name.find_last_of(": ") + 1) + ":" + std::to_string(where.line);
}

std::uint64_t atomics_of(const Pending& pending) {
    return pending.kind == Pending::Kind::rest ? pending.seen : std::uint64_t{1} << pending.atomic;
}

bool independent(const Pending& a, const Pending& b) {
    const bool modifies = a.kind == Pending::Kind::modify || b.kind == Pending::Kind::modify;
    return !modifies || (atomics_of(a) & atomics_of(b)) == 0;
}

}  // namespace

Interleavings::Interleavings(const Options& options, const Make& make) : options_(options), make_(make) {
    for (Worker& worker : workers_) worker.stack.resize(stack_size);
}

Interleavings::Outcome Interleavings::explore(const Options& options, const Make& make) {
    const auto machine = std::unique_ptr<Interleavings>(new Interleavings(options, make));
    now_ = machine.get();
    do {
        machine->run_one();
        if (machine->outcome_.interleavings > options.most) machine->outcome_.fault = "more interleavings than allowed";
    } while (machine->outcome_.fault.empty() && machine->backtrack());
    for (const Met& each : machine->met_) machine->outcome_.sites.push_back(each.site);
    now_ = nullptr;
    return machine->outcome_;
}

void Interleavings::run_one() {
    depth_ = 0, operations_ = 0, asleep_ = 0, running_ = no_worker;
    left_ = pruned_ = false;
    memory_.clear();
    deeds_.clear();
    scenario_ = make_();
    for (int worker = 0; worker < options_.workers; ++worker) begin(worker);
    if (const int first = choose_worker(); first >= 0) {
        running_ = first;
        swapcontext(&main_, &workers_[static_cast<std::size_t>(first)].context);
    }
    if (pruned_ || left_) return;
    ++outcome_.interleavings;
    outcome_.longest = std::max(outcome_.longest, operations_);
    if (std::string fault = scenario_->fault(); !fault.empty()) outcome_.fault = fault + story();
}

/// Runs a worker up to its first operation.
void Interleavings::begin(int worker) {
    Worker& started = workers_[static_cast<std::size_t>(worker)];
    started.absences = 0;
    getcontext(&started.context);
    started.context.uc_stack.ss_sp = started.stack.data();
    started.context.uc_stack.ss_size = started.stack.size();
    started.context.uc_link = nullptr;
    makecontext(&started.context, reinterpret_cast<void (*)()>(&Interleavings::entry), 1, static_cast<unsigned>(worker));  // NOLINT
    running_ = no_worker - 1 - worker;                                                                                     // it begins
    swapcontext(&main_, &started.context);
}

void Interleavings::entry(unsigned worker) {
    Interleavings& machine = now();
    machine.scenario_->work(static_cast<int>(worker));
    machine.self().pending = {Pending::Kind::ended};
    machine.pass_on();
}

/// Proceeds to the next interleaving. Returns false if there is none.
bool Interleavings::backtrack() {
    while (!choices_.empty()) {
        Choice& last = choices_.back();
        if (last.of_worker) last.asleep |= 1U << last.options[last.taken];
        if (++last.taken < last.options.size()) return true;
        choices_.pop_back();
    }
    return false;
}

void Interleavings::leave(const char* fault) {
    outcome_.fault = fault + story();
    left_ = true;
    swapcontext(&self().context, &main_);
}

int Interleavings::pick(int possibilities) {
    if (possibilities == 1) return 0;
    if (depth_ == choices_.size()) {
        Choice choice;
        for (int option = 0; option < possibilities; ++option) choice.options.push_back(option);
        choices_.push_back(std::move(choice));
    }
    const Choice& choice = choices_[depth_++];
    return choice.options[choice.taken];
}

bool Interleavings::may_leave() {
    if (running_ < 0 || self().absences == options_.absences || pick(2) == 0) return false;
    ++self().absences;
    return true;
}

/// @return -1: nothing is left to try, or all have ended, or none can continue
int Interleavings::choose_worker() {
    if (depth_ == choices_.size()) {
        Choice choice{true, {}, 0, asleep_};
        bool any = false;
        for (int worker = 0; worker < options_.workers; ++worker) {
            if (!memory_.enabled(worker, workers_[static_cast<std::size_t>(worker)].pending)) continue;
            any = true;
            if ((asleep_ & 1U << worker) == 0) choice.options.push_back(worker);
        }
        pruned_ = any && choice.options.empty();
        if (choice.options.empty()) return -1;
        choices_.push_back(std::move(choice));
    }
    const Choice& choice = choices_[depth_++];
    const int chosen = choice.options[choice.taken];
    asleep_ = 0;
    for (int worker = 0; worker < options_.workers; ++worker) {
        const bool slept = (choice.asleep & 1U << worker) != 0;
        if (slept && independent(workers_[static_cast<std::size_t>(worker)].pending, workers_[static_cast<std::size_t>(chosen)].pending))
            asleep_ |= 1U << worker;
    }
    return chosen;
}

/// The running worker is before an operation, or has ended: the chosen one continues.
void Interleavings::pass_on() {
    Worker& leaving = self();
    const int next = choose_worker();
    if (next == running_) return;
    if (next < 0) {
        const bool all = std::all_of(workers_.begin(), workers_.begin() + options_.workers,
                                     [](const Worker& each) { return each.pending.kind == Pending::Kind::ended; });
        if (!all && !pruned_) leave("workers wait for ever");
        swapcontext(&leaving.context, &main_);
    }
    running_ = next;
    swapcontext(&leaving.context, &workers_[static_cast<std::size_t>(next)].context);
}

void Interleavings::announce(Pending pending) {
    if (running_ < 0) {  // a worker that begins
        const auto worker = static_cast<std::size_t>(no_worker - 1 - running_);
        workers_[worker].pending = pending;
        swapcontext(&workers_[worker].context, &main_);
    } else {
        self().pending = pending;
        pass_on();
    }
    if (++operations_ > max_operations) leave("a worker goes round for ever");
}

Sabotage Interleavings::met(const Place& where, Site::Kind kind, bool orders) {
    for (Met& each : met_) {
        if (each.line == where.line && std::string_view(each.function) == where.function) return each.sabotage;
    }
    const std::string place = place_of(where);
    met_.push_back({where.function, where.line, {place, kind, orders}, place == options_.place ? options_.sabotage : Sabotage::none});
    return met_.back().sabotage;
}

std::string Interleavings::story() const {
    std::string text;
    for (const Deed& deed : deeds_) {
        text += "\n  worker " + std::to_string(deed.worker) + deed.verb + std::to_string(deed.object) + ": " +
                std::to_string(deed.value >> 20) + "|" + std::to_string(deed.value & 0xfffff);
    }
    return text;
}

namespace {

bool acquires(std::memory_order order) { return order == std::memory_order_acquire || order == std::memory_order_acq_rel; }
bool releases(std::memory_order order) { return order == std::memory_order_release || order == std::memory_order_acq_rel; }

template <class Numbers>
void join(Numbers& to, const Numbers& from) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = std::max(to[i], from[i]);
}

std::uint64_t bit(std::size_t atomic) { return std::uint64_t{1} << atomic; }

}  // namespace

void ModelMemory::clear() {
    stores_.clear();
    cells_.clear();
    sights_.fill({});
    for (std::size_t worker = 0; worker < sights_.size(); ++worker) sights_[worker].clock[worker] = 1;
}

ModelMemory::Sight& ModelMemory::self() { return sights_[static_cast<std::size_t>(machine_.running())]; }

bool ModelMemory::enabled(int worker, const Pending& pending) const {
    if (pending.kind == Pending::Kind::change) return stores_[static_cast<std::size_t>(pending.atomic)].back().value != pending.old;
    if (pending.kind != Pending::Kind::rest) return pending.kind != Pending::Kind::ended;
    for (std::size_t atomic = 0; atomic < stores_.size(); ++atomic) {
        const bool news = stores_[atomic].size() - 1 > sights_[static_cast<std::size_t>(worker)].seen[atomic];
        if ((pending.seen & bit(atomic)) != 0 && news) return true;
    }
    return false;
}

int ModelMemory::add_atomic(std::uint64_t value) {
    if (stores_.size() == max_atomics) std::abort();  // this fixture is too small: enlarge it
    stores_.push_back({Store{value, {}, {}}});
    return static_cast<int>(stores_.size()) - 1;
}

std::uint64_t ModelMemory::see(int atomic, std::size_t which, bool acquires) {
    Sight& sight = self();
    const auto a = static_cast<std::size_t>(atomic);
    const Store& store = stores_[a][which];
    sight.view[a] = std::max(sight.view[a], static_cast<std::uint16_t>(which));
    sight.seen[a] = static_cast<std::uint16_t>(which);
    sight.read |= bit(a);
    if (acquires) join(sight.clock, store.clock), join(sight.view, store.view);
    machine_.note(" sees atomic ", atomic, store.value);
    return store.value;
}

/// @param continues a release sequence of the store before
void ModelMemory::put(int atomic, std::uint64_t value, bool releases, bool continues) {
    Sight& sight = self();
    std::vector<Store>& stores = stores_[static_cast<std::size_t>(atomic)];
    Store store{value, {}, {}};
    if (continues) store.clock = stores.back().clock, store.view = stores.back().view;
    sight.view[static_cast<std::size_t>(atomic)] = static_cast<std::uint16_t>(stores.size());
    if (releases) join(store.clock, sight.clock), join(store.view, sight.view);
    stores.push_back(store);
    ++sight.clock[static_cast<std::size_t>(machine_.running())];
    machine_.note(" sets atomic ", atomic, value);
}

std::size_t ModelMemory::pick_store(int atomic, const std::function<bool(std::uint64_t)>& allowed) {
    const auto a = static_cast<std::size_t>(atomic);
    std::vector<std::size_t> candidates;
    for (std::size_t which = newest(atomic) + 1; which-- > self().view[a];) {
        if (which == newest(atomic) || allowed(stores_[a][which].value)) candidates.push_back(which);
    }
    return candidates[static_cast<std::size_t>(machine_.pick(static_cast<int>(candidates.size())))];
}

std::uint64_t ModelMemory::load(int atomic, std::memory_order order, const Place& where) {
    machine_.announce({Pending::Kind::load, atomic});
    const Sabotage sabotage = machine_.met(where, Site::Kind::load, acquires(order));
    return see(atomic, pick_store(atomic, [](std::uint64_t) { return true; }), acquires(order) && sabotage != Sabotage::relaxed);
}

void ModelMemory::store(int atomic, std::uint64_t value, std::memory_order order, const Place& where) {
    if (machine_.running() == Interleavings::no_worker) {
        stores_[static_cast<std::size_t>(atomic)].back().value = value;
        return;
    }
    machine_.announce({Pending::Kind::modify, atomic});
    const Sabotage sabotage = machine_.met(where, Site::Kind::store, releases(order));
    put(atomic, value, releases(order) && sabotage != Sabotage::relaxed, false);
}

/// The newest value, which has just been seen.
void ModelMemory::replace(int atomic, std::uint64_t value, std::memory_order order, Sabotage sabotage) {
    if (sabotage == Sabotage::torn) machine_.announce({Pending::Kind::modify, atomic});
    put(atomic, value, releases(order) && sabotage != Sabotage::relaxed, sabotage != Sabotage::torn);
}

std::uint64_t ModelMemory::add(int atomic, std::uint64_t change, std::memory_order order, const Place& where) {
    machine_.announce({Pending::Kind::modify, atomic});
    const Sabotage sabotage = machine_.met(where, Site::Kind::add, order != std::memory_order_relaxed);
    const std::uint64_t before = see(atomic, newest(atomic), acquires(order) && sabotage != Sabotage::relaxed);
    replace(atomic, before + change, order, sabotage);
    return before;
}

bool ModelMemory::swap(int atomic, std::uint64_t& expected, std::uint64_t value, std::memory_order order, const Place& where) {
    machine_.announce({Pending::Kind::modify, atomic});
    const Sabotage sabotage = machine_.met(where, Site::Kind::swap, order != std::memory_order_relaxed);
    const std::size_t which = pick_store(atomic, [&](std::uint64_t old) { return old != expected; });
    const std::uint64_t seen = see(atomic, which, acquires(order) && sabotage != Sabotage::relaxed);
    const bool equal = seen == expected;
    expected = seen;
    if (equal) replace(atomic, value, order, sabotage);
    return equal;
}

std::uint64_t ModelMemory::change(int atomic, std::uint64_t old, const Place& where) {
    machine_.announce({Pending::Kind::change, atomic, old});
    const Sabotage sabotage = machine_.met(where, Site::Kind::load, true);
    return see(atomic, pick_store(atomic, [&](std::uint64_t value) { return value != old; }), sabotage != Sabotage::relaxed);
}

void ModelMemory::rest() {
    Sight& sight = self();
    machine_.announce({Pending::Kind::rest, -1, 0, sight.read});
    for (std::size_t atomic = 0; atomic < stores_.size(); ++atomic) {
        if ((sight.read & bit(atomic)) != 0) sight.view[atomic] = static_cast<std::uint16_t>(stores_[atomic].size() - 1);
    }
    sight.read = 0;
}

int ModelMemory::add_cell() {
    cells_.emplace_back();
    return static_cast<int>(cells_.size()) - 1;
}

void ModelMemory::touch(int cell, bool write) {
    Sight& sight = self();
    const auto me = static_cast<std::size_t>(machine_.running());
    Cell& it = cells_[static_cast<std::size_t>(cell)];
    bool race = it.writer >= 0 && sight.clock[static_cast<std::size_t>(it.writer)] < it.written;
    for (std::size_t reader = 0; write && reader < it.read.size(); ++reader) race = race || sight.clock[reader] < it.read[reader];
    machine_.note(write ? " writes cell " : " reads cell ", cell, 0);
    if (race) machine_.leave("race at the last of these:");
    if (write) {
        it.writer = machine_.running(), it.written = sight.clock[me];
    } else {
        it.read[me] = sight.clock[me];
    }
}

}  // namespace cvtflow::engine::test
