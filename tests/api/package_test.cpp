/// The installed package as strangers use it: a fresh CMake project, pkg-config, another prefix, and sources inside a host's project.

#include <gmock/gmock.h>
#include <cvtflow/version.hpp>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "command_fixture.hpp"
#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

namespace fs = std::filesystem;

class Package : public testing::Test {
protected:
    Package() : folder_(fs::temp_directory_path() / ("cvtflow_package_" + std::to_string(getpid()))) { fs::create_directories(folder_); }
    ~Package() override { fs::remove_all(folder_); }

    /// Standard output and error of a command, which must succeed; $SOURCE and $BUILD are the folders of sources and of the build.
    std::string run(const std::string& command) const {
        const std::string folders = "export SOURCE='" CVTFLOW_SOURCE_DIR "' BUILD='" CVTFLOW_BINARY_DIR "'; ";
        const auto [status, output] = output_of("cd '" + folder_.string() + "' && { " + folders + command + "; }");
        EXPECT_EQ(status, 0) << command << "\n" << output;
        return output;
    }
    /// Installs into p. Other tests get a copy under the same path.
    void install() const {
        if (fs::exists(kept)) return void(run("cp -a '" + kept.string() + "' p"));
        run("cmake --install \"$BUILD\" --prefix \"$PWD/p\" && cp -a p '" + kept.string() + "'");
    }
    static void TearDownTestSuite() { fs::remove_all(kept); }

    /// Output of the scripts of `cmake --install` into p with another build folder, in which nothing was built but these files.
    std::string install_of(const std::string& files) const {
        const std::string scripts =
            "find . -name cmake_install.cmake -o -path '*/Export/*.cmake' -o -name 'cvtflow*.cmake' -o -name cvtflow.pc";
        run("mkdir b && (cd \"$BUILD\" && tar -cf - $(" + scripts + ")) | tar -xf - -C b && cp -a \"$BUILD\"/" + files + " b");
        run("sed -i \"s|$BUILD|$PWD/b|g\" $(find b -name cmake_install.cmake)");
        run("mkdir -p lib/python3 && ln -s \"$SOURCE/api/python\" lib/python3/dist-packages");  // where a program in b finds the package
        return run("cmake -DCMAKE_INSTALL_PREFIX=$PWD/p -P b/cmake_install.cmake");
    }

    fs::path folder_;
    static inline const fs::path kept = fs::temp_directory_path() / ("cvtflow_installed_" + std::to_string(getpid()));
};

TEST_F(Package, IsFoundAndUsedByAFreshProjectAlsoAfterItWasMoved) {
    install();
    fs::rename(folder_ / "p", folder_ / "moved");
    run("cmake -S \"$SOURCE/tests/api/consumer\" -B b -G Ninja -DCMAKE_PREFIX_PATH=$PWD/moved -DCMAKE_CXX_COMPILER=" CVTFLOW_CXX
        " -DCMAKE_C_COMPILER=" CVTFLOW_CC);
    run("cmake --build b");
    EXPECT_THAT(run("b/consumer_cpp"), testing::HasSubstr("t = -0.009999 s, 1032 unknowns"));
    EXPECT_THAT(run("b/consumer_c"), testing::HasSubstr("1032 unknowns"));
    std::ifstream file(folder_ / "b/program.txt");
    std::string program;
    std::getline(file, program);
    EXPECT_EQ(program, (folder_ / "moved/bin/cvtflow").string());
    EXPECT_THAT(run(program + " check baseline"), testing::HasSubstr((folder_ / "moved/share/cvtflow/scenes/baseline.toml").string()));
    run(program + " run tiny --until '20 us' -q -o r.h5 && mkdir -m 777 theirs");
    // A user without rights, HOME or this environment, in another locale; then without an interpreter, or one without libraries.
    const std::string user =
        std::string(geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "") + "env -i LC_ALL=de_DE.UTF-8 ";
    EXPECT_THAT(run("cd theirs && for to in plot:svg plot:png report:html; do " + user + program + " ${to%:*} ../r.h5 -o r.${to#*:}; done"),
                testing::StartsWith("r.svg\nr.png\nr.html ("));
    run("printf '#!/bin/sh\\nexec /usr/bin/python3 -S \"$@\"\\n' > bare && chmod 755 bare");
    for (const std::string& python : {std::string("/none"), folder_.string() + "/bare"})
        for (const char* what : {" plot ../r.h5 -o n.svg", " report ../r.h5 -o n.html"})
            EXPECT_THAT(run("cd theirs && ! " + user + "CVTFLOW_PYTHON=" + python + " " + program + what),
                        testing::MatchesRegex("cvtflow: [^\n]*apt-get install python3[^\n]*\n"));
}

TEST_F(Package, IsFoundByPkgConfig) {
    install();
    const std::string config = run("dirname $(find p -name cvtflow.pc)");
    const std::string with = "export PKG_CONFIG_PATH=" + config.substr(0, config.size() - 1) + "; ";
    EXPECT_EQ(run(with + "pkg-config --modversion cvtflow"), CVTFLOW_PROJECT_VERSION "\n");
    run(with + CVTFLOW_CC
        " -std=c11 -Wall -Wextra -pedantic -Werror \"$SOURCE/tests/api/consumer/main.c\" -o c $(pkg-config --cflags --libs cvtflow) "
        "$(pkg-config --variable=rpath cvtflow)");
    EXPECT_THAT(run("./c"), testing::HasSubstr("1032 unknowns")) << "linked as the page of embedding does";
    EXPECT_THAT(run(with + "ls $(pkg-config --variable=scenesdir cvtflow)"), testing::HasSubstr("tiny.toml"));
}

/// Scenes and simulations alone, for hosts that have none of the libraries of the whole: static and shared, by pkg-config; deep: by CMake,
/// too.
TEST_F(Package, OfTheCoreNeedsNoLibraryButThoseOfCxx) {
    run("cmake --install \"$BUILD\" --component core --prefix first && mv first p");
    const std::string config = run("dirname $(find p -name cvtflow-core.pc)");
    const std::string with = "export PKG_CONFIG_PATH=" + config.substr(0, config.size() - 1) + "; ";
    run("mkdir -p c/b");
    std::vector<std::string> programs{"c/b/static", "c/b/shared"};
    const std::string compile = with + CVTFLOW_CXX " -std=c++20 $(pkg-config --cflags cvtflow-core) \"$SOURCE/examples/core_host.cpp\" ";
    run(compile + "$(pkg-config --variable=static cvtflow-core) -o c/b/static");
    run(compile + "$(pkg-config --libs cvtflow-core) $(pkg-config --variable=rpath cvtflow-core) -o c/b/shared");
    if (is_deep()) {
        run("printf 'cmake_minimum_required(VERSION 3.25)\nproject(c CXX)\nfind_package(cvtflow " + std::to_string(CVTFLOW_VERSION_MAJOR) +
            "." + std::to_string(CVTFLOW_VERSION_MINOR) +
            " REQUIRED COMPONENTS core)\nforeach(kind core core_shared)\nadd_executable(by_${kind} "
            "$ENV{SOURCE}/examples/core_host.cpp)\ntarget_link_libraries(by_${kind} cvtflow::${kind})\nendforeach()\n' > c/CMakeLists.txt");
        run("cmake -S c -B c/b -G Ninja -DCMAKE_PREFIX_PATH=$PWD/p -DCMAKE_CXX_COMPILER=" CVTFLOW_CXX " && cmake --build c/b");
        programs.insert(programs.end(), {"c/b/by_core", "c/b/by_core_shared"});
    }
    const std::string expected = run("c/b/static \"$SOURCE/scenes/tiny.toml\"");
    EXPECT_THAT(expected, testing::HasSubstr("slip"));
    for (const std::string& program : programs) {
        EXPECT_EQ(run(program + " \"$SOURCE/scenes/tiny.toml\""), expected) << program;
        EXPECT_EQ(run("ldd " + program + " | grep -vE 'linux-vdso|ld-linux|lib(c|m|gcc_s|stdc[+][+]|cvtflow-core)[.]so' || true"), "")
            << program;
    }
    EXPECT_EQ(run("find p -name recording.hpp -o -name 'libcvtflow.so*'"), "") << "what is not in it";
}

/// Pages refer to one another by relative paths, which a reader follows in the installed folder.
TEST_F(Package, HoldsPagesAndExamplesWhoseLinksLead) {
    install();
    const fs::path pages = folder_ / "p/share/doc/cvtflow";
    for (const char* file : {"README.md", "docs/tutorial.md", "docs/fmi.md", "model/EQUATIONS.md", "examples/host_threads.cpp",
                             "examples/python/first_simulation.ipynb", "examples/CMakeLists.txt"})
        EXPECT_TRUE(fs::exists(pages / file)) << file;
    EXPECT_FALSE(fs::exists(pages / "docs/site")) << "what makes HTML of the pages";
    const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\))");
    int links = 0;
    for (const fs::path& folder : {pages, pages / "docs"}) {
        for (const fs::directory_entry& page : fs::directory_iterator(folder)) {
            if (page.path().extension() != ".md" || page.path().filename() == "CONTRIBUTING.md") continue;
            const std::string text = run("cat '" + page.path().string() + "'");
            for (std::sregex_iterator found(text.begin(), text.end(), link), end; found != end; ++found, ++links)
                EXPECT_TRUE(fs::exists(folder / (*found)[1].str())) << page.path() << ": " << (*found)[1];
        }
    }
    EXPECT_GT(links, 60);
}

TEST_F(Package, OfAProgramAloneNamesWhatWasNotBuilt) {
    const std::string output = install_of("cvtflow");
    for (const char* target : {"cvtflow_library", "cvtflow_manual"})
        EXPECT_THAT(output, testing::HasSubstr("/b' --target " + std::string(target) + ")"));
    EXPECT_THAT(run("p/bin/cvtflow check tiny"), testing::HasSubstr("share/cvtflow/scenes/tiny.toml"));
    EXPECT_THAT(run("p/bin/cvtflow run tiny --until '20 us' -q -o r.h5 && ! p/bin/cvtflow plot r.h5 slip -o r.png"),
                testing::HasSubstr("install cvtflow completely"));
    EXPECT_EQ(run("ls p/include p/lib/*/libcvtflow* 2>/dev/null || true"), "");
}

TEST_F(Package, OfALibraryAloneNamesWhatWasNotBuilt) {
    const std::string output = install_of("libcvtflow.so*");
    for (const char* target : {"cvtflow", "cvtflow_manual"})
        EXPECT_THAT(output, testing::HasSubstr("/b' --target " + std::string(target) + ")"));
    run(std::string("mkdir c && printf 'cmake_minimum_required(VERSION 3.25)\nproject(c C CXX)\nfind_package(cvtflow ") +
        std::to_string(CVTFLOW_VERSION_MAJOR) + "." + std::to_string(CVTFLOW_VERSION_MINOR) +
        " REQUIRED COMPONENTS cpp c)\n"
        "add_executable(c $ENV{SOURCE}/tests/api/consumer/main.c)\ntarget_link_libraries(c cvtflow::c)\n' > c/CMakeLists.txt");
    run("cmake -S c -B c/b -G Ninja -DCMAKE_PREFIX_PATH=$PWD/p -DCMAKE_C_COMPILER=" CVTFLOW_CC " && cmake --build c/b");
    EXPECT_THAT(run("c/b/c"), testing::HasSubstr("1032 unknowns"));
    EXPECT_EQ(run("ls p/bin 2>/dev/null || true"), "");
}

/// An empty element is the current folder for the loader, so that libraries that lie there run as code; a relative one likewise.
TEST_F(Package, SearchesNoEmptyOrRelativeFolderForLibraries) {
    install();
    const std::string paths = run(R"(find "$BUILD" p -type f \( -perm -u+x -o -name '*.so*' \) -not -path '*/CMakeFiles/*' |
        while read -r file; do readelf -d "$file" 2>/dev/null | sed -nE "s|.*\(R(UN)?PATH\).*\[(.*)\]|$file\t\2|p"; done)");
    EXPECT_THAT(paths, testing::HasSubstr("test_api\t" CVTFLOW_BINARY_DIR)) << "programs are found";
    const std::regex line("([^\t]+)\t(.*)\n");
    for (std::sregex_iterator found(paths.begin(), paths.end(), line), end; found != end; ++found) {
        std::istringstream elements((*found)[2].str() + ":");
        for (std::string element; std::getline(elements, element, ':');)
            EXPECT_TRUE(element.starts_with("/") || element.starts_with("$ORIGIN/")) << (*found)[1] << ": '" << (*found)[2] << "'";
    }
}

/// Checks for overwritten stacks and tables of functions are on; sanitizers replace them.
TEST_F(Package, IsHardened) {
    if (std::string(CVTFLOW_SANITIZER) != "") GTEST_SKIP() << "sanitizers have checks of their own";
    install();
    for (const std::string file : {"p/bin/cvtflow", "$(find p -name 'libcvtflow.so.*' -type f)"}) {
        EXPECT_THAT(run("readelf -Wd " + file), testing::AnyOf(testing::HasSubstr("BIND_NOW"), testing::HasSubstr("Flags: NOW"))) << file;
        EXPECT_THAT(run("readelf -Wl " + file), testing::HasSubstr("GNU_RELRO")) << file;
        EXPECT_THAT(run("readelf -Ws " + file), testing::HasSubstr("__stack_chk_fail")) << file;
    }
    EXPECT_THAT(run("readelf -Wh p/bin/cvtflow"), testing::HasSubstr("Type:                              DYN")) << "position-independent";
}

TEST_F(Package, RunsNoLibraryFromTheWorkingFolder) {
    install();
    run("echo '__attribute__((constructor)) static void foreign(void) { __builtin_puts(\"foreign code runs\"); }' > foreign.c "
        "&& " CVTFLOW_CC " -shared -fPIC foreign.c -o foreign");
    for (const std::string program : {"\"$BUILD/cvtflow\"", "p/bin/cvtflow", "\"$BUILD/cvtflow-lab\""}) {
        if (program.ends_with("-lab\"") && !fs::exists(CVTFLOW_BINARY_DIR "/cvtflow-lab")) continue;  // only in a build of the laboratory
        const std::string names = run("ldd " + program + " | awk '{print $1}' | grep -E '^lib(fmt|z|tbb|hdf5|gomp)'");
        EXPECT_THAT(names, testing::HasSubstr("libfmt.so."));
        run("for name in $(ldd " + program + " | awk '{print $1}' | grep '^lib'); do cp foreign $name; done");
        EXPECT_THAT(run(program + " --version"), testing::Not(testing::HasSubstr("foreign"))) << program;
    }
}

TEST_F(Package, HoldsThePythonPackageAlsoAfterItWasMoved) {
    install();
    fs::rename(folder_ / "p", folder_ / "moved");
    const std::string with =
        "env -u LD_LIBRARY_PATH PYTHONPATH=$(dirname $(dirname $(find moved -path '*/cvtflow/_library.py'))) " CVTFLOW_PYTHON " ";
    EXPECT_THAT(run(with + "-c 'import cvtflow; print(cvtflow.Simulation(cvtflow.Scene.ready(\"tiny\")), cvtflow.__file__)'"),
                testing::AllOf(testing::HasSubstr("1032 unknowns"), testing::HasSubstr("moved/lib")));
    if (!is_deep()) return;
    EXPECT_THAT(run(with + "\"$SOURCE/examples/python/eight_simulations.py\" 0.05"), testing::HasSubstr("load  18.0 N m"));
}

TEST_F(Package, HoldsNoHeaderOfThirdPartiesAndNothingOfTheInside) {
    install();
    const std::string text = run("cat p/include/cvtflow/*");
    for (const char* party : {"Eigen", "hdf5", "tbb/", "fmt/", "nlohmann", "toml", "model/", "engine/", "tasks/"}) {
        EXPECT_EQ(text.find("#include <" + std::string(party)), std::string::npos) << party;
        EXPECT_EQ(text.find("#include \"" + std::string(party)), std::string::npos) << party;
    }
    EXPECT_EQ(run("find p -type d -name cvtflow | grep -vE '(packages|/lib|-gnu)/cvtflow$' | wc -l"),
              "4\n")
        << "include, lib/cmake, share, share/doc; besides the Python package and what FMUs are made of";
}

TEST_F(Package, IsAFolderInAHostsProject) {
    run("cmake -S \"$SOURCE/tests/api/subdirectory\" -B b -G Ninja -DCVTFLOW_SOURCE=\"$SOURCE\" -DCMAKE_CXX_COMPILER=" CVTFLOW_CXX
        " -DCMAKE_C_COMPILER=" CVTFLOW_CC);
}

using NightlyPackage = Package;

TEST_F(NightlyPackage, IsBuiltAsAFolderInAHostsProject) {
    run("cmake -S \"$SOURCE/tests/api/subdirectory\" -B b -G Ninja -DCVTFLOW_SOURCE=\"$SOURCE\" -DCMAKE_CXX_COMPILER=" CVTFLOW_CXX
        " -DCMAKE_C_COMPILER=" CVTFLOW_CC);
    run("cmake --build b");
    EXPECT_THAT(run("b/host"), testing::HasSubstr("1032 unknowns"));
}

TEST_F(NightlyPackage, BuildsTheExamplesAgainstTheInstallation) {
    install();
    run("cmake -S \"$SOURCE/examples\" -B b -G Ninja -DCMAKE_PREFIX_PATH=$PWD/p -DCMAKE_BUILD_TYPE=Release "
        "-DCMAKE_CXX_COMPILER=" CVTFLOW_CXX " -DCMAKE_C_COMPILER=" CVTFLOW_CC);
    run("cmake --build b");
    EXPECT_THAT(run("b/host_openmp 3"), testing::HasSubstr("the same bits"));
    EXPECT_THAT(run("b/host_threads 2 3"), testing::HasSubstr("clamping"));
}

}  // namespace
}  // namespace cvtflow::host
