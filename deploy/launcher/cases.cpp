#include "deploy/launcher/cases.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "deploy/launcher/external_program.hpp"
#include "proto/report/failure.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::launcher {
namespace {

const std::string bench_prefix = "bench-";

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> benchmark_names(const Installation& installation) {
  std::vector<std::string> names;
  for (const std::string& name : names_in(installation.programs)) {
    if (name.starts_with(bench_prefix)) names.push_back(name.substr(bench_prefix.size()));
  }
  return names;
}

std::filesystem::path validation_script(const Installation& installation, const std::string& name) {
  return installation.sources / "tests" / "validation" / name / "validate.py";
}

std::vector<std::string> validation_names(const Installation& installation) {
  std::vector<std::string> names = names_in(installation.sources / "tests" / "validation");
  std::erase_if(names,
                [&](const auto& name) { return !std::filesystem::exists(validation_script(installation, name)); });
  return names;
}

void refuse_unless_known(const std::string& verb, const std::string& name, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  throw report::SceneError(verb + " " + name, "there is none of this name",
                           scene::suggestion(name, names, "the names are"));
}

/// The first line of the docstring that a script begins with.
std::string about_script(const std::filesystem::path& script) {
  std::ifstream file(script);
  for (std::string line; std::getline(file, line);) {
    const std::size_t begin = line.find("\"\"\"");
    if (begin == std::string::npos) continue;
    const std::size_t end = line.find("\"\"\"", begin + 3);
    return line.substr(begin + 3, end == std::string::npos ? end : end - begin - 3);
  }
  return "";
}

void print_line(const std::string& name, const std::string& about) {
  std::printf("%-24s %s\n", name.c_str(), about.substr(0, about.find('\n')).c_str());
}

std::vector<std::string> join(std::vector<std::string> command, const std::vector<std::string>& arguments) {
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace

void list_benchmarks(const Installation& installation) {
  const std::vector<std::string> names = benchmark_names(installation);
  if (names.empty())
    throw report::FileError(installation.programs.string(), "no benchmark was built", "build all targets");
  for (const std::string& name : names) {
    print_line(name, run_and_catch({installation.program(bench_prefix + name), "--about"}).output);
  }
}

void run_benchmark(const Installation& installation, const std::string& name,
                   const std::vector<std::string>& arguments) {
  refuse_unless_known("bench", name, benchmark_names(installation));
  become_program(join({installation.program(bench_prefix + name)}, arguments));
}

void list_validations(const Installation& installation) {
  for (const std::string& name : validation_names(installation)) {
    print_line(name, about_script(validation_script(installation, name)));
  }
}

void run_validation(const Installation& installation, const std::string& name,
                    const std::vector<std::string>& arguments) {
  refuse_unless_known("validate", name, validation_names(installation));
  become_program(join({installation.python, validation_script(installation, name).string(), "--couplet",
                       installation.program("couplet")},
                      arguments));
}

}  // namespace couplet::launcher
