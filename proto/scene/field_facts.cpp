#include "proto/scene/field_facts.hpp"

#include "couplet/v1/rules.pb.h"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

std::vector<std::string> field_names(const Descriptor& message) {
  std::vector<std::string> names;
  for (int i = 0; i < message.field_count(); ++i) names.push_back(message.field(i)->name());
  return names;
}

std::vector<std::string> choice_names(const EnumDescriptor& choices) {
  std::vector<std::string> names;
  for (int i = 0; i < choices.value_count(); ++i) names.push_back(choices.value(i)->name());
  return names;
}

std::vector<std::string> member_names(const OneofDescriptor& choice) {
  std::vector<std::string> names;
  for (int i = 0; i < choice.field_count(); ++i) names.push_back(choice.field(i)->name());
  return names;
}

std::string unit_text(const FieldDescriptor& field) {
  const std::string& unit = field.options().GetExtension(v1::unit);
  return unit.empty() || unit == "1" || unit == "SI" ? "" : " " + unit;
}

std::string range_text(const FieldDescriptor& field) {
  const v1::Limits& limits = field.options().GetExtension(v1::limits);
  std::vector<std::string> sides;
  if (limits.has_above()) sides.push_back("above " + number_text(limits.above()));
  if (limits.has_at_least()) sides.push_back("at least " + number_text(limits.at_least()));
  if (limits.has_below()) sides.push_back("below " + number_text(limits.below()));
  if (limits.has_at_most()) sides.push_back("at most " + number_text(limits.at_most()));
  std::string text;
  for (const std::string& side : sides) text += (text.empty() ? "" : " and ") + side;
  return text;
}

bool is_message(const FieldDescriptor& field) {
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
}

std::string remedy(const FieldDescriptor& field) {
  const std::string& meaning = field.options().GetExtension(v1::meaning);
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "give " + field.name() + " { ... }" + (meaning.empty() ? "" : ": " + meaning);
    case FieldDescriptor::CPPTYPE_ENUM:
      return "choose " + either_of(choice_names(*field.enum_type()));
    case FieldDescriptor::CPPTYPE_BOOL:
      return "give true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      return "give it in quotes" + (meaning.empty() ? "" : ": " + meaning);
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT: {
      const std::string unit = unit_text(field);
      return unit.empty() ? "give a number" : "give it in" + unit;
    }
    default:
      return "give a whole number";
  }
}

}  // namespace couplet::scene
