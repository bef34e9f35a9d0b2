#include "proto/scene/token_cursor.hpp"

#include <google/protobuf/io/tokenizer.h>

#include <algorithm>

namespace couplet::scene {

using google::protobuf::io::Tokenizer;

TokenCursor::TokenCursor(const std::string& text, const std::string& setting, ComplaintList& complaints)
    : complaints_(complaints),
      setting_(setting),
      tokens_(split_tokens(text)),
      levels_are_certain_(mend_braces(tokens_)) {}

Place TokenCursor::place_of(const Token& token) const {
  return setting_.empty() ? Place{token.line, token.column, ""} : Place{0, 0, setting_};
}

bool TokenCursor::starts_field() const {
  return now().kind == Token::identifier && (ahead(1).is(":") || ahead(1).opens());
}

bool TokenCursor::starts_scalar() const {
  return now().is("-") || (now().kind != Token::symbol && now().kind != Token::end);
}

void TokenCursor::advance(const std::string& path) {
  for (const Token::Fault& fault : now().faults) {
    Token at = now();
    at.line = fault.line;
    at.column = fault.column;
    complain_of_brace(at, path, fault.sentence);
  }
  if (now().extra) {
    complain_of_brace(now(), path,
                      "this " + now().word + " closes nothing; delete it or add the brace that it should close");
  }
  if (position_ + 1 < tokens_.size()) ++position_;
}

bool TokenCursor::read_scalar(const std::string& path, bool in_list, ScalarText& value) {
  const Token sign = now();
  value.is_negative = sign.is("-");
  if (value.is_negative) advance(path);
  if (!starts_scalar() || now().is("-")) {
    complain(sign, path, "a minus stands without a number; write the number behind it");
    return false;
  }
  bool is_readable = now().faults.empty();
  value.kind = now().kind;
  value.word = now().word;
  if (value.kind == Token::text) {
    value.word.clear();
    do {
      is_readable = is_readable && now().faults.empty();
      Tokenizer::ParseStringAppend(now().word, &value.word);
      advance(path);
    } while (now().kind == Token::text && !in_list);
  } else {
    advance(path);
  }
  return is_readable;
}

void TokenCursor::skip_value(const std::string& path) {
  if (now().opens()) {
    skip_block(path);
  } else if (now().is("[")) {
    advance(path);
    while (!at_end() && !now().closes() && !starts_field() && !now().is("]")) skip_value(path);
    if (now().is("]")) advance(path);
  } else if (now().is("-") || now().kind == Token::text) {
    ScalarText ignored;
    read_scalar(path, false, ignored);
  } else if (!now().closes()) {
    advance(path);
  }
}

void TokenCursor::skip_block(const std::string& path) {
  const Token opening = now();
  int depth = 0;
  bool is_closed = true;
  do {
    if (now().opens()) ++depth;
    if (now().closes() && !now().extra) --depth;
    is_closed = is_closed && !now().mended;
    advance(path);
  } while (depth > 0 && !at_end());
  if (!is_closed) complain_of_brace(opening, path, "its " + opening.word + " is not closed; add }");
}

void TokenCursor::skip_rest_of_line(const std::string& path, bool in_list) {
  const int line = now().line;
  const auto stops = [&] {
    return now().line != line || at_end() || now().closes() || now().is(",") || now().is(";") || starts_field() ||
           (in_list && now().is("]"));
  };
  do {
    now().opens() ? skip_block(path) : advance(path);
  } while (!stops());
}

void TokenCursor::complain(const Token& at, const std::string& path, const std::string& sentence) {
  if (levels_are_certain_) complain_of_brace(at, path, sentence);
}

void TokenCursor::complain_of_brace(const Token& at, const std::string& path, const std::string& sentence) {
  complaints_.add(place_of(at), path, sentence);
}

bool TokenCursor::braces_match() const {
  return std::none_of(tokens_.begin(), tokens_.end(), [](const Token& token) { return token.mended || token.extra; });
}

}  // namespace couplet::scene
