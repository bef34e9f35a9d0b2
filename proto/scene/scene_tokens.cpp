#include "proto/scene/scene_tokens.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <sstream>
#include <string_view>
#include <utility>

namespace couplet::scene {

namespace {

namespace io = google::protobuf::io;

// The tokenizer's complaints in the words of a scene, with a remedy.
std::string reworded(const std::string& message) {
  static const std::pair<std::string_view, std::string_view> words[] = {
      {"Invalid control characters", "an invisible character stands here; delete it"},
      {"Interpreting non ascii",
       "a character that is not ASCII stands here; such characters are allowed in quotes only"},
      {"Unexpected end of string", "the closing quote is missing; add it"},
      {"String literals cannot cross line", "the closing quote is missing on this line; add it"},
      {"Multiline", "the closing quote is missing on this line; add it"},
      {"Invalid escape sequence", "there is no such escape sequence; write \\\\ for a backslash"},
      {"Expected hex digits for escape", "\\x needs hexadecimal digits behind it; write \\\\ for a backslash"},
      {"Expected four hex digits", "\\u needs four hexadecimal digits behind it; write \\\\ for a backslash"},
      {"Expected eight hex digits", "\\U needs eight hexadecimal digits behind it; write \\\\ for a backslash"},
      {"\"0x\" must be followed", "0x needs hexadecimal digits behind it; write a decimal number"},
      {"Numbers starting with leading zero", "a number with a leading zero is octal; leave the zero out"},
      {"Hex and octal numbers", "hexadecimal and octal numbers have no fraction; write a decimal number"},
      {"\"e\" must be followed", "the exponent is missing behind e; write for example 1e-3"},
      {"Already saw decimal point", "the number has two decimal points or exponents; write for example 1.5e-3"},
      {"Need space between number", "the number runs into a name; numbers stand without a unit, in SI units"},
  };
  for (const auto& [start, sentence] : words) {
    if (message.compare(0, start.size(), start) == 0) return std::string(sentence);
  }
  return message;
}

class FaultCollector : public io::ErrorCollector {
 public:
  void AddError(int line, io::ColumnNumber column, const std::string& message) override {
    faults.push_back({line, column, reworded(message)});
  }
  std::vector<Token::Fault> faults;
};

Token::Kind kind_of(io::Tokenizer::TokenType type) {
  switch (type) {
    case io::Tokenizer::TYPE_IDENTIFIER:
      return Token::identifier;
    case io::Tokenizer::TYPE_INTEGER:
      return Token::integer;
    case io::Tokenizer::TYPE_FLOAT:
      return Token::decimal;
    case io::Tokenizer::TYPE_STRING:
      return Token::text;
    default:
      return Token::symbol;
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The tokenizer counts a tab up to the next multiple of eight; editors jump to bytes.
int byte_column(const std::vector<std::string>& lines, int line, int tabbed_column) {
  if (line >= static_cast<int>(lines.size())) return 1;
  const std::string& text = lines[static_cast<std::size_t>(line)];
  int tabbed = 0, byte = 0;
  while (tabbed < tabbed_column && byte < static_cast<int>(text.size())) {
    tabbed += text[static_cast<std::size_t>(byte)] == '\t' ? 8 - tabbed % 8 : 1;
    ++byte;
  }
  return byte + 1;
}

}  // namespace

std::vector<Token> split_tokens(const std::string& text) {
  io::ArrayInputStream stream(text.data(), static_cast<int>(text.size()));
  FaultCollector collector;
  io::Tokenizer tokenizer(&stream, &collector);
  tokenizer.set_comment_style(io::Tokenizer::SH_COMMENT_STYLE);
  tokenizer.set_allow_f_after_float(true);
  const std::vector<std::string> lines = lines_of(text);

  Token::Fault last_fault{-1, 0, ""};
  std::vector<Token> tokens;
  for (bool more = true; more;) {
    more = tokenizer.Next();
    const io::Tokenizer::Token& read = tokenizer.current();
    Token token;
    token.kind = more ? kind_of(read.type) : Token::end;
    token.word = read.text;
    token.line = read.line + 1;
    token.column = byte_column(lines, read.line, read.column);
    token.glued = tokenizer.previous().line == read.line && tokenizer.previous().end_column == read.column;
    for (const Token::Fault& fault : std::exchange(collector.faults, {})) {
      // A character outside ASCII is several bytes: one complaint is enough.
      const bool repeats = last_fault.line == fault.line && last_fault.sentence == fault.sentence;
      last_fault = fault;
      if (!repeats)
        token.faults.push_back({fault.line + 1, byte_column(lines, fault.line, fault.column), fault.sentence});
    }
    tokens.push_back(std::move(token));
  }
  return tokens;
}

}  // namespace couplet::scene
