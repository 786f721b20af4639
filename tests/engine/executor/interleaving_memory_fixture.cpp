/// Atomics and cells of the machine of interleaving_fixture.hpp.

#include <algorithm>
#include <cstdlib>

#include "interleaving_fixture.hpp"

namespace cvtflow::engine::test {

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
    if (stores_.size() == max_atomics) std::abort();  // a fixture of our own: enlarge it
    stores_.push_back({Store{value, {}, {}}});
    return static_cast<int>(stores_.size()) - 1;
}

std::uint64_t ModelMemory::see(int atomic, std::size_t which, bool acquires) {
    Sight& own = self();
    const auto a = static_cast<std::size_t>(atomic);
    const Store& store = stores_[a][which];
    own.view[a] = std::max(own.view[a], static_cast<std::uint16_t>(which));
    own.seen[a] = static_cast<std::uint16_t>(which);
    own.read |= bit(a);
    if (acquires) join(own.clock, store.clock), join(own.view, store.view);
    machine_.note(" sees atomic ", atomic, store.value);
    return store.value;
}

/// @param continues a release sequence of the store before
void ModelMemory::put(int atomic, std::uint64_t value, bool releases, bool continues) {
    Sight& own = self();
    std::vector<Store>& stores = stores_[static_cast<std::size_t>(atomic)];
    Store store{value, {}, {}};
    if (continues) store.clock = stores.back().clock, store.view = stores.back().view;
    own.view[static_cast<std::size_t>(atomic)] = static_cast<std::uint16_t>(stores.size());
    if (releases) join(store.clock, own.clock), join(store.view, own.view);
    stores.push_back(store);
    ++own.clock[static_cast<std::size_t>(machine_.running())];
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
    Sight& own = self();
    machine_.announce({Pending::Kind::rest, -1, 0, own.read});
    for (std::size_t atomic = 0; atomic < stores_.size(); ++atomic) {
        if ((own.read & bit(atomic)) != 0) own.view[atomic] = static_cast<std::uint16_t>(stores_[atomic].size() - 1);
    }
    own.read = 0;
}

int ModelMemory::add_cell() {
    cells_.emplace_back();
    return static_cast<int>(cells_.size()) - 1;
}

void ModelMemory::touch(int cell, bool write) {
    Sight& own = self();
    const auto me = static_cast<std::size_t>(machine_.running());
    Cell& it = cells_[static_cast<std::size_t>(cell)];
    bool race = it.writer >= 0 && own.clock[static_cast<std::size_t>(it.writer)] < it.written;
    for (std::size_t reader = 0; write && reader < it.read.size(); ++reader) race = race || own.clock[reader] < it.read[reader];
    machine_.note(write ? " writes cell " : " reads cell ", cell, 0);
    if (race) machine_.leave("race at the last of these:");
    if (write) {
        it.writer = machine_.running(), it.written = own.clock[me];
    } else {
        it.read[me] = own.clock[me];
    }
}

}  // namespace cvtflow::engine::test
