// The scene with every default written out, so that a run can be repeated from its folder.

#include <google/protobuf/text_format.h>

#include "proto/report/version.hpp"
#include "proto/scene/field_facts.hpp"
#include "proto/scene/read_scene.hpp"

namespace couplet::scene {

namespace {

using google::protobuf::Message;
using google::protobuf::Reflection;

void set_default(const FieldDescriptor& field, Message& message) {
  const Reflection& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      reflection.SetBool(&message, &field, field.default_value_bool());
      break;
    case FieldDescriptor::CPPTYPE_INT32:
      reflection.SetInt32(&message, &field, field.default_value_int32());
      break;
    case FieldDescriptor::CPPTYPE_DOUBLE:
      reflection.SetDouble(&message, &field, field.default_value_double());
      break;
    case FieldDescriptor::CPPTYPE_ENUM:
      reflection.SetEnum(&message, &field, field.default_value_enum());
      break;
    case FieldDescriptor::CPPTYPE_STRING:
      reflection.SetString(&message, &field, field.default_value_string());
      break;
    default:
      break;
  }
}

// Blocks that are absent stay absent: what a scene does not name is not computed.
void fill_in_defaults(Message& message) {
  const Descriptor& descriptor = *message.GetDescriptor();
  const Reflection& reflection = *message.GetReflection();
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor& field = *descriptor.field(i);
    if (is_message(field) && field.is_repeated()) {
      const int n_entries = reflection.FieldSize(message, &field);
      for (int j = 0; j < n_entries; ++j) fill_in_defaults(*reflection.MutableRepeatedMessage(&message, &field, j));
    } else if (is_message(field)) {
      if (reflection.HasField(message, &field)) fill_in_defaults(*reflection.MutableMessage(&message, &field));
    } else if (field.has_default_value() && field.real_containing_oneof() == nullptr &&
               !reflection.HasField(message, &field)) {
      set_default(field, message);
    }
  }
}

}  // namespace

std::string resolved_scene_text(const v1::Scene& scene) {
  v1::Scene resolved = scene;
  fill_in_defaults(resolved);
  std::string text;
  google::protobuf::TextFormat::Printer printer;
  printer.SetUseUtf8StringEscaping(true);
  printer.PrintToString(resolved, &text);
  return "# proto-file: couplet/v1/scene.proto\n# proto-message: couplet.v1.Scene\n# All defaults filled in by "
         "Couplet " +
         report::version() + ", commit " + report::commit() + ".\n\n" + text;
}

}  // namespace couplet::scene
