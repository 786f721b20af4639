#include "api/python/bind.hpp"

namespace cvtflow::python {

namespace {

template <class File>
[[nodiscard]] py::dict attributes_of(const File& self) {
    py::dict values;
    for (const auto& [name, value] : self.attributes()) values[name.c_str()] = value;
    return values;
}

[[nodiscard]] py::array_t<double> read(const Record& self, const std::string& channel, std::size_t first,
                                       std::optional<std::size_t> count) {
    std::size_t width = 1;
    for (const Column& row : self.channels()) {
        if (row.name == channel) width = row.width;
    }
    return array_of(self.read(channel, first, count.value_or(self.rows() - std::min(first, self.rows()))), width);
}

/// Structured; its type is registered here, because that needs NumPy, without which the module must load (pip builds without NumPy).
[[nodiscard]] py::array transitions(const Record& self) {
    static const bool registered = [] {
        PYBIND11_NUMPY_DTYPE_EX(Transition, time, "time", pin, "pin", tip, "tip", from, "phase_from", to, "phase_to");
        return true;
    }();
    static_cast<void>(registered);
    const std::vector<Transition> rows = self.transitions();
    return py::array_t<Transition>(static_cast<py::ssize_t>(rows.size()), rows.data());
}

[[nodiscard]] py::array_t<std::uint8_t> phases(const Record& self, std::size_t number) {
    const std::vector<std::uint8_t> row = self.phases(number);
    return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(row.size()), row.data());
}

/// Numbers as an array, texts as a list.
[[nodiscard]] py::object column(const Table& self, const std::string& name) {
    for (const Column& row : self.columns()) {
        if (row.name == name && row.text) return py::cast(self.texts(name));
    }
    return array_of(self.numbers(name));
}

[[nodiscard]] bool run(Sweep& self, const std::string& folder, int threads, const std::optional<py::function>& progress) {
    std::function<void(const SweepProgress&)> call;
    if (progress) call = locked(*progress);
    const Released released;
    return self.run(folder, threads, std::move(call));
}

void bind_sweep(py::module_& module) {
    py::class_<SweepProgress>(module, "SweepProgress", "Progress of a sweep.")
        .def_readonly("cases", &SweepProgress::cases, "all cases")
        .def_readonly("before", &SweepProgress::before, "cases done in earlier sessions")
        .def_readonly("done", &SweepProgress::done, "done now")
        .def_readonly("failed", &SweepProgress::failed, "cases done now with another status than ok")
        .def_readonly("wall", &SweepProgress::wall, "wall time [s]");
    py::class_<Sweep>(module, "SweepFile", "A sweep file, read and checked.")
        .def_static("read", &Sweep::read, py::arg("path"), "Raises SceneError with every problem in it.")
        .def_property_readonly("name", &Sweep::name, "Name of the sweep.")
        .def_property_readonly("cases", &Sweep::cases, "Number of cases.")
        .def("run", &run, py::arg("folder"), py::arg("threads") = 0, py::arg("progress") = py::none(),
             "Runs the cases that are missing in folder/cases.h5. False after cancel().")
        .def("cancel", &Sweep::cancel, "Requests the end of run() in another thread; running cases write checkpoints.");
}

/// A recording and the file that it leaves.
struct Recorder {
    Recording recording;
    std::string path;
};

[[nodiscard]] std::unique_ptr<Recorder> record(Stepper& stepper, const std::filesystem::path& path, bool replace) {
    return std::make_unique<Recorder>(Recorder{Recording(stepper.simulation, path.string(), replace), path.string()});
}

[[nodiscard]] py::object finish(Recorder& self, bool complete) {
    self.recording.finish(complete);
    return by_python("_results", "Record")(self.path);
}

void bind_recording(py::module_& module) {
    py::class_<Recorder>(module, "Recording", "The record of a simulation while it is advanced.")
        .def(py::init(&record), py::arg("simulation"), py::arg("path"), py::arg("replace") = false, py::keep_alive<1, 2>(),
             "Channels, states and transitions at the scene's run.output_interval from now on, as `cvtflow run` records them; no settling. "
             "Ends where a with-statement does, or with finish(). An existing file, or rows of a killed run in its .part, stay without "
             "replace.")
        .def("finish", &finish, py::arg("complete") = true, "Completes the file and returns its Record. Raises RecordError.")
        .def("__enter__", [](const py::object& self) { return self; })
        .def("__exit__",
             [](Recorder& self, const py::object& kind, const py::object&, const py::object&) { self.recording.finish(kind.is_none()); });
}

}  // namespace

void bind_records(py::module_& module) {
    py::class_<Column>(module, "Column", "A column of a table, or a channel over time.")
        .def_readonly("name", &Column::name, "e.g. shaft_1/torque")
        .def_readonly("unit", &Column::unit, "e.g. N*m; 1 for none")
        .def_readonly("description", &Column::description, "one sentence")
        .def_readonly("width", &Column::width, "numbers per row")
        .def_readonly("text", &Column::text, "whether it holds texts");
    py::class_<Record>(module, "RecordFile", "The record of a run, read on demand.")
        .def(py::init<const std::string&>(), py::arg("path"), "Raises RecordError.")
        .def_property_readonly("status", &Record::status, "finished, running, unreliable, cycle_missed: …, or the cause of an early end.")
        .def("attributes", &attributes_of<Record>, "Of the whole file, by name.")
        .def("channels", &Record::channels, "The recorded channels.")
        .def("rows", &Record::rows, "Number of rows when the file was opened.")
        .def("read", &read, py::arg("channel"), py::arg("first") = 0, py::arg("count") = py::none(),
             "Rows of a channel, or of \"time\" [s]: [count] or [count, width].")
        .def(
            "state_times", [](const Record& self) { return array_of(self.state_times()); }, "Times of the states recorded [s].")
        .def(
            "state", [](const Record& self, std::size_t number) { return array_of(self.state(number)); }, py::arg("number"),
            "Unknowns of a recorded state [unknowns].")
        .def("phases", &phases, py::arg("number"), "Phases of the tips in a recorded state [tips].")
        .def("transitions", &transitions, "All changes of a tip's phase, as an array with fields time, pin, tip, phase_from, phase_to.");
    py::class_<Table>(module, "Table", "Results of a sweep (cases.h5), in the order of cases.")
        .def(py::init<const std::string&>(), py::arg("path"), "Raises RecordError.")
        .def("attributes", &attributes_of<Table>, "Of the whole table, by name.")
        .def("columns", &Table::columns, "Names and units.")
        .def("rows", &Table::rows, "Number of cases.")
        .def("read", &column, py::arg("column"), "A column [rows]: an array of numbers, or a list of texts.");
    bind_sweep(module);
    bind_recording(module);
}

}  // namespace cvtflow::python
