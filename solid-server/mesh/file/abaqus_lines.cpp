#include "solid-server/mesh/file/abaqus_lines.hpp"

#include <algorithm>

namespace couplet::solid {

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  for (char& c : capitals)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return capitals;
}

AbaqusLines::Kind AbaqusLines::step() {
  while (text_.next()) {
    if (text_.line().empty() || text_.line().starts_with("**")) continue;
    return kind_ = text_.line().front() == '*' ? Kind::keyword : Kind::data;
  }
  return kind_ = Kind::end;
}

bool AbaqusLines::next_keyword() {
  if (!is_waiting_)
    while (step() == Kind::data) {
    }
  is_waiting_ = false;
  if (kind_ == Kind::end) return false;
  read_keyword();
  return true;
}

bool AbaqusLines::next_data() {
  if (is_waiting_ || step() != Kind::data) is_waiting_ = true;
  return !is_waiting_;
}

void AbaqusLines::read_keyword() {
  std::string line(text_.line().substr(1));
  while (line.ends_with(',') && text_.next()) line += text_.line();  // goes on in the next line
  parameter_.clear();
  std::string_view rest = line;
  bool is_first = true;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (is_first) {
      keyword_ = in_capitals(trimmed(part));
      is_first = false;
      continue;
    }
    const std::size_t equals = std::min(part.find('='), part.size());
    std::string value(equals < part.size() ? trimmed(part.substr(equals + 1)) : "");
    value.erase(std::remove(value.begin(), value.end(), '"'), value.end());
    parameter_[in_capitals(trimmed(part.substr(0, equals)))] = value;
  }
}

std::string AbaqusLines::value_of(const std::string& parameter) const {
  const auto found = parameter_.find(parameter);
  return found == parameter_.end() ? "" : found->second;
}

std::string AbaqusLines::required(const std::string& parameter) const {
  const std::string value = value_of(parameter);
  if (value.empty())
    text_.refuse("*" + keyword_ + " has no " + parameter, "write *" + keyword_ + ", " + parameter + "=...");
  return value;
}

}  // namespace couplet::solid
