#pragma once
// What the schema says about a field, in words.

#include <google/protobuf/descriptor.h>

#include <string>
#include <vector>

namespace couplet::scene {

using google::protobuf::Descriptor;
using google::protobuf::EnumDescriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::OneofDescriptor;

std::vector<std::string> field_names(const Descriptor& message);
std::vector<std::string> choice_names(const EnumDescriptor& choices);
std::vector<std::string> member_names(const OneofDescriptor& choice);

/// Unit of a number with a space in front, ` kg/m^3`; empty for a number without one.
std::string unit_text(const FieldDescriptor& field);

/// Allowed range without the unit, `above 0` or `at least 0 and below 1`; empty without limits.
std::string range_text(const FieldDescriptor& field);

/// What a user should write: `give it in kg/m^3`, `choose B1, B2, M1 or M2`, `give fluid { ... }: the fluid`.
std::string remedy(const FieldDescriptor& field);

bool is_message(const FieldDescriptor& field);

}  // namespace couplet::scene
