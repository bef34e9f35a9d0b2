#include "proto/scene/wording.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>

namespace couplet::scene {

namespace {

// Letters to insert, delete, replace or swap with their neighbour to turn one word into the other
// (restricted Damerau-Levenshtein distance, row by row).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string entry(const std::string& list, int index) {
  return list + "[" + std::to_string(index) + "]";
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string number_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general).ptr;
  return {digits.data(), end};
}

std::string either_of(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

std::string nearest_name(const std::string& written, const std::vector<std::string>& names) {
  const std::string word = lower(written.substr(0, 100));
  std::string nearest;
  std::size_t smallest = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& name : names) {
    const std::string candidate = lower(name);
    const bool is_start = word.size() >= 3 && candidate.starts_with(word);
    const std::size_t distance =
        is_start ? std::min<std::size_t>(1, candidate.size() - word.size()) : edit_distance(word, candidate);
    if (distance > smallest || distance >= candidate.size()) continue;
    const bool is_the_same = lower(nearest) == candidate;
    if (!is_the_same) nearest = distance == smallest ? "" : name;
    smallest = distance;
  }
  return nearest;
}

std::string on_one_line(const std::string& text) {
  constexpr std::size_t longest_word = 200;
  const bool is_readable = is_utf8(text);
  std::string shown;
  std::size_t n_in_word = 0;
  for (const char c : text) {
    n_in_word = c == ' ' ? 0 : n_in_word + 1;
    if (n_in_word == longest_word) shown += "...";
    if (n_in_word >= longest_word) continue;
    const bool is_ascii = static_cast<unsigned char>(c) < 0x80;
    const bool is_visible = is_ascii ? c >= ' ' && c != 0x7F : is_readable;
    shown += is_visible ? c : '?';
  }
  // A cut through a character of several bytes leaves a rest of it.
  return is_utf8(shown) ? shown : on_one_line(shown);
}

bool is_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0; };
    const int first = byte(i), second = byte(i + 1);
    const std::size_t n_bytes = first < 0x80   ? 1
                                : first < 0xC2 ? 0
                                : first < 0xE0 ? 2
                                : first < 0xF0 ? 3
                                : first < 0xF5 ? 4
                                               : 0;
    if (n_bytes == 0) return false;
    for (std::size_t k = i + 1; k < i + n_bytes; ++k) {
      if ((byte(k) & 0xC0) != 0x80) return false;
    }
    // Overlong forms, surrogates and what lies beyond U+10FFFF.
    if (first == 0xE0 && second < 0xA0) return false;
    if (first == 0xED && second > 0x9F) return false;
    if (first == 0xF0 && second < 0x90) return false;
    if (first == 0xF4 && second > 0x8F) return false;
    i += n_bytes;
  }
  return true;
}

std::string suggestion(const std::string& written, const std::vector<std::string>& names, const std::string& all) {
  const std::string nearest = nearest_name(written, names);
  if (!nearest.empty()) return "did you mean " + nearest + "?";
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? " " : ", ") + name;
  return all + list;
}

}  // namespace couplet::scene
