#pragma once
// A walk over the words of a scene that complains at the place where it stands.

#include <string>
#include <vector>

#include "proto/scene/complaint.hpp"
#include "proto/scene/scalar_value.hpp"
#include "proto/scene/scene_tokens.hpp"

namespace couplet::scene {

class TokenCursor {
 public:
  /// With a setting, that is the place of every word.
  TokenCursor(const std::string& text, const std::string& setting, ComplaintList& complaints);

  const Token& now() const { return tokens_[position_]; }
  const Token& ahead(std::size_t n) const { return tokens_[std::min(position_ + n, tokens_.size() - 1)]; }
  const Token& before() const { return tokens_[position_ > 0 ? position_ - 1 : 0]; }
  bool at_end() const { return now().kind == Token::end; }
  Place place_of(const Token& token) const;

  /// NAME followed by a colon or a block.
  bool starts_field() const;
  bool starts_scalar() const;

  /// `path` is the field that complaints about unreadable words name.
  void advance(const std::string& path);
  /// Reads one value; false when some of it was unreadable (and complained about). Texts one behind the other are one
  /// value, but not in a list, where a comma is missing between them.
  bool read_scalar(const std::string& path, bool in_list, ScalarText& value);
  /// Passes over a value, a block (the cursor stands on its opening brace), the words up to the end of the line.
  void skip_value(const std::string& path);
  void skip_block(const std::string& path);
  void skip_rest_of_line(const std::string& path, bool in_list = false);

  /// Left out when the levels of the fields are uncertain because braces are missing or too many.
  void complain(const Token& at, const std::string& path, const std::string& sentence);
  /// Never left out.
  void complain_of_brace(const Token& at, const std::string& path, const std::string& sentence);
  bool braces_match() const;

 private:
  ComplaintList& complaints_;
  std::string setting_;
  std::vector<Token> tokens_;
  bool levels_are_certain_;
  std::size_t position_ = 0;
};

}  // namespace couplet::scene
