#include "solid-server/mesh/file/mesh_text.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "proto/report/failure.hpp"

namespace couplet::solid {

namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// A value as messages show it: at most 40 characters, each printable.
std::string shown(std::string_view value) {
  std::string text(value.substr(0, 40));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = '?';
  return "\"" + text + (value.size() > 40 ? "..." : "") + "\"";
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string read_mesh_text(const std::filesystem::path& file) {
  const std::string advice = "give the path of a mesh file";
  if (std::filesystem::is_directory(file)) throw report::FileError(file.string(), "is a folder", advice);
  errno = 0;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  std::string text;
  if (stream) {
    const auto size = stream.tellg();
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    stream.seekg(0);
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  }
  if (!stream) throw report::FileError(file.string(), std::string("cannot be read: ") + std::strerror(errno), advice);
  return text;
}

bool MeshText::next() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = trimmed(rest_.substr(0, end));
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++number_;
  return true;
}

void MeshText::next_or_refuse(const std::string& expected) {
  if (!next()) refuse("the file ends before " + expected, "the file is cut off: write it again");
}

void MeshText::refuse(const std::string& sentence, const std::string& advice) const {
  refuse_line(number_, sentence, advice);
}

void MeshText::refuse_line(int line, const std::string& sentence, const std::string& advice) const {
  throw report::SceneError(file_ + ":" + std::to_string(std::max(line, 1)), sentence, advice);
}

bool LineValues::is_at_end() {
  rest_ = trimmed(rest_);
  return rest_.empty();
}

std::string_view LineValues::word(const char* what) {
  if (is_at_end()) text_->refuse("the line ends before " + std::string(what));
  std::size_t end = 0;
  while (end < rest_.size() && (separator_ == ',' ? rest_[end] != ',' : !is_blank(rest_[end]))) ++end;
  const std::string_view value = trimmed(rest_.substr(0, end));
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return value;
}

std::int64_t LineValues::integer(const char* what) {
  const std::string_view value = word(what);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size())
    text_->refuse(shown(value) + " is not a whole number for " + what);
  return number;
}

double LineValues::number(const char* what) {
  const std::string_view value = word(what);
  const std::string_view digits = value.substr(value.starts_with('+') ? 1 : 0);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number))
    text_->refuse(shown(value) + " is not a number for " + what);
  return number;
}

void LineValues::expect_end(const char* what) {
  if (!is_at_end()) text_->refuse(shown(rest_) + " stands behind " + what);
}

}  // namespace couplet::solid
