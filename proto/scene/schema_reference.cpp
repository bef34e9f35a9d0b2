#include "proto/scene/schema_reference.hpp"

#include <sstream>

#include "couplet/v1/rules.pb.h"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

constexpr std::size_t line_length = 100;

// Words broken into lines, each behind the same number of spaces.
std::string paragraph(const std::string& text, int indentation) {
  const std::string margin(static_cast<std::size_t>(indentation), ' ');
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && margin.size() + line.size() + 1 + word.size() > line_length) {
      lines += margin + line + '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? lines : lines + margin + line + '\n';
}

std::string kind_of(const FieldDescriptor& field) {
  if (field.options().GetExtension(v1::is_file)) return "file";
  if (field.options().GetExtension(v1::is_expression)) return "formula in x, y, z, t, pi";
  if (field.options().GetExtension(v1::is_name)) return "name";
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return short_name(*field.message_type());
    case FieldDescriptor::CPPTYPE_ENUM:
      return either_of(choice_names(*field.enum_type()));
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      return "text";
    case FieldDescriptor::CPPTYPE_INT32:
      return "whole number";
    default:
      return "number";
  }
}

std::string default_text(const FieldDescriptor& field) {
  if (!field.has_default_value()) return {};
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_ENUM:
      return field.default_value_enum()->name();
    case FieldDescriptor::CPPTYPE_BOOL:
      return field.default_value_bool() ? "true" : "false";
    case FieldDescriptor::CPPTYPE_STRING:
      return '"' + field.default_value_string() + '"';
    case FieldDescriptor::CPPTYPE_INT32:
      return std::to_string(field.default_value_int32());
    default:
      return number_text(field.default_value_double());
  }
}

// `number [Pa], above 0, default 1e8`
std::string facts(const FieldDescriptor& field) {
  std::string text = (field.is_repeated() ? "list of " : "") + kind_of(field);
  const std::string unit = unit_text(field);
  if (!unit.empty()) text += " [" + unit.substr(1) + "]";
  const v1::Count& count = field.options().GetExtension(v1::count);
  if (count.has_at_least()) text += ", at least " + std::to_string(count.at_least());
  if (count.has_at_most()) text += ", at most " + std::to_string(count.at_most());
  const std::string range = range_text(field);
  if (!range.empty()) text += ", " + range;
  const std::string default_value = default_text(field);
  if (!default_value.empty()) text += ", default " + default_value;
  if (field.options().GetExtension(v1::must_be_given)) text += ", must be given";
  return text;
}

}  // namespace

std::string field_reference(const FieldDescriptor& field, const std::string& path, int indentation) {
  std::string text = paragraph(path + ": " + facts(field), indentation);
  text += paragraph(field.options().GetExtension(v1::meaning), indentation + 4);
  if (field.cpp_type() != FieldDescriptor::CPPTYPE_ENUM) return text;
  for (int i = 0; i < field.enum_type()->value_count(); ++i) {
    const google::protobuf::EnumValueDescriptor& value = *field.enum_type()->value(i);
    text += paragraph(value.name() + ": " + value.options().GetExtension(v1::choice), indentation + 6);
  }
  return text;
}

std::string message_reference(const Descriptor& message, const std::string& path) {
  std::string text = short_name(message) + (path.empty() ? "" : "  (" + path + ")") + '\n';
  text += paragraph(message.options().GetExtension(v1::about), 0) + '\n';
  const OneofDescriptor* choice = nullptr;
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    if (field.real_containing_oneof() != nullptr && field.real_containing_oneof() != choice) {
      const bool is_required = field.real_containing_oneof()->options().GetExtension(v1::one_must_be_given);
      text += paragraph(std::string(is_required ? "one" : "at most one") + " of these (" +
                            field.real_containing_oneof()->name() + "):",
                        2);
    }
    choice = field.real_containing_oneof();
    text += field_reference(field, field.name(), choice == nullptr ? 2 : 4);
  }
  return text;
}

std::string short_name(const Descriptor& message) {
  return message.full_name().substr(message.file()->package().size() + 1);
}

}  // namespace couplet::scene
