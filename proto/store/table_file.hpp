#pragma once
// Comma-separated tables: history.csv and iterations.csv.

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace couplet::store {

struct Column {
  std::string name;
  std::string unit;  // written in brackets behind the name
};

/// A table in memory, column by column.
struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<double>> values;  // values[column][row]

  std::size_t n_rows() const { return values.empty() ? 0 : values.front().size(); }
  /// Index of a column by name (without unit); throws SceneError listing the names when it is missing.
  std::size_t find(const std::string& name) const;
};

/// Writes one row at a time; a row is on its way to the disk when append returns. Numbers are written so that reading
/// them gives the same bits.
class TableWriter {
 public:
  TableWriter(const std::filesystem::path& path, std::vector<Column> columns);
  /// Continues after rows that an earlier run left: the file holds them first. The file is replaced as a whole, so
  /// `rows` may come from it.
  TableWriter(const std::filesystem::path& path, std::vector<Column> columns, const Table& rows);
  TableWriter(const TableWriter&) = delete;
  TableWriter& operator=(const TableWriter&) = delete;
  ~TableWriter();

  const std::vector<Column>& columns() const { return columns_; }
  void append(const std::vector<double>& row);

 private:
  std::filesystem::path path_;
  std::vector<Column> columns_;
  std::string line_;
  std::FILE* file_ = nullptr;
};

/// Reads a table; a last line that was cut off by a crash is left out. Throws FileError.
Table read_table(const std::filesystem::path& path);

/// The rows in which `column` is at most `largest`, as a resumed run keeps them.
Table rows_up_to(const Table& table, const std::string& column, double largest);

}  // namespace couplet::store
