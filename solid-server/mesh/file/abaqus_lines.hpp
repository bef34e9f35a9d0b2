#pragma once
// Keyword lines and data lines of Abaqus and CalculiX input files.

#include <map>
#include <string>
#include <string_view>

#include "solid-server/mesh/file/mesh_text.hpp"

namespace couplet::solid {

/// Capitals only.
std::string in_capitals(std::string_view text);

/// Goes through an input file: keyword lines (*NODE, NSET=ALL), each followed by data lines; comments (**) and empty
/// lines are left out.
class AbaqusLines {
 public:
  AbaqusLines(std::string_view text, const std::string& file) : text_(text, file) {}

  /// Steps to the next keyword line; data lines before it are left out. False at the end.
  bool next_keyword();
  /// Steps to the next data line of the keyword; false when there is none.
  bool next_data();

  const std::string& keyword() const { return keyword_; }  // in capitals, without the star
  bool has(const std::string& parameter) const { return parameter_.contains(parameter); }
  /// A parameter's value without quotation marks; empty when it is not given.
  std::string value_of(const std::string& parameter) const;
  /// The same; throws SceneError when it is not given.
  std::string required(const std::string& parameter) const;

  const MeshText& text() const { return text_; }

 private:
  enum class Kind { keyword, data, end };
  Kind step();
  void read_keyword();

  MeshText text_;
  Kind kind_ = Kind::data;
  bool is_waiting_ = false;  // a keyword line was met by next_data
  std::string keyword_;
  std::map<std::string, std::string> parameter_;
};

}  // namespace couplet::solid
