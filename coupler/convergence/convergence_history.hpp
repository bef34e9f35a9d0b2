#pragma once
// Every iteration as a row of iterations.csv; the last attempt in memory, for the diagnosis.

#include <filesystem>
#include <memory>
#include <vector>

#include "coupler/convergence/criterion.hpp"
#include "proto/participant/participant.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::coupling {

/// The columns `FIELD.change` and `FIELD.relative_change` of each criterion.
std::vector<store::Column> change_columns(const std::vector<Criterion>& criteria,
                                          const std::vector<std::string>& units);
void append_changes(const std::vector<FieldChange>& changes, std::vector<double>& row);

class ConvergenceHistory {
 public:
  /// `units` of the criteria's fields. Without a path nothing is written.
  ConvergenceHistory(std::vector<Criterion> criteria, std::vector<std::string> units);

  /// Rows go to this file from now on; behind those of an earlier table up to `step`.
  void write_to(const std::filesystem::path& path);
  void continue_from(const std::filesystem::path& earlier, std::int64_t step, const std::filesystem::path& path);

  void start_attempt();
  void add(const participant::StepInterval& interval, const std::vector<FieldChange>& changes);

  const std::vector<Criterion>& criteria() const { return criteria_; }
  const std::vector<std::string>& units() const { return units_; }
  /// Changes of each iteration of the last attempt.
  const std::vector<std::vector<FieldChange>>& attempt() const { return attempt_; }

 private:
  std::vector<store::Column> columns() const;

  std::vector<Criterion> criteria_;
  std::vector<std::string> units_;
  std::vector<std::vector<FieldChange>> attempt_;
  std::unique_ptr<store::TableWriter> table_;
};

}  // namespace couplet::coupling
