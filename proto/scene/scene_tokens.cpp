#include "proto/scene/scene_tokens.hpp"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
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

// The same complaint is made once a line: a character outside ASCII alone is several bytes.
class FaultCollector : public io::ErrorCollector {
 public:
  void AddError(int line, io::ColumnNumber column, const std::string& message) override {
    const std::string sentence = reworded(message);
    if (line != last_line_ || sentence != last_sentence_) faults.push_back({line, column, sentence});
    last_line_ = line;
    last_sentence_ = sentence;
  }
  std::vector<Token::Fault> faults;

 private:
  int last_line_ = -1;
  std::string last_sentence_;
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

// The tokenizer counts a tab up to the next multiple of eight; editors jump to bytes. Asked in the order of the text.
class ByteColumns {
 public:
  explicit ByteColumns(const std::string& text) : text_(text) {}

  int at(int line, int tabbed_column) {
    if (line == line_ && tabbed_column < tabbed_) go_to(start_of_line_);
    for (; line_ < line && place_ < text_.size(); ++line_) {
      go_to(std::min(text_.find('\n', place_), text_.size() - 1) + 1);
    }
    for (; tabbed_ < tabbed_column && place_ < text_.size(); ++place_) {
      tabbed_ += text_[place_] == '\t' ? 8 - tabbed_ % 8 : 1;
    }
    return static_cast<int>(place_ - start_of_line_) + 1;
  }

 private:
  void go_to(std::size_t start_of_line) {
    start_of_line_ = place_ = start_of_line;
    tabbed_ = 0;
  }

  const std::string& text_;
  int line_ = 0;
  std::size_t start_of_line_ = 0, place_ = 0;
  int tabbed_ = 0;
};

}  // namespace

std::vector<Token> split_tokens(const std::string& whole_text) {
  // Some editors put the mark of UTF-8 in front, and show it as nothing.
  const std::string text = whole_text.starts_with("\xEF\xBB\xBF") ? whole_text.substr(3) : whole_text;
  io::ArrayInputStream stream(text.data(), static_cast<int>(text.size()));
  FaultCollector collector;
  io::Tokenizer tokenizer(&stream, &collector);
  tokenizer.set_comment_style(io::Tokenizer::SH_COMMENT_STYLE);
  tokenizer.set_allow_f_after_float(true);
  ByteColumns columns(text), fault_columns(text);

  std::vector<Token> tokens;
  for (bool more = true; more;) {
    more = tokenizer.Next();
    const io::Tokenizer::Token& read = tokenizer.current();
    Token token;
    token.kind = more ? kind_of(read.type) : Token::end;
    token.word = read.text;
    token.line = read.line + 1;
    token.column = columns.at(read.line, read.column);
    for (const Token::Fault& fault : collector.faults) {
      token.faults.push_back({fault.line + 1, fault_columns.at(fault.line, fault.column), fault.sentence});
    }
    collector.faults.clear();
    tokens.push_back(std::move(token));
  }
  return tokens;
}

}  // namespace couplet::scene
