#pragma once
// The verbs `bench` and `validate`: lists of what there is, and handing over to one of them.

#include <string>
#include <vector>

#include "deploy/launcher/installation.hpp"

namespace couplet::launcher {

/// Benchmarks are the programs bench-NAME beside the launcher; each says in one line what it measures when asked
/// --about.
void list_benchmarks(const Installation& installation);
[[noreturn]] void run_benchmark(const Installation& installation, const std::string& name,
                                const std::vector<std::string>& arguments);

/// Validation cases are tests/validation/NAME/validate.py; the first line of its docstring says what and how long.
void list_validations(const Installation& installation);
[[noreturn]] void run_validation(const Installation& installation, const std::string& name,
                                 const std::vector<std::string>& arguments);

}  // namespace couplet::launcher
