// Finds the block that is not closed, or the brace too many, by the indentation, as a reader does.

#include <cstddef>

#include "proto/scene/scene_tokens.hpp"

namespace couplet::scene {

namespace {

struct Imbalance {
  int unclosed = 0;
  int extra = 0;
};

Imbalance imbalance_of(const std::vector<Token>& tokens) {
  Imbalance found;
  for (const Token& token : tokens) {
    if (token.opens()) ++found.unclosed;
    if (!token.closes()) continue;
    found.unclosed > 0 ? --found.unclosed : ++found.extra;
  }
  return found;
}

struct OpenBlock {
  int line;
  int indentation;   // of the line on which it opens
  bool shows_level;  // its content stands deeper than that line, or begins on it: later lines can be compared
};

// Whether blocks of several lines stand deeper than the lines on which they open, with a few exceptions at most.
bool is_indented(const std::vector<Token>& tokens) {
  int n_deeper = 0, n_flat = 0, indentation = 1;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    const Token &token = tokens[i], &next = tokens[i + 1];
    if (i == 0 || tokens[i - 1].line != token.line) indentation = token.column;
    if (!token.opens() || next.line == token.line || next.closes() || next.kind == Token::end) continue;
    ++(next.column > indentation ? n_deeper : n_flat);
  }
  return n_deeper > 2 * n_flat;
}

class BraceMender {
 public:
  BraceMender(const Imbalance& found, bool is_indented)
      : unclosed_(found.unclosed), extra_(found.extra), is_indented_(is_indented) {}

  std::vector<Token> mend(const std::vector<Token>& tokens) {
    for (const Token& token : tokens) {
      if (token.line != line_ || token.kind == Token::end) start_line(token);
      const bool begins_block = !mended_.empty() && mended_.back().opens() && mended_.back().line == token.line;
      if (begins_block) open_.back().shows_level = true;
      Token kept = token;
      if (token.opens()) open_.push_back({token.line, indentation_, is_indented_});
      if (token.closes()) close(kept);
      mended_.push_back(kept);
    }
    return mended_;
  }

  bool is_certain() const { return is_certain_; }

 private:
  // A line that stands no deeper than an open block's first line, and does not close that block, shows that it is
  // unclosed.
  void start_line(const Token& first) {
    line_ = first.line;
    indentation_ = first.kind == Token::end ? 0 : first.column;
    if (!open_.empty() && indentation_ > open_.back().indentation) open_.back().shows_level = true;
    if (open_.empty() && first.kind == Token::identifier && indentation_ > 1) is_certain_ = extra_ == 0 && is_certain_;
    while (unclosed_ > 0 && !open_.empty() && shows_unclosed(first)) put_in_closing_brace(first);
  }

  bool shows_unclosed(const Token& first) {
    const OpenBlock& block = open_.back();
    if (first.kind == Token::end) {
      is_certain_ = is_certain_ && block.shows_level && block.line < mended_.back().line;
      return true;
    }
    if (!block.shows_level) return false;
    return first.closes() ? indentation_ < block.indentation : indentation_ <= block.indentation;
  }

  void put_in_closing_brace(const Token& before) {
    Token brace;
    brace.kind = Token::symbol;
    brace.word = "}";
    brace.line = before.line;
    brace.column = before.column;
    brace.mended = true;
    mended_.push_back(brace);
    open_.pop_back();
    --unclosed_;
  }

  void close(Token& brace) {
    const bool too_deep = is_first_on_its_line(brace) && !open_.empty() && open_.back().shows_level &&
                          brace.column > open_.back().indentation;
    // On a line of its own the brace too many is this one; behind other words it may as well be an earlier one.
    if (open_.empty()) is_certain_ = is_certain_ && is_first_on_its_line(brace);
    if (open_.empty() || (extra_ > 0 && too_deep)) {
      brace.extra = true;
      --extra_;
      return;
    }
    open_.pop_back();
  }

  bool is_first_on_its_line(const Token& token) const { return mended_.empty() || mended_.back().line != token.line; }

  int unclosed_, extra_;  // still to be found
  bool is_indented_;
  bool is_certain_ = true;
  int line_ = 0;
  int indentation_ = 1;
  std::vector<OpenBlock> open_;
  std::vector<Token> mended_;
};

}  // namespace

bool mend_braces(std::vector<Token>& tokens) {
  const Imbalance found = imbalance_of(tokens);
  if (found.unclosed == 0 && found.extra == 0) return true;
  BraceMender mender(found, is_indented(tokens));
  tokens = mender.mend(tokens);
  const bool is_one_kind = found.unclosed == 0 || found.extra == 0;
  return is_one_kind && mender.is_certain();
}

}  // namespace couplet::scene
