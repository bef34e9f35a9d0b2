#include "proto/store/table_file.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "proto/report/failure.hpp"

namespace couplet::store {

namespace {

std::string header(const std::vector<Column>& columns) {
  std::string line;
  for (const Column& column : columns) {
    if (!line.empty()) line += ',';
    line += column.name;
    if (!column.unit.empty()) line += " [" + column.unit + "]";
  }
  return line + '\n';
}

Column parse_column(std::string_view cell) {
  const auto bracket = cell.rfind(" [");
  if (bracket == std::string_view::npos || cell.back() != ']') return {std::string(cell), ""};
  return {std::string(cell.substr(0, bracket)), std::string(cell.substr(bracket + 2, cell.size() - bracket - 3))};
}

std::vector<Column> parse_header(std::string_view line) {
  std::vector<Column> columns;
  for (std::size_t start = 0; start <= line.size();) {
    const auto end = std::min(line.find(',', start), line.size());
    columns.push_back(parse_column(line.substr(start, end - start)));
    start = end + 1;
  }
  return columns;
}

/// Appends the shortest text that reads back to the same bits.
void append_number(std::string& line, double value) {
  char digits[32];
  const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
  line.append(digits, end);
}

/// Adds one row to the columns; false when the line is not a row of numbers of the right count.
bool parse_row(std::string_view line, Table& table) {
  const char* here = line.data();
  const char* const end = line.data() + line.size();
  std::vector<double> row(table.columns.size());
  for (std::size_t column = 0; column < row.size(); ++column) {
    if (column > 0 && (here == end || *here++ != ',')) return false;
    const auto [next, error] = std::from_chars(here, end, row[column]);
    if (error != std::errc()) return false;
    here = next;
  }
  if (here != end) return false;
  for (std::size_t column = 0; column < row.size(); ++column) table.values[column].push_back(row[column]);
  return true;
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw report::FileError(path.string(), "cannot read this table: " + std::string(std::strerror(errno)));
  return {std::istreambuf_iterator<char>(file), {}};
}

std::FILE* open_unbuffered(const std::filesystem::path& path, const char* mode) {
  std::FILE* file = std::fopen(path.c_str(), mode);
  if (file == nullptr)
    throw report::FileError(path.string(), "cannot write: " + std::string(std::strerror(errno)),
                            "check the folder and its permissions");
  std::setvbuf(file, nullptr, _IONBF, 0);  // each row is one write
  return file;
}

}  // namespace

std::size_t Table::find(const std::string& name) const {
  for (std::size_t column = 0; column < columns.size(); ++column) {
    if (columns[column].name == name) return column;
  }
  std::string names;
  for (const Column& column : columns) names += (names.empty() ? "" : ", ") + column.name;
  throw report::SceneError("", "there is no column '" + name + "' in the history", "the columns are: " + names);
}

TableWriter::TableWriter(const std::filesystem::path& path, std::vector<Column> columns)
    : TableWriter(path, std::move(columns), Table{}) {}

TableWriter::TableWriter(const std::filesystem::path& path, std::vector<Column> columns, const Table& rows)
    : path_(path), columns_(std::move(columns)) {
  assert(rows.n_rows() == 0 || rows.values.size() == columns_.size());
  std::string text = header(columns_);
  for (std::size_t row = 0; row < rows.n_rows(); ++row) {
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      if (column > 0) text += ',';
      append_number(text, rows.values[column][row]);
    }
    text += '\n';
  }
  // Beside the old file and then in its place: a crash leaves one or the other.
  const std::filesystem::path part = path.string() + ".part";
  file_ = open_unbuffered(part, "wb");
  line_.swap(text);
  std::error_code error;
  if (std::fwrite(line_.data(), 1, line_.size(), file_) == line_.size())
    std::filesystem::rename(part, path_, error);
  else
    error = std::error_code(errno, std::generic_category());
  if (!error) return;
  std::fclose(file_);
  throw report::FileError(path_.string(), "cannot write: " + error.message(), "free some space or write elsewhere");
}

TableWriter::~TableWriter() {
  std::fclose(file_);
}

void TableWriter::append(const std::vector<double>& row) {
  assert(row.size() == columns_.size());
  line_.clear();
  for (const double value : row) {
    if (!line_.empty()) line_ += ',';
    append_number(line_, value);
  }
  line_ += '\n';
  if (std::fwrite(line_.data(), 1, line_.size(), file_) != line_.size())
    throw report::FileError(path_.string(), "cannot write a row: " + std::string(std::strerror(errno)),
                            "free some space and resume from the last checkpoint");
}

Table read_table(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  const std::size_t end_of_header = text.find('\n');
  if (end_of_header == std::string::npos)
    throw report::FileError(path.string(), "this table has no complete header line", "repeat the run that writes it");
  Table table;
  table.columns = parse_header(std::string_view(text).substr(0, end_of_header));
  table.values.resize(table.columns.size());
  std::size_t start = end_of_header + 1;
  for (int line = 2;; ++line) {
    const std::size_t end = text.find('\n', start);
    if (end == std::string::npos) return table;  // what follows was cut off
    if (!parse_row(std::string_view(text).substr(start, end - start), table))
      throw report::FileError(path.string() + ":" + std::to_string(line),
                              "this line does not hold " + std::to_string(table.columns.size()) + " numbers",
                              "remove the line or repeat the run that writes the table");
    start = end + 1;
  }
}

Table rows_up_to(const Table& table, const std::string& column, double largest) {
  Table kept{table.columns, std::vector<std::vector<double>>(table.columns.size())};
  const auto& key = table.values[table.find(column)];
  for (std::size_t row = 0; row < table.n_rows(); ++row) {
    if (!(key[row] <= largest)) continue;
    for (std::size_t index = 0; index < table.columns.size(); ++index)
      kept.values[index].push_back(table.values[index][row]);
  }
  return kept;
}

}  // namespace couplet::store
