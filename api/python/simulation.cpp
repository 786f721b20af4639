#include "api/python/bind.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace cvtflow::python {

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Advances until `end` without the lock. @return wall time [s]
double advance_released(Simulation& simulation, double end) {
    const Released released;
    const auto begin = std::chrono::steady_clock::now();
    simulation.advance_to(end);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void advance_to(Stepper& self, const Quantity& time) {
    const double until = in_si(time, "time", "s");
    for (bool there = false; !there;) {
        const double begin = self.simulation.time();
        const double intervals = std::max(1.0, std::floor(self.pace * between_checks / self.interval));
        const double end = (std::floor(begin / self.interval + 1e-9) + intervals) * self.interval;
        there = !(end < until);
        const double wall = advance_released(self.simulation, there ? until : end);
        const double covered = self.simulation.time() - begin;
        if (covered > 0.0 && wall > 0.0) self.pace = covered / wall;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
}

[[nodiscard]] std::unique_ptr<Stepper> create_simulation(const SceneLike& given, Threads threads, int segments) {
    const Scene scene = scene_of(given);
    const Released released;
    return std::make_unique<Stepper>(Stepper{Simulation(scene, threads, segments), threads, segments});
}

[[nodiscard]] std::unique_ptr<Stepper> copy(const Stepper& self) {
    const Released released;
    return std::make_unique<Stepper>(Stepper{self.simulation.copy(), self.threads, self.segments, self.interval, self.pace});
}

/// An input itself, or its name.
[[nodiscard]] Input input_of(const py::object& which) {
    if (!py::isinstance<py::str>(which)) return which.cast<Input>();
    const py::dict members = py::type::of<Input>().attr("__members__");
    if (members.contains(which)) return members[which].cast<Input>();
    const auto meant = by_python("_scene", "suggestion")(which, members).cast<std::string>();
    throw Error(ErrorCode::argument, "input: there is no '" + which.cast<std::string>() + "'" + meant);
}

/// Values of the inputs that the scene has, by name.
[[nodiscard]] py::dict inputs(const Stepper& self) {
    py::dict values;
    for (const auto& [name, member] : py::dict(py::type::of<Input>().attr("__members__"))) {
        try {
            values[name] = self.simulation.input(member.cast<Input>());
        } catch (const Error& error) {
            if (error.code() != ErrorCode::argument) throw;
        }
    }
    return values;
}

[[nodiscard]] py::array_t<double> unknowns(const Stepper& self) {
    const std::span<const double> now = self.simulation.unknowns();
    return py::array_t<double>(static_cast<py::ssize_t>(now.size()), now.data());
}

/// Takes lists, and arrays of numbers that are doubles without loss; not dates, which a cast would make numbers of.
[[nodiscard]] Array rhs(Stepper& self, double t, const py::array_t<double, py::array::c_style>& x) {
    if (x.ndim() != 1) throw py::type_error("rhs: x is one row of numbers");
    Array out(x.size());
    const std::span from(x.data(), static_cast<std::size_t>(x.size()));
    const std::span to(out.mutable_data(), static_cast<std::size_t>(out.size()));
    const Released released;
    self.simulation.rhs(t, from, to);
    return out;
}

void set_input(Stepper& self, const py::object& which, const Quantity& value) {
    const Input input = input_of(which);
    const InputInfo info = input_info(input);
    self.simulation.set_input(input, in_si(value, std::string(info.name), std::string(info.unit)));
}

[[nodiscard]] std::vector<Column> channel_infos(const Stepper& self) {
    std::vector<Column> rows;
    for (std::size_t index = 0; index < self.simulation.channels(); ++index) {
        const ChannelInfo info = self.simulation.channel_info(index);
        rows.push_back({std::string(info.name), std::string(info.unit), std::string(info.description), info.width});
    }
    return rows;
}

/// A view that cannot be written to and keeps the simulation alive.
[[nodiscard]] py::array_t<double> channel(const py::object& object, const std::string& name) {
    auto& self = object.cast<Stepper&>();
    const std::span<const double> now = self.simulation.channel(name);
    py::array_t<double> view(static_cast<py::ssize_t>(now.size()), now.data(), object);
    view.attr("setflags")(py::arg("write") = false);
    return view;
}

void on_output(const py::object& object, const Quantity& interval, const std::optional<py::function>& callback) {
    std::function<void(Simulation&)> call;
    if (callback) call = [self = py::handle(object), report = locked(*callback)](Simulation&) { report(self); };
    object.cast<Stepper&>().simulation.on_output(in_si(interval, "interval", "s"), std::move(call));
}

void on_transition(const py::object& object, const std::optional<py::function>& callback) {
    std::function<void(Simulation&, const Transition&)> call;
    if (callback) call = [self = py::handle(object), report = locked(*callback)](Simulation&, const Transition& now) { report(self, now); };
    object.cast<Stepper&>().simulation.on_transition(std::move(call));
}

/// A question that the simulation answers, by value.
template <class Answer>
[[nodiscard]] auto ask(Answer (Simulation::*question)() const) {
    return [question](const Stepper& self) { return (self.simulation.*question)(); };
}

using Class = py::class_<Stepper>;

void bind_time(Class& type) {
    type.def(py::init(&create_simulation), py::arg("scene"), py::arg_v("threads", Threads::caller(), "Threads.caller()"),
             py::arg("segments") = 0, "Prepares the start state of a scene: a Scene, the name of a ready one, or a file. Starts no thread.")
        .def("copy", &copy, "A second simulation in the same state, without the callbacks.")
        .def_property_readonly("scene", ask(&Simulation::scene), "The scene.")
        .def_property_readonly(
            "threads", [](const Stepper& self) { return self.threads; }, "As given.")
        .def_readonly("segments", &Stepper::segments, "As given.")
        .def_property_readonly("time", ask(&Simulation::time), "Time [s]; negative while a start settles.")
        .def_property_readonly("method", ask(&Simulation::method),
                               "The method of its steps, never \"auto\": what run.method = \"auto\" is with this scene.")
        .def_property_readonly("step_length", ask(&Simulation::step_length), "Length of a step without transitions [s].")
        .def(
            "advance_to", &advance_to, py::arg("time"),
            "Takes whole steps until self.time >= time (\"1 ms\"; numbers are in s), without the interpreter's lock. Ctrl-C ends it "
            "between "
            "two steps, and the simulation can be continued. Raises a Fault, CancelledError, BusyError; ArgumentError for a time more than "
            "a step back.")
        .def(
            "step", [](Stepper& self) { self.simulation.step(); }, py::call_guard<Released>(), "One step, which a transition may shorten.")
        .def(
            "cancel", [](Stepper& self) { self.simulation.cancel(); }, "Ends advance_to() of another thread after at most one step.")
        .def(
            "largest_stable_step", [](Stepper& self) { return self.simulation.largest_stable_step(); }, py::call_guard<Released>(),
            "Longest step with which the method is linearly stable here [s].");
}

void bind_state(Class& type) {
    type.def("state", ask(&Simulation::state), "The full integration state.")
        .def(
            "set_state", [](Stepper& self, const State& state) { self.simulation.set_state(state); }, py::arg("state"),
            "Raises StateError for the state of another scene.")
        .def("hash", ask(&Simulation::hash), "Hash of unknowns and phases, to compare states bitwise.")
        .def("set_input", &set_input, py::arg("input"), py::arg("value"),
             "Sets an input, given as Input or by name, to a number in SI or a text with a unit.")
        .def(
            "input", [](const Stepper& self, const py::object& input) { return self.simulation.input(input_of(input)); }, py::arg("input"),
            "Present value, as set or from the scene's table, in its SI unit.")
        .def("inputs", &inputs, "All inputs that the scene has, by name.")
        .def("size", ask(&Simulation::size), "Number of unknowns.")
        .def("unknowns", &unknowns, "The unknowns now [size]; a copy, since steps move them in memory.")
        .def("rhs", &rhs, py::arg("time"), py::arg("x"), "dx/dt at (time, x) [size]; depends on these and on the inputs only.");
}

void bind_sight(Class& type) {
    type.def_property_readonly(
            "channels", [](const py::object& self) { return by_python("_channels", "of_simulation")(self); },
            "Present values of the channels, by name: channels[\"slip\"] is a number, channels[\"links/tension\"] an array, channels.info "
            "their units.")
        .def("_channel_infos", &channel_infos, "Of all channels.")
        .def("channel", &channel, py::arg("name"),
             "Values of a channel now [width]: a view without a copy, which changes with the next read after a step.")
        .def("counters", ask(&Simulation::counters), "Counters since the start.")
        .def("energy", ask(&Simulation::energy), "Energy balance, and whether results are reliable.")
        .def("notices", ask(&Simulation::notices), "Warnings, one line each.")
        .def("on_output", &on_output, py::arg("interval"), py::arg("callback"),
             "callback(simulation) after the first step at or after every multiple of interval (\"10 us\"; numbers are in s); None removes "
             "it. A callback that refers to its simulation keeps both alive until it is removed.")
        .def("on_transition", &on_transition, py::arg("callback"), "callback(simulation, transition); None removes it.");
}

void bind_threads(py::module_& module) {
    py::class_<Threads>(module, "Threads", "Threads of a simulation; they do not affect results.")
        .def_static("caller", &Threads::caller, "The calling thread only.")
        .def_static("current_arena", &Threads::current_arena, py::arg("slots"), "The oneTBB arena in which the call is made.")
        .def_static("private_arena", &Threads::private_arena, py::arg("threads") = 0,
                    "Threads of this simulation, the caller included; 0: all.")
        .def_property_readonly(
            "way", [](const Threads& threads) { return static_cast<int>(threads.way()); }, "0 caller, 1 current_arena, 2 private_arena.")
        .def_property_readonly("count", &Threads::count, "Number of threads.");
}

void bind_inputs(py::module_& module) {
    py::enum_<Input> type(module, "Input",
                          "Inputs that a host may set between steps; a set value replaces the scene's table from then on.");
    for (int number = 0;; ++number) {
        try {
            const InputInfo info = input_info(static_cast<Input>(number));
            type.value(info.name.data(), static_cast<Input>(number),
                       (std::string(info.description) + " [" + info.unit.data() + "]").c_str());
        } catch (const Error&) {  // the last one was before
            break;
        }
    }
}

void bind_figures(py::module_& module) {
    py::class_<Counters>(module, "Counters", "Counters since the start; after settling, since t = 0.")
        .def_readonly("steps", &Counters::steps, "accepted steps, truncated ones included")
        .def_readonly("evaluations", &Counters::evaluations, "evaluations of the right-hand side")
        .def_readonly("transitions", &Counters::transitions, "changes of a tip's phase")
        .def_readonly("truncated", &Counters::truncated, "steps cut at a transition")
        .def_readonly("suppressed", &Counters::suppressed, "transitions postponed because the tip had just changed");
    py::class_<Energy>(module, "Energy", "Energy balance, and whether results are reliable.")
        .def_readonly("residual", &Energy::residual, "change of the stored energy - work of the inputs + losses [J]")
        .def_readonly("dissipated", &Energy::dissipated, "energy dissipated [J]")
        .def_readonly("suspicion", &Energy::suspicion, "|residual| over its tolerance [1]")
        .def_readonly("reliable", &Energy::reliable, "`suspicion` <= 1");
    py::class_<Transition>(module, "Transition", "A change of a tip's phase: 0 free, 1 touching, 2 sticking, 3 slipping.")
        .def_readonly("time", &Transition::time, "time [s]")
        .def_readonly("pin", &Transition::pin, "counted from 0")
        .def_readonly("tip", &Transition::tip, "4 link + 2 (front half) + (side +z)")
        .def_readonly("phase_from", &Transition::from, "phase before")
        .def_readonly("phase_to", &Transition::to, "phase after");
}

[[nodiscard]] State state_from(const py::bytes& bytes) {
    const std::string_view text = bytes;
    return State::from_bytes(std::as_bytes(std::span(text.data(), text.size())));
}

[[nodiscard]] py::bytes bytes_of(const State& state) { return {reinterpret_cast<const char*>(state.bytes().data()), state.bytes().size()}; }

void bind_states(py::module_& module) {
    py::class_<State>(module, "State", "The full integration state, including inputs that were set; set_state(state()) continues bitwise.")
        .def_static("from_bytes", &state_from, py::arg("bytes"), "Raises StateError for damaged bytes, or those of another version.")
        .def("bytes", &bytes_of, "The state as bytes.")
        .def("__eq__", [](const State& one, const State& other) { return one == other; })
        .def(py::pickle([](const State& state) { return py::make_tuple(bytes_of(state)); },
                        [](const py::tuple& kept) { return state_from(kept[0].cast<py::bytes>()); }));
}

}  // namespace

void bind_simulation(py::module_& module) {
    bind_threads(module);
    bind_inputs(module);
    bind_figures(module);
    bind_states(module);
    Class type(module, "Simulation", "One simulation of one scene. Used by one thread at a time; a process may have any number of them.",
               py::dynamic_attr());
    bind_time(type);
    bind_state(type);
    bind_sight(type);
}

}  // namespace cvtflow::python
