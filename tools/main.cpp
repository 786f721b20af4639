#include <cstdio>
#include <fmt/format.h>
#include "tasks/run.hpp"
int main(int argc, char** argv) {
    using namespace cvtflow::tasks;
    try {
    std::vector<std::string> sets(argv + 3, argv + argc);
    Scene scene = read_scene(argv[1]);
    set_values(scene, sets);
    RunOptions o;
    o.file = argv[2];
    if (o.file == "-") o.file = "";
    if (o.file.ends_with("state.h5")) { settle_scene(scene, o.file, {}); return 0; }
    fmt::print("{}", summary(run_scene(scene, o)));
    } catch (const std::exception& e) { fmt::print("{}\n", e.what()); return 1; }
}
