/// Small types: threads, inputs, counters, energy, states.

#include "api/python/bind.hpp"

namespace cvtflow::python {

namespace {

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
        .def_property_readonly(
            "phase_from", [](const Transition& change) { return change.from; }, "phase before")
        .def_property_readonly(
            "phase_to", [](const Transition& change) { return change.to; }, "phase after");
}

[[nodiscard]] State state_from(const py::bytes& bytes) {
    const std::string_view text = bytes;
    return State::from_bytes(std::as_bytes(std::span(text.data(), text.size())));
}

[[nodiscard]] py::bytes bytes_of(const State& state) { return {reinterpret_cast<const char*>(state.bytes().data()), state.bytes().size()}; }

}  // namespace

void bind_values(py::module_& module) {
    bind_threads(module);
    bind_inputs(module);
    bind_figures(module);
    py::class_<State>(module, "State", "The full integration state, including inputs that were set; set_state(state()) continues bitwise.")
        .def_static("from_bytes", &state_from, py::arg("bytes"), "Raises StateError for damaged bytes, or those of another version.")
        .def("bytes", &bytes_of, "The state as bytes.")
        .def("__eq__", [](const State& one, const State& other) { return one == other; })
        .def(py::pickle([](const State& state) { return py::make_tuple(bytes_of(state)); },
                        [](const py::tuple& kept) { return state_from(kept[0].cast<py::bytes>()); }));
}

}  // namespace cvtflow::python
