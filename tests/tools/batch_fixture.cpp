#include "tests/tools/batch_fixture.hpp"

#include <sys/wait.h>

#include <cstdlib>

namespace cvtflow::tools {

void Sweeps::write_sweep(const std::string& torques, const std::string& until, const std::string& more) const {
    write("sweep.toml", "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"" + until +
                            "\"\nrun.step = \"50 ns\"\nstart.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\"\n[[axes]]\nkey = "
                            "\"load.torque\"\nvalues = [" +
                            torques +
                            "]\n[[axes]]\nkey = \"clamping.driven\"\nfrom = \"5 kN\"\nto = \"6 kN\"\ncount = 4\n[outputs]\n"
                            "scalars = [\"slip mean\", \"tight_tension max\", \"ratio at 20 us\"]\n[start]\nmode = \"settle\"\n" +
                            more);
}

Outcome Sweeps::batch(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"batch", "sweep.toml", "-o", "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
}

engine::CaseTable Sweeps::table(const std::string& folder) const { return engine::read_cases((folder_ / folder / "cases.h5").string()); }

std::string Sweeps::hash_in(const std::string& text) {
    const auto at = text.find("results hash");
    return at == std::string::npos ? "none" : text.substr(text.find_first_not_of(' ', at + 12), 16);
}

std::map<long, std::string> Sweeps::column(const std::string& name, const std::string& folder) const {
    const engine::CaseTable all = table(folder);
    std::map<long, std::string> cells;
    for (std::size_t row = 0; row < all.size(); ++row) {
        const long number = all.layout.integer(all.row(row), all.layout.column("case"));
        EXPECT_TRUE(cells.emplace(number, all.layout.cell(all.row(row), all.layout.column(name))).second)
            << "case " << number << " is there twice";
    }
    return cells;
}

Outcome Sweeps::shell(const std::string& line) const {
    const std::string command =
        "cd '" + folder_.string() + "' && export CVTFLOW='" CVTFLOW_PROGRAM "' && (" + line + ") > shell.out 2> shell.err";
    const int status = std::system(("bash -c \"" + command + "\"").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read("shell.out"), read("shell.err")};
}

}  // namespace cvtflow::tools
