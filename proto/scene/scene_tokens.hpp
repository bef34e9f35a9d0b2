#pragma once
// The words of a scene's text, each with its place.

#include <string>
#include <vector>

namespace couplet::scene {

struct Token {
  enum Kind { identifier, integer, decimal, text, symbol, end };
  /// Something in the token that cannot be read, for example a text without its closing quote.
  struct Fault {
    int line, column;
    std::string sentence;
  };

  Kind kind = end;
  std::string word;  // as written, quotes included
  int line = 1;      // 1, 2, ...
  int column = 1;    // 1, 2, ... in bytes
  std::vector<Fault> faults;
  bool mended = false;  // a closing brace that mend_braces put in
  bool extra = false;   // a closing brace that closes nothing

  bool is(const char* wanted) const { return kind == symbol && word == wanted; }
  bool opens() const { return is("{") || is("<"); }
  bool closes() const { return is("}") || is(">"); }
};

/// Splits a text; comments start with #. The last token is of kind `end`.
std::vector<Token> split_tokens(const std::string& text);

/// Where closing braces are missing, puts them in (`mended`), and marks those that close nothing (`extra`), guided by
/// the indentation. Returns false when the indentation does not tell where, so that the fields' levels are uncertain.
bool mend_braces(std::vector<Token>& tokens);

}  // namespace couplet::scene
