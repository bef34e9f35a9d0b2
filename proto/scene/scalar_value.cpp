#include "proto/scene/scalar_value.hpp"

#include <google/protobuf/io/tokenizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "proto/scene/field_facts.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

using google::protobuf::EnumValueDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;
using google::protobuf::io::Tokenizer;

bool is_number(const ScalarText& value) {
  return value.kind == Token::integer || value.kind == Token::decimal;
}

std::string no_number(const ScalarText& value, const FieldDescriptor& field) {
  return value.text() + " is not a number; " + remedy(field);
}

// "inf", "infinity" and "nan" are numbers of the text format; the check of finite numbers refuses them by name.
std::optional<double> named_number(const ScalarText& value) {
  if (value.kind != Token::identifier) return std::nullopt;
  std::string word = value.word;
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  if (word == "inf" || word == "infinity") return std::numeric_limits<double>::infinity();
  if (word == "nan") return std::numeric_limits<double>::quiet_NaN();
  return std::nullopt;
}

std::string put_double(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  double number = 0;
  if (const std::optional<double> named = named_number(value)) {
    number = *named;
  } else if (!is_number(value)) {
    return no_number(value, field);
  } else {
    const bool is_octal_or_hex = value.kind == Token::integer && value.word.size() > 1 && value.word[0] == '0';
    if (is_octal_or_hex) return value.text() + " is no decimal number; write it without the leading 0";
    number = Tokenizer::ParseFloat(value.word);
    if (std::isinf(number)) return value.text() + " is too large for a number; " + remedy(field);
  }
  if (value.is_negative) number = -number;
  const Reflection& reflection = *message.GetReflection();
  field.is_repeated() ? reflection.AddDouble(&message, &field, number) : reflection.SetDouble(&message, &field, number);
  return {};
}

std::string put_whole(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  if (value.kind == Token::decimal)
    return value.text() + " is not a whole number; leave out the point and the exponent";
  if (value.kind != Token::integer) return no_number(value, field);
  const std::uint64_t most = value.is_negative ? 2147483648U : 2147483647U;
  std::uint64_t magnitude = 0;
  if (!Tokenizer::ParseInteger(value.word, most, &magnitude)) {
    return value.text() + " is too " + (value.is_negative ? "small" : "large") + "; whole numbers end at " +
           (value.is_negative ? "-" : "") + std::to_string(most);
  }
  const auto number = static_cast<std::int32_t>(value.is_negative ? -static_cast<std::int64_t>(magnitude)
                                                                  : static_cast<std::int64_t>(magnitude));
  const Reflection& reflection = *message.GetReflection();
  field.is_repeated() ? reflection.AddInt32(&message, &field, number) : reflection.SetInt32(&message, &field, number);
  return {};
}

std::string put_bool(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  const auto is_any_of = [&](std::initializer_list<const char*> words) {
    return !value.is_negative && (value.kind == Token::identifier || value.kind == Token::integer) &&
           std::find(words.begin(), words.end(), value.word) != words.end();
  };
  const bool is_true = is_any_of({"true", "True", "t", "1"});
  if (!is_true && !is_any_of({"false", "False", "f", "0"})) {
    return value.text() + " is neither true nor false; " + remedy(field);
  }
  const Reflection& reflection = *message.GetReflection();
  field.is_repeated() ? reflection.AddBool(&message, &field, is_true) : reflection.SetBool(&message, &field, is_true);
  return {};
}

std::string put_choice(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  const EnumDescriptor& choices = *field.enum_type();
  const EnumValueDescriptor* chosen = nullptr;
  std::uint64_t number = 0;
  if (value.kind == Token::identifier && !value.is_negative) chosen = choices.FindValueByName(value.word);
  if (value.kind == Token::integer && !value.is_negative && Tokenizer::ParseInteger(value.word, INT32_MAX, &number)) {
    chosen = choices.FindValueByNumber(static_cast<int>(number));
  }
  if (chosen == nullptr) {
    if (value.kind == Token::text && choices.FindValueByName(value.word) != nullptr) {
      return value.text() + " is text; write " + value.word + " without quotes";
    }
    return value.text() + " is not a choice here; " + suggestion(value.word, choice_names(choices), "choose");
  }
  const Reflection& reflection = *message.GetReflection();
  field.is_repeated() ? reflection.AddEnum(&message, &field, chosen) : reflection.SetEnum(&message, &field, chosen);
  return {};
}

std::string put_text(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  if (value.kind != Token::text) return value.text() + " is not in quotes; write \"" + value.text() + "\"";
  const Reflection& reflection = *message.GetReflection();
  field.is_repeated() ? reflection.AddString(&message, &field, value.word)
                      : reflection.SetString(&message, &field, value.word);
  return {};
}

}  // namespace

std::string ScalarText::text() const {
  if (kind == Token::text) return "\"" + word + "\"";
  return (is_negative ? "-" : "") + word;
}

std::string put_scalar(const ScalarText& value, const FieldDescriptor& field, Message& message) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return put_double(value, field, message);
    case FieldDescriptor::CPPTYPE_BOOL:
      return put_bool(value, field, message);
    case FieldDescriptor::CPPTYPE_ENUM:
      return put_choice(value, field, message);
    case FieldDescriptor::CPPTYPE_STRING:
      return put_text(value, field, message);
    case FieldDescriptor::CPPTYPE_INT32:
      return put_whole(value, field, message);
    default:
      break;
  }
  throw std::logic_error("the scene language has no values of the type of " + field.full_name());
}

}  // namespace couplet::scene
