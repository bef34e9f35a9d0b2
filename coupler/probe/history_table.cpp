#include "coupler/probe/history_table.hpp"

#include <set>
#include <string>
#include <utility>

#include "coupler/convergence/convergence_history.hpp"

namespace couplet::coupling {

namespace {

using participant::NamedNumber;

void add_columns(const std::vector<NamedNumber>& quantities, const std::vector<NamedNumber>& others,
                 const std::string& prefix, std::vector<store::Column>& columns) {
  std::set<std::string> taken = {"time", "dt", "iterations"};
  for (const NamedNumber& other : others) taken.insert(other.name);
  for (const NamedNumber& quantity : quantities) {
    columns.push_back({(taken.count(quantity.name) > 0 ? prefix : "") + quantity.name, quantity.unit});
  }
}

}  // namespace

HistoryTable::HistoryTable(std::filesystem::path path, std::vector<store::Column> change_columns,
                           std::vector<store::InterfaceProbe> probes)
    : path_(std::move(path)), change_columns_(std::move(change_columns)), probes_(std::move(probes)) {}

void HistoryTable::continue_from(const std::filesystem::path& path, double time) {
  if (!std::filesystem::exists(path)) return;
  earlier_ = store::rows_up_to(store::read_table(path), "time", time);
}

void HistoryTable::append(const AcceptedStep& step, const surface::NodeArray& displacement) {
  if (!table_) {
    table_ = earlier_ ? std::make_unique<store::TableWriter>(path_, make_columns(step), *earlier_)
                      : std::make_unique<store::TableWriter>(path_, make_columns(step));
    earlier_.reset();
  }
  std::vector<double> row = {step.time, step.duration, static_cast<double>(step.iterations)};
  append_changes(step.changes, row);
  store::append_probe_values(probes_, displacement, row);
  for (const NamedNumber& quantity : step.flow_quantities) row.push_back(quantity.value);
  for (const NamedNumber& quantity : step.solid_quantities) row.push_back(quantity.value);
  table_->append(row);
}

std::vector<store::Column> HistoryTable::make_columns(const AcceptedStep& step) const {
  std::vector<store::Column> columns = {{"time", "s"}, {"dt", "s"}, {"iterations", "1"}};
  columns.insert(columns.end(), change_columns_.begin(), change_columns_.end());
  for (store::Column& column : store::probe_columns(probes_)) columns.push_back(std::move(column));
  add_columns(step.flow_quantities, step.solid_quantities, "flow.", columns);
  add_columns(step.solid_quantities, step.flow_quantities, "solid.", columns);
  return columns;
}

}  // namespace couplet::coupling
