#include "proto/scene/complaint.hpp"

#include <algorithm>
#include <tuple>

#include "proto/scene/wording.hpp"

namespace couplet::scene {

std::string Complaint::text() const {
  std::string line_of_text = file;
  if (line > 0) line_of_text.append(":").append(std::to_string(line)).append(":").append(std::to_string(column));
  if (!field.empty()) line_of_text.append(": ").append(field);
  return line_of_text + ": " + sentence;
}

void ComplaintList::add(const Place& place, const std::string& field, const std::string& sentence) {
  if (place.setting.empty()) {
    complaints_.push_back({file_, place.line, place.column, on_one_line(field), on_one_line(sentence)});
    return;
  }
  const bool names_the_field = place.setting.compare(0, place.setting.find('='), field) == 0;
  complaints_.push_back(
      {"--set " + on_one_line(place.setting), 0, 0, names_the_field ? "" : on_one_line(field), on_one_line(sentence)});
}

std::vector<Complaint> ComplaintList::in_order() const {
  std::vector<Complaint> sorted = complaints_;
  const auto key = [](const Complaint& c) { return std::make_tuple(c.line == 0, c.line, c.column); };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Complaint& a, const Complaint& b) { return key(a) < key(b); });
  const auto same = [](const Complaint& a, const Complaint& b) { return a.text() == b.text(); };
  sorted.erase(std::unique(sorted.begin(), sorted.end(), same), sorted.end());
  return sorted;
}

}  // namespace couplet::scene
