#include "coupler/convergence/convergence_history.hpp"

#include <utility>

namespace couplet::coupling {

std::vector<store::Column> change_columns(const std::vector<Criterion>& criteria,
                                          const std::vector<std::string>& units) {
  std::vector<store::Column> columns;
  for (std::size_t k = 0; k < criteria.size(); ++k) {
    columns.push_back({criteria[k].field + ".change", units[k]});
    columns.push_back({criteria[k].field + ".relative_change", "1"});
  }
  return columns;
}

void append_changes(const std::vector<FieldChange>& changes, std::vector<double>& row) {
  for (const FieldChange& change : changes) {
    row.push_back(change.absolute);
    row.push_back(change.relative);
  }
}

ConvergenceHistory::ConvergenceHistory(std::vector<Criterion> criteria, std::vector<std::string> units)
    : criteria_(std::move(criteria)), units_(std::move(units)) {}

void ConvergenceHistory::write_to(const std::filesystem::path& path) {
  table_ = std::make_unique<store::TableWriter>(path, columns());
}

void ConvergenceHistory::continue_from(const std::filesystem::path& earlier, std::int64_t step,
                                       const std::filesystem::path& path) {
  if (!std::filesystem::exists(earlier)) return write_to(path);
  const store::Table rows = store::rows_up_to(store::read_table(earlier), "step", static_cast<double>(step));
  table_ = std::make_unique<store::TableWriter>(path, columns(), rows);
}

std::vector<store::Column> ConvergenceHistory::columns() const {
  std::vector<store::Column> columns = {{"step", "1"}, {"time", "s"}, {"dt", "s"}, {"iteration", "1"}};
  for (store::Column& column : change_columns(criteria_, units_)) columns.push_back(std::move(column));
  return columns;
}

void ConvergenceHistory::start_attempt() {
  attempt_.clear();
}

void ConvergenceHistory::add(const participant::StepInterval& interval, const std::vector<FieldChange>& changes) {
  attempt_.push_back(changes);
  if (!table_) return;
  std::vector<double> row = {static_cast<double>(interval.step), interval.start + interval.duration, interval.duration,
                             static_cast<double>(interval.iteration)};
  append_changes(changes, row);
  table_->append(row);
}

}  // namespace couplet::coupling
