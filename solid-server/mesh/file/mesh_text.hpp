#pragma once
// The text of a mesh file, line by line.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::solid {

/// Without the blanks at both ends.
std::string_view trimmed(std::string_view text);

/// The whole file. Throws FileError when it cannot be read.
std::string read_mesh_text(const std::filesystem::path& file);

/// Goes through a text. Lines end with LF or CR LF; blanks at both ends are left out. Views stay good as long as the
/// text.
class MeshText {
 public:
  MeshText(std::string_view text, std::string file) : rest_(text), file_(std::move(file)) {}

  /// Steps to the next line; false at the end of the text.
  bool next();
  /// The same where the file must go on: throws SceneError saying what it should have had.
  void next_or_refuse(const std::string& expected);

  std::string_view line() const { return line_; }
  int line_number() const { return number_; }  // from 1; 0 before the first
  const std::string& file() const { return file_; }

  /// Throws SceneError about the current line, or another one.
  [[noreturn]] void refuse(const std::string& sentence, const std::string& advice = {}) const;
  [[noreturn]] void refuse_line(int line, const std::string& sentence, const std::string& advice = {}) const;

 private:
  std::string_view rest_, line_;
  std::string file_;
  int number_ = 0;
};

/// The values of a line one after the other, parted by blanks (or commas, where `separator` is a comma).
class LineValues {
 public:
  explicit LineValues(const MeshText& text, char separator = ' ')
      : text_(&text), rest_(text.line()), separator_(separator) {}

  bool is_at_end();
  /// The next value; each throws SceneError with the line when there is none or when it is no number.
  std::int64_t integer(const char* what);
  double number(const char* what);
  std::string_view word(const char* what);
  /// Throws SceneError when something is left.
  void expect_end(const char* what);

 private:
  const MeshText* text_;
  std::string_view rest_;
  char separator_;
};

}  // namespace couplet::solid
