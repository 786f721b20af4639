/// Methods that take friction apart.

#include <algorithm>

#include "tasks/method/friction/index.hpp"
#include "tasks/method/friction/staged/friction_leapfrog.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

using Numbers = std::vector<double>;

void add(double factor, const double* from, int count, double* to) {
    for (int k = 0; k < count; ++k) to[k] += factor * from[k];
}

/// One step of friction on the links' velocities: what is given, and what comes out.
struct LinkKick {
    const double* velocity;      ///< h v at the start
    const double* frictionless;  ///< h² a by everything but friction
    const double* change;        ///< of it since the step before
    const double* grip;          ///< h² a by friction, of what does not change within the step
    const double* drift;         ///< what is added to it over the step by the sheaves' motion
    double* result;              ///< h v at the end
    double* mean;                ///< mean velocity in the sense of friction's impulse
    double mean_time = 0.0;      ///< mean time of it, from the middle
};

/// Friction of the step at hand.
class Kicker {
public:
    virtual ~Kicker() = default;
    [[nodiscard]] virtual bool prepare(const LinearChain& chain, double h) = 0;
    virtual void kick(LinkKick& kick) = 0;

protected:
    Kicker() = default;
    Kicker(const Kicker&) = default;
    Kicker& operator=(const Kicker&) = default;
};

class ExplicitKicker final : public Kicker {
public:
    explicit ExplicitKicker(Kick kind) : tables_(kind) {}
    bool prepare(const LinearChain& chain, double h) override {
        chain_ = &chain;
        h_ = h;
        table_ = tables_.reaching(FrictionLeapfrog<double>::margin * chain.stiffest_friction() * h);
        for (Numbers& slot : states_) slot.resize(at(chain.link_velocities()));
        for (Numbers& slot : slopes_) slot.resize(at(chain.link_velocities()));
        return table_ != nullptr;
    }
    void kick(LinkKick& k) override {
        const int count = chain_->link_velocities();
        std::copy_n(k.velocity, count, states_[0].begin());
        std::fill_n(k.mean, count, 0.0);
        k.mean_time = 0.0;
        Numbers v(at(count));
        for (int stage = 0; stage < table_->plan.stages(); ++stage) {
            const engine::PlanStep row = table_->plan.stage(stage);
            combine(row, v.data());
            if (row.keep >= 0) states_[at(row.keep)] = v;
            Numbers& slope = slopes_[at(row.slope)];
            std::copy_n(k.frictionless, count, slope.begin());
            add(table_->extrapolation(row.time, 1.0), k.change, count, slope.data());
            add(1.0, k.grip, count, slope.data());
            add(row.time - 0.5, k.drift, count, slope.data());
            chain_->add_link_friction(h_, v.data(), slope.data());
            const double weight = table_->weights[at(stage)];
            add(weight, v.data(), count, k.mean);
            k.mean_time += weight * (row.time - 0.5);
        }
        combine(table_->plan.result(), k.result);
    }

private:
    void combine(const engine::PlanStep& row, double* out) const {
        const int count = chain_->link_velocities();
        std::fill_n(out, count, 0.0);
        for (const engine::Term& term : row.states) add(term.factor, states_[at(term.slot)].data(), count, out);
        for (const engine::Term& term : row.slopes) add(term.factor, slopes_[at(term.slot)].data(), count, out);
    }

    const KickTables tables_;
    const LinearChain* chain_ = nullptr;
    const KickTable* table_ = nullptr;
    double h_ = 0.0;
    std::array<Numbers, kick_state_slots> states_;
    std::array<Numbers, kick_slope_slots> slopes_;
};

class ImplicitKicker final : public Kicker {
public:
    explicit ImplicitKicker(DirkTable table) : table_(std::move(table)) {}
    bool prepare(const LinearChain& chain, double h) override {
        chain_ = &chain;
        h_ = h;
        solver_ = chain.friction_solver(table_.gamma * h);
        slopes_.assign(table_.times.size(), Numbers(at(chain.link_velocities())));
        return true;
    }
    void kick(LinkKick& k) override {
        const int count = chain_->link_velocities();
        std::fill_n(k.mean, count, 0.0);
        k.mean_time = 0.0;
        for (int stage = 0; stage < static_cast<int>(table_.times.size()); ++stage) {
            const double time = table_.times[at(stage)] - 0.5;
            Numbers& slope = slopes_[at(stage)];
            std::copy_n(k.frictionless, count, slope.begin());
            add(table_.extrapolation(stage, 1.0), k.change, count, slope.data());
            add(1.0, k.grip, count, slope.data());
            add(time, k.drift, count, slope.data());
            Numbers right(k.velocity, k.velocity + count);
            for (int other = 0; other < stage; ++other)
                add(table_.weights[at(stage)][at(other)], slopes_[at(other)].data(), count, right.data());
            add(table_.gamma, slope.data(), count, right.data());
            solver_->solve(right.data(), k.result);
            if (stage + 1 < static_cast<int>(table_.times.size())) chain_->add_link_friction(h_, k.result, slope.data());
            add(table_.weight(stage), k.result, count, k.mean);
            k.mean_time += table_.weight(stage) * time;
        }
    }

private:
    const DirkTable table_;
    const LinearChain* chain_ = nullptr;
    double h_ = 0.0;
    std::unique_ptr<LinearSolver> solver_;
    std::vector<Numbers> slopes_;
};

/// (q, h v, h² a of the step before, frictionless of the step before, h v of the sheaves in its middle).
class Leapfrog final : public StepMap {
public:
    Leapfrog(const LinearChain& chain, std::unique_ptr<Kicker> kicker)
        : chain_(chain), kicker_(std::move(kicker)), n_(chain.coordinates()), m_(chain.velocities()), links_(chain.link_velocities()) {
        for (Numbers* field : {&middle_, &velocity_, &frictionless_, &change_, &grip_, &drift_, &surface_, &mean_, &pulleys_})
            field->assign(at(m_), 0.0);
    }
    bool prepare(double h) override {
        h_ = h;
        return kicker_->prepare(chain_, h);
    }
    int size() const noexcept override { return n_ + 2 * m_ + links_ + (m_ - links_); }
    void step(const double* from, double* to) override {
        const double *q = from, *v = from + n_, *rate = v + m_, *frictionless_before = rate + m_,
                     *sheaves_before = frictionless_before + links_;
        double *q_end = to, *v_end = to + n_, *rate_end = v_end + m_, *frictionless_end = rate_end + m_,
               *sheaves_end = frictionless_end + links_;
        for (int k = 0; k < n_; ++k) middle_[at(k)] = q[k] + 0.5 * v[k];
        for (int k = 0; k < m_; ++k) velocity_[at(k)] = v[k] + 0.5 * rate[k];
        forces_in_the_middle(frictionless_before, sheaves_before);
        LinkKick kick{v, frictionless_.data(), change_.data(), grip_.data(), drift_.data(), v_end, mean_.data()};
        kicker_->kick(kick);
        close(kick, v, v_end);
        for (int k = 0; k < n_; ++k) q_end[k] = q[k] + 0.5 * (v[k] + v_end[k]);
        for (int k = 0; k < m_; ++k) rate_end[k] = v_end[k] - v[k];
        std::copy_n(frictionless_.begin(), links_, frictionless_end);
        std::copy(velocity_.begin() + links_, velocity_.end(), sheaves_end);
    }

private:
    void forces_in_the_middle(const double* frictionless_before, const double* sheaves_before) {
        for (Numbers* field : {&frictionless_, &grip_, &drift_, &surface_}) std::fill(field->begin(), field->end(), 0.0);
        chain_.add_frictionless(h_ * h_, middle_.data(), frictionless_.data());
        chain_.add_damping(h_, velocity_.data(), frictionless_.data());
        for (int k = 0; k < links_; ++k) change_[at(k)] = frictionless_[at(k)] - frictionless_before[k];
        chain_.add_sliding(h_ * h_, middle_.data(), grip_.data());
        std::copy(velocity_.begin() + links_, velocity_.end(), surface_.begin() + links_);
        chain_.add_surface_friction(h_, surface_.data(), grip_.data());
        for (int k = links_; k < m_; ++k) surface_[at(k)] -= sheaves_before[k - links_];
        chain_.add_surface_friction(h_, surface_.data(), drift_.data());
    }
    /// Pulleys, with the mean reaction of friction.
    void close(const LinkKick& kick, const double* v, double* v_end) {
        std::fill(pulleys_.begin(), pulleys_.end(), 0.0);
        chain_.add_reaction(h_, mean_.data(), pulleys_.data());
        for (int k = links_; k < m_; ++k)
            v_end[k] = v[k] + frictionless_[at(k)] + grip_[at(k)] + kick.mean_time * drift_[at(k)] + pulleys_[at(k)];
    }

    const LinearChain& chain_;
    const std::unique_ptr<Kicker> kicker_;
    const int n_, m_, links_;
    double h_ = 0.0;
    Numbers middle_, velocity_, frictionless_, change_, grip_, drift_, surface_, mean_, pulleys_;
};

/// Friction of links by links' velocities is solved for, everything else is explicit.
class Additive final : public StepMap {
public:
    Additive(const LinearChain& chain, AdditiveTable table)
        : chain_(chain), table_(std::move(table)), n_(chain.coordinates()), m_(chain.velocities()), links_(chain.link_velocities()) {
        slopes_.assign(at(table_.stages()), Numbers(at(n_ + m_)));
        friction_.assign(at(table_.stages()), Numbers(at(m_)));
    }
    bool prepare(double h) override {
        h_ = h;
        solver_ = chain_.friction_solver(table_.gamma * h);
        return true;
    }
    int size() const noexcept override { return n_ + m_; }
    void step(const double* from, double* to) override {
        Numbers y(at(n_ + m_));
        std::copy_n(from, n_ + m_, to);
        for (int stage = 0; stage < table_.stages(); ++stage) {
            std::copy_n(from, n_ + m_, y.begin());
            for (int other = 0; other < stage; ++other) {
                const double explicit_weight = table_.explicit_part[at(stage)][at(other)];
                add(explicit_weight, slopes_[at(other)].data(), n_ + m_, y.data());
                add(table_.implicit_part[at(stage)][at(other)] - explicit_weight, friction_[at(other)].data(), links_, y.data() + n_);
            }
            if (stage > 0) solve(y);
            evaluate(stage, y);
            add(table_.weights[at(stage)], slopes_[at(stage)].data(), n_ + m_, to);
        }
    }

private:
    /// Friction with the sheaves and the normal forces of the stage, of which only links' velocities are unknown.
    void solve(Numbers& y) const {
        Numbers friction(at(m_), 0.0), surface(y.begin() + n_, y.end());
        std::fill_n(surface.begin(), links_, 0.0);
        chain_.add_friction(h_, surface.data(), friction.data());
        chain_.add_sliding(h_ * h_, y.data(), friction.data());
        Numbers right(y.begin() + n_, y.begin() + n_ + links_);
        add(table_.gamma, friction.data(), links_, right.data());
        solver_->solve(right.data(), y.data() + n_);
    }
    void evaluate(int stage, const Numbers& y) {
        Numbers& slope = slopes_[at(stage)];
        std::copy_n(y.begin() + n_, n_, slope.begin());
        std::fill(slope.begin() + n_, slope.end(), 0.0);
        chain_.add_elastic(h_ * h_, y.data(), slope.data() + n_);
        chain_.add_damping(h_, y.data() + n_, slope.data() + n_);
        chain_.add_friction(h_, y.data() + n_, slope.data() + n_);
        std::fill(friction_[at(stage)].begin(), friction_[at(stage)].end(), 0.0);
        chain_.add_friction(h_, y.data() + n_, friction_[at(stage)].data());
        chain_.add_sliding(h_ * h_, y.data(), friction_[at(stage)].data());
    }

    const LinearChain& chain_;
    const AdditiveTable table_;
    const int n_, m_, links_;
    double h_ = 0.0;
    std::unique_ptr<LinearSolver> solver_;
    std::vector<Numbers> slopes_, friction_;  ///< [stage]; of the whole, and of friction alone, of which links' rows are used
};

}  // namespace

std::unique_ptr<StepMap> leapfrog_step(const LinearChain& chain, Kick kick) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<ExplicitKicker>(kick));
}

std::unique_ptr<StepMap> leapfrog_step(const LinearChain& chain, const DirkTable& table) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<ImplicitKicker>(table));
}

std::unique_ptr<StepMap> additive_step(const LinearChain& chain, const AdditiveTable& table) {
    return std::make_unique<Additive>(chain, table);
}

}  // namespace cvtflow::tasks
