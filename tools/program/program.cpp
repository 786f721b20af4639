#include "tools/program/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/schema.hpp"
#include "model/kernels/available_isas.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tools/program/front.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {
namespace {

std::string version_text() {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("{} {} ({})\nbuilt with {} as {} for {}\nrunning on {}, {} core{}, {}", program_name(), here.version, here.commit,
                       here.compiler, here.build_type, here.instruction_set, here.cpu, here.cores, here.cores == 1 ? "" : "s", here.os);
}

/// Whether the word is a command; else prints the closest one. (CLI11 would report an unexpected argument.)
bool is_command(const Program& program, const std::string& word) {
    std::vector<std::string> names;
    for (const Command& command : program.commands) names.emplace_back(command.name);
    const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
    if (has(word.c_str())) return true;
    for (const auto& [command, all] : {std::pair{"run", &tasks::ready_scenes}, {"batch", &tasks::ready_sweeps}}) {
        const auto ready = has(command) ? all() : std::vector<tasks::ReadyScene>{};
        if (std::none_of(ready.begin(), ready.end(), [&](const tasks::ReadyScene& each) { return each.name == word; })) continue;
        print_error(fmt::format("no command '{0}', did you mean '{1} {2} {0}'? ({1} --help)", word, program.name, command));
        return false;
    }
    const std::string near = engine::closest(word, names);
    print_error(fmt::format("no command '{}'{} ({} --help, or {} {})", word, near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                            program.name, program.other, word));
    return false;
}

/// Sets CVTFLOW_ISA, which every later model and child process reads.
void choose_isa(const std::string& name) {
    try {
        const model::Isa isa = model::isa_named(name);
        setenv("CVTFLOW_ISA", std::string(model::name_of(isa)).c_str(), 1);
    } catch (const std::invalid_argument& error) {
        throw CLI::ValidationError("--isa", error.what());
    }
}

/// The option closest to an unknown one in CLI11's message; empty if none is close.
std::string near_option(const CLI::App& command, const std::string& message) {
    const auto begin = message.find(" --");
    if (begin == std::string::npos) return {};
    const std::string word = message.substr(begin + 1, message.find_first_of(" =", begin + 1) - begin - 1);
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return engine::closest(word, names);
}

/// "--set KEY VALUE" in two words: how it is written in one. Empty for other mistakes.
std::string split_setting(const CLI::App& command, const std::string& message) {
    const CLI::Option* set = command.get_option_no_throw("--set");
    const auto colon = message.rfind(": ");
    if (set == nullptr || colon == std::string::npos) return {};
    for (const std::string& setting : set->results())
        if (setting.find('=') == std::string::npos) return fmt::format("--set {}=\"{}\"", setting, message.substr(colon + 2));
    return {};
}

/// CLI11 reports --help and --version as errors with code 0.
int report_parse_error(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const auto chosen = app.get_subcommands();
    const bool unknown = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
    std::string near = unknown && !chosen.empty() ? near_option(*chosen.front(), error.what()) : std::string{};
    if (unknown && !chosen.empty() && near.empty()) near = split_setting(*chosen.front(), error.what());
    const bool checks = !chosen.empty() && chosen.front()->get_name() == "check";
    if (unknown && near.empty() && !checks && std::string_view(error.what()).ends_with("--dry-run")) near = "cvtflow check";
    print_error(fmt::format("{}{} ({} {}--help)", error.what(), near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                            program_name(), chosen.empty() ? "" : chosen.front()->get_name() + " "));
    return static_cast<int>(ExitStatus::usage);
}

/// Runs the chosen command.
int act(const CLI::App& app, const Program& program, const std::vector<Action>& actions) {
    const CLI::App& chosen = *app.get_subcommands().front();  // the only one
    const auto command = std::ranges::find(program.commands, chosen.get_name(), &Command::name);
    const ExitStatus status = actions[static_cast<std::size_t>(command - program.commands.begin())]();
    const CLI::Option* quiet = chosen.get_option_no_throw("--quiet");
    if (quiet == nullptr || quiet->count() == 0) print_notices();
    return static_cast<int>(status);
}

std::vector<std::string> words_given;

/// Hands a command of Python's over to it, and run with an accuracy; --isa may stand before or behind the command. Returns for every other
/// command line.
void become_python_for(const Program& program, int argc, char** argv) {
    std::vector<std::string>& words = words_given;
    std::string isa;
    for (int k = 1; k < argc; ++k) {
        const std::string word = argv[k];
        if (word == "--isa" && k + 1 < argc)
            isa = argv[++k];
        else if (word.starts_with("--isa="))
            isa = word.substr(std::string_view("--isa=").size());
        else
            words.push_back(word);
    }
    const auto command = std::ranges::find(program.commands, words.empty() ? "" : words.front(), &Command::name);
    const bool tunes = !words.empty() && words.front() == "run" &&
                       std::ranges::any_of(words, [](const std::string& word) { return word.starts_with("--accuracy"); });
    if (command == program.commands.end() || (command->declare != nullptr && !tunes)) return;
    if (!isa.empty()) choose_isa(isa);
    become_python(words);
}

int execute(const Program& program, int argc, char** argv) {
    CLI::App app(std::string(program.description) + ".", std::string(program.name));
    app.set_version_flag("--version", version_text, "Print version, build and machine");
    app.require_subcommand(1);
    app.add_option_function<std::string>("--isa", choose_isa,
                                         "Instruction set of the kernels: baseline, avx2, avx512 (default: the processor's best)")
        ->type_name("NAME");
    app.get_formatter()->column_width(32);
    std::vector<Action> actions;
    for (const Command& command : program.commands) {
        CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.description) + ".");
        sub->group(std::string(command.group));
        sub->fallthrough();  // --isa may follow the command
        actions.push_back(command.declare == nullptr ? Action() : command.declare(*sub));
    }
    app.footer(fmt::format("{} COMMAND --help describes a command. First steps:\n{}\n\n{}", program.name, program.first_steps,
                           exit_status_table()));
    if (argc > 1 && argv[1][0] != '-' && !is_command(program, argv[1])) return static_cast<int>(ExitStatus::usage);
    try {
        become_python_for(program, argc, argv);
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return report_parse_error(app, error);
    }
    return act(app, program, actions);
}

}  // namespace

std::span<const std::string> given_words() noexcept { return words_given; }

int run_program(const Program& program, int argc, char** argv) noexcept {
    take_standard_descriptors();
    engine::disable_hdf5_atexit();
    name_program(program.name);
    return finish_output(guarded([&] { return execute(program, argc, argv); }));
}

}  // namespace cvtflow::tools
