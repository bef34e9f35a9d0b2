#pragma once
// history.csv: one row per accepted step.

#include <filesystem>
#include <memory>
#include <vector>

#include "coupler/convergence/criterion.hpp"
#include "coupler/scheme/time_loop.hpp"
#include "proto/store/interface_probe.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::coupling {

/// Columns: time, dt, iterations, the last change of every criterion, probes, what the servers report. A server's
/// column is prefixed with flow. or solid. only where both report the same name.
class HistoryTable {
 public:
  HistoryTable(std::filesystem::path path, std::vector<store::Column> change_columns,
               std::vector<store::InterfaceProbe> probes);

  /// The rows of this table up to `time` stand before the new ones.
  void continue_from(const std::filesystem::path& path, double time);

  /// `displacement` of the solid's nodes (n_nodes, 3); may be empty when there are no probes.
  void append(const AcceptedStep& step, const surface::NodeArray& displacement);

 private:
  std::vector<store::Column> make_columns(const AcceptedStep& step) const;

  std::filesystem::path path_;
  std::vector<store::Column> change_columns_;
  std::vector<store::InterfaceProbe> probes_;
  std::optional<store::Table> earlier_;
  std::unique_ptr<store::TableWriter> table_;  // made with the first row: the servers' columns are known then
};

}  // namespace couplet::coupling
