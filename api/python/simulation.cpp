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

[[nodiscard]] std::unique_ptr<Stepper> create(const SceneLike& given, Threads threads, int segments) {
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

[[nodiscard]] Array rhs(Stepper& self, double t, const Array& x) {
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
    if (callback) {
        call = [self = py::handle(object), held = share(*callback)](Simulation&) {
            const py::gil_scoped_acquire lock;
            (*held)(self);
        };
    }
    object.cast<Stepper&>().simulation.on_output(in_si(interval, "interval", "s"), std::move(call));
}

void on_transition(const py::object& object, const std::optional<py::function>& callback) {
    std::function<void(Simulation&, const Transition&)> call;
    if (callback) {
        call = [self = py::handle(object), held = share(*callback)](Simulation&, const Transition& transition) {
            const py::gil_scoped_acquire lock;
            (*held)(self, transition);
        };
    }
    object.cast<Stepper&>().simulation.on_transition(std::move(call));
}

[[nodiscard]] double largest_stable_step(Stepper& self) {
    const Released released;
    return self.simulation.largest_stable_step();
}

void step(Stepper& self) {
    const Released released;
    self.simulation.step();
}

using Class = py::class_<Stepper>;

void bind_time(Class& type) {
    type.def(py::init(&create), py::arg("scene"), py::arg_v("threads", Threads::caller(), "Threads.caller()"), py::arg("segments") = 0,
             "Prepares the start state of a scene: a Scene, the name of a ready one, or a file. Starts no thread.")
        .def("copy", &copy, "A second simulation in the same state, without the callbacks.")
        .def_property_readonly(
            "scene", [](const Stepper& self) { return self.simulation.scene(); }, "The scene.")
        .def_property_readonly(
            "threads", [](const Stepper& self) { return self.threads; }, "As given.")
        .def_property_readonly(
            "segments", [](const Stepper& self) { return self.segments; }, "As given.")
        .def_property_readonly(
            "time", [](const Stepper& self) { return self.simulation.time(); }, "Time [s]; negative while a start settles.")
        .def_property_readonly(
            "method", [](const Stepper& self) { return self.simulation.method(); },
            "The method of its steps, never \"auto\": what run.method = \"auto\" is with this scene.")
        .def_property_readonly(
            "step_length", [](const Stepper& self) { return self.simulation.step_length(); }, "Length of a step without transitions [s].")
        .def("advance_to", &advance_to, py::arg("time"),
             "Takes whole steps until self.time >= time (\"1 ms\"; numbers are in s), without the interpreter's lock. Ctrl-C ends it "
             "between two steps, and the "
             "simulation can be continued. Raises a Fault, CancelledError, BusyError; ArgumentError for a time more than a step back.")
        .def("step", &step, "One step, which a transition may shorten.")
        .def(
            "cancel", [](Stepper& self) { self.simulation.cancel(); }, "Ends advance_to() of another thread after at most one step.")
        .def("largest_stable_step", &largest_stable_step, "Longest step with which the method is linearly stable here [s].");
}

void bind_state(Class& type) {
    type.def(
            "state", [](const Stepper& self) { return self.simulation.state(); }, "The full integration state.")
        .def(
            "set_state", [](Stepper& self, const State& state) { self.simulation.set_state(state); }, py::arg("state"),
            "Raises StateError for the state of another scene.")
        .def(
            "hash", [](const Stepper& self) { return self.simulation.hash(); }, "Hash of unknowns and phases, to compare states bitwise.")
        .def("set_input", &set_input, py::arg("input"), py::arg("value"),
             "Sets an input, given as Input or by name, to a number in SI or a text with a unit.")
        .def(
            "input", [](const Stepper& self, const py::object& input) { return self.simulation.input(input_of(input)); }, py::arg("input"),
            "Present value, as set or from the scene's table, in its SI unit.")
        .def("inputs", &inputs, "All inputs that the scene has, by name.")
        .def(
            "size", [](const Stepper& self) { return self.simulation.size(); }, "Number of unknowns.")
        .def("unknowns", &unknowns, "The unknowns now [size]; a copy, since steps move them in memory.")
        .def("rhs", &rhs, py::arg("time"), py::arg("x"), "dx/dt at (time, x) [size]; depends on these and on the inputs only.");
}

void bind_sight(Class& type) {
    type.def_property_readonly(
            "channels", [](const py::object& self) { return by_python("_channels", "of_simulation")(self); },
            "Present values of the channels, by name: channels[\"slip\"] is a number, channels[\"links/tension\"] an array, channels.info "
            "their "
            "units.")
        .def("_channel_infos", &channel_infos, "Of all channels.")
        .def("channel", &channel, py::arg("name"),
             "Values of a channel now [width]: a view without a copy, which changes with the next read after a step.")
        .def(
            "counters", [](const Stepper& self) { return self.simulation.counters(); }, "Counters since the start.")
        .def(
            "energy", [](const Stepper& self) { return self.simulation.energy(); }, "Energy balance, and whether results are reliable.")
        .def(
            "notices", [](const Stepper& self) { return self.simulation.notices(); }, "Warnings, one line each.")
        .def("on_output", &on_output, py::arg("interval"), py::arg("callback"),
             "callback(simulation) after the first step at or after every multiple of interval (\"10 us\"; numbers are in s); None removes "
             "it. A callback that refers "
             "to its simulation keeps both alive until it is removed.")
        .def("on_transition", &on_transition, py::arg("callback"), "callback(simulation, transition); None removes it.");
}

}  // namespace

void bind_simulation(py::module_& module) {
    Class type(module, "Simulation", "One simulation of one scene. Used by one thread at a time; a process may have any number of them.",
               py::dynamic_attr());
    bind_time(type);
    bind_state(type);
    bind_sight(type);
}

}  // namespace cvtflow::python
