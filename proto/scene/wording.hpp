#pragma once
// How numbers and names read in a complaint.

#include <string>
#include <vector>

namespace couplet::scene {

/// The shortest text that reads back as the same number: 0.5, 1e-05.
std::string number_text(double value);

/// `a, b or c`
std::string either_of(const std::vector<std::string>& names);

/// `list[index]`
std::string entry(const std::string& list, int index);

/// In small letters.
std::string lower(std::string text);

/// The name that was probably meant: few letters differ, or it starts with what was written. Empty when none is near,
/// or several are equally near.
std::string nearest_name(const std::string& written, const std::vector<std::string>& names);

/// `did you mean density?` or, when none is near, `ALL density, viscosity`.
std::string suggestion(const std::string& written, const std::vector<std::string>& names, const std::string& all);

/// What a user wrote as a complaint can show it: line breaks and other invisible characters as question marks, a very
/// long word cut short.
std::string on_one_line(const std::string& text);

/// Whether a text is well-formed UTF-8 (Unicode 15, table 3-7).
bool is_utf8(const std::string& text);

}  // namespace couplet::scene
