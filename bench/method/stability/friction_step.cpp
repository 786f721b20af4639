/// Methods that take friction apart.

#include <algorithm>

#include "bench/method/product_names.hpp"
#include "bench/method/stability/step_map.hpp"
#include "tasks/method/friction/friction_leapfrog.hpp"

namespace cvtflow::bench {

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

/// Friction of the present step.
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
    explicit ExplicitKicker(const Kick& kick) : tables_(kick) {}
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

/// Backward Euler: the drift of the sheaves over half a step.
class BackwardEulerKicker final : public Kicker {
public:
    bool prepare(const LinearChain& chain, double h) override {
        solver_ = chain.friction_solver(h);
        right_.resize(at(chain.link_velocities()));
        return true;
    }
    void kick(LinkKick& k) override {
        const int count = static_cast<int>(right_.size());
        std::copy_n(k.velocity, count, right_.begin());
        add(1.0, k.frictionless, count, right_.data());
        add(1.0, k.grip, count, right_.data());
        k.mean_time = 0.5;
        add(k.mean_time, k.drift, count, right_.data());
        solver_->solve(right_.data(), k.result);
        std::copy_n(k.result, count, k.mean);
    }

private:
    std::unique_ptr<LinearSolver> solver_;
    Numbers right_;
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

}  // namespace

std::unique_ptr<StepMap> leapfrog_step(const LinearChain& chain, const Kick& kick) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<ExplicitKicker>(kick));
}

std::unique_ptr<StepMap> backward_euler_leapfrog_step(const LinearChain& chain) {
    return std::make_unique<Leapfrog>(chain, std::make_unique<BackwardEulerKicker>());
}

}  // namespace cvtflow::bench
