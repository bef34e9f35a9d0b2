#include "proto/scene/apply_setting.hpp"

#include <memory>
#include <optional>

#include "proto/report/failure.hpp"
#include "proto/scene/field_facts.hpp"
#include "proto/scene/field_path.hpp"
#include "proto/scene/message_parser.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

using google::protobuf::Message;
using google::protobuf::Reflection;
using report::SceneError;

// A message of the scene and what is known about its places.
struct Block {
  Message* message;
  FieldTree* tree;
};

Place place_of(const std::string& setting) {
  return {0, 0, setting};
}

// The other members of a field's choice give way to it.
void clear_rivals(const FieldDescriptor& field, const Block& block) {
  const OneofDescriptor* const choice = field.real_containing_oneof();
  for (int i = 0; choice != nullptr && i < choice->field_count(); ++i) {
    if (choice->field(i) != &field) block.tree->clear(choice->field(i)->name());
  }
}

// A single block, made when it is not there.
Block enter(const FieldDescriptor& field, const Block& outer, const std::string& setting) {
  Message* const inner = outer.message->GetReflection()->MutableMessage(outer.message, &field);
  FieldTree* tree = outer.tree->entry(field.name());
  if (tree == nullptr) {
    clear_rivals(field, outer);
    tree = &outer.tree->add(field.name(), false, place_of(setting));
  }
  return {inner, tree};
}

// An entry of a list, made when it is the one behind the last.
Block enter_list(const FieldDescriptor& field, int index, const Block& outer, const std::string& setting) {
  const Reflection& reflection = *outer.message->GetReflection();
  if (index == reflection.FieldSize(*outer.message, &field)) {
    Message* const inner = reflection.AddMessage(outer.message, &field);
    return {inner, &outer.tree->add(field.name(), true, place_of(setting))};
  }
  return {reflection.MutableRepeatedMessage(outer.message, &field, index), outer.tree->entry(field.name(), index)};
}

void check_index(const FieldDescriptor& field, const PathStep& step, const Block& block) {
  const std::string name = field.name();
  if (!field.is_repeated()) {
    if (step.index) throw SceneError("", name + " is not a list", "leave out [" + std::to_string(*step.index) + "]");
    return;
  }
  const int n_entries = block.message->GetReflection()->FieldSize(*block.message, &field);
  const std::string next = name + "[" + std::to_string(n_entries) + "] appends";
  if (!step.index) throw SceneError("", name + " is a list", "name one entry, " + name + "[0]; " + next);
  if (*step.index > n_entries) {
    throw SceneError("", name + " has " + std::to_string(n_entries) + (n_entries == 1 ? " entry" : " entries"), next);
  }
}

// The chosen member, of one of the message's choices, that has a field of this name.
const FieldDescriptor* chosen_member_with(const std::string& name, const Message& message) {
  const Descriptor& descriptor = *message.GetDescriptor();
  for (int i = 0; i < descriptor.real_oneof_decl_count(); ++i) {
    const FieldDescriptor* const chosen =
        message.GetReflection()->GetOneofFieldDescriptor(message, descriptor.oneof_decl(i));
    if (chosen != nullptr && is_message(*chosen) && chosen->message_type()->FindFieldByName(name) != nullptr) {
      return chosen;
    }
  }
  return nullptr;
}

// A member that could have been chosen and has a field of this name.
const FieldDescriptor* other_member_with(const std::string& name, const Descriptor& descriptor) {
  for (int i = 0; i < descriptor.field_count(); ++i) {
    const FieldDescriptor& member = *descriptor.field(i);
    if (member.real_containing_oneof() == nullptr || !is_message(member)) continue;
    if (member.message_type()->FindFieldByName(name) != nullptr) return &member;
  }
  return nullptr;
}

[[noreturn]] void refuse_name(const std::string& name, const Message& message) {
  const Descriptor& descriptor = *message.GetDescriptor();
  if (const FieldDescriptor* const other = other_member_with(name, descriptor)) {
    throw SceneError("", name + " is a field of " + other->name() + ", which is not chosen",
                     "choose it first with " + other->name() + "={ ... }");
  }
  std::vector<std::string> names = field_names(descriptor);
  for (int i = 0; i < descriptor.real_oneof_decl_count(); ++i) {
    const FieldDescriptor* const chosen =
        message.GetReflection()->GetOneofFieldDescriptor(message, descriptor.oneof_decl(i));
    if (chosen == nullptr || !is_message(*chosen)) continue;
    for (const std::string& inner : field_names(*chosen->message_type())) names.push_back(inner);
  }
  throw SceneError("", name + " is not a field of " + descriptor.name(), suggestion(name, names, "its fields are"));
}

// The field of a step, after going through the chosen member of a choice where that is what has it.
const FieldDescriptor& find_field(const PathStep& step, Block& block, const std::string& setting) {
  if (const FieldDescriptor* const own = block.message->GetDescriptor()->FindFieldByName(step.name)) return *own;
  const FieldDescriptor* const member = chosen_member_with(step.name, *block.message);
  if (member == nullptr) refuse_name(step.name, *block.message);
  block = enter(*member, block, setting);
  return *block.message->GetDescriptor()->FindFieldByName(step.name);
}

Block enter_step(const PathStep& step, Block block, const std::string& setting) {
  const FieldDescriptor& field = find_field(step, block, setting);
  if (!is_message(field)) throw SceneError("", field.name() + " is a single value", "end the path there");
  check_index(field, step, block);
  return field.is_repeated() ? enter_list(field, *step.index, block, setting) : enter(field, block, setting);
}

// Text may stand without quotes, so that a shell needs none.
std::string quoted_where_needed(const FieldDescriptor& field, const std::string& value) {
  const bool is_text = field.cpp_type() == FieldDescriptor::CPPTYPE_STRING;
  const bool is_quoted = !value.empty() && (value.front() == '"' || value.front() == '\'' || value.front() == '[');
  if (!is_text || is_quoted) return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

bool has_any(const Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  return field.is_repeated() ? reflection.FieldSize(message, &field) > 0 : reflection.HasField(message, &field);
}

// Puts the field of `given` in place of what the block has: of one entry of a list when there is an index.
void take(const FieldDescriptor& field, std::optional<int> index, const Message& given, Message& message) {
  const Reflection& reflection = *message.GetReflection();
  if (!index) reflection.ClearField(&message, &field);
  const int n_before = index ? reflection.FieldSize(message, &field) : 0;
  message.MergeFrom(given);
  if (!index || *index == n_before) return;
  reflection.SwapElements(&message, &field, *index, n_before);
  reflection.RemoveLast(&message, &field);
}

bool put_value(const PathStep& step, const std::string& value, Block block, const std::string& setting,
               ComplaintList& complaints) {
  const FieldDescriptor& field = find_field(step, block, setting);
  if (value.empty() && is_message(field) && !field.is_repeated()) {  // PATH= takes a block out of the scene
    block.message->GetReflection()->ClearField(block.message, &field);
    return true;
  }
  const std::string text = quoted_where_needed(field, value);
  const bool is_whole_list = field.is_repeated() && !step.index && text.starts_with('[');
  if (!is_whole_list) check_index(field, step, block);

  const std::unique_ptr<Message> given(block.message->New());
  FieldTree given_tree = *block.tree;
  given_tree.keep_first(field.name(), step.index.value_or(0));
  const std::size_t n_complaints = complaints.size();
  MessageParser parser(text, setting, complaints);
  const bool braces_match = parser.parse_value_of(field, *given, given_tree);
  if (!has_any(*given, field) && complaints.size() > n_complaints) {
    block.tree->remember_unreadable(field.name(), place_of(setting));
    return braces_match;
  }
  clear_rivals(field, block);
  take(field, step.index, *given, *block.message);
  block.tree->take(field.name(), step.index, given_tree);
  return braces_match;
}

}  // namespace

bool apply_setting(const std::string& setting, Message& scene, FieldTree& tree, ComplaintList& complaints) {
  const std::size_t equals = setting.find('=');
  try {
    if (equals == std::string::npos) {
      throw SceneError("", "a setting needs a value", "write --set PATH=VALUE, for example --set time.step=1e-5");
    }
    const std::vector<PathStep> steps = split_path(setting.substr(0, equals));
    Block block{&scene, &tree};
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) block = enter_step(steps[i], block, setting);
    return put_value(steps.back(), setting.substr(equals + 1), block, setting, complaints);
  } catch (const SceneError& error) {
    complaints.add(place_of(setting), "", error.sentence() + "; " + error.advice());
    return true;
  }
}

}  // namespace couplet::scene
