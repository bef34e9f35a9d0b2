#include "proto/scene/message_parser.hpp"

#include <google/protobuf/io/tokenizer.h>

#include <memory>

#include "proto/scene/field_facts.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

// body[0] of a list, fluid of a single field: where the value that comes next will stand.
std::string path_of_next(const FieldDescriptor& field, const FieldTree& tree) {
  return tree.path_of_next(field.name(), field.is_repeated());
}

std::string where(const Place& first) {
  return first.setting.empty() ? "in line " + std::to_string(first.line) : "before";
}

}  // namespace

bool MessageParser::parse_all(Message& message, FieldTree& tree) {
  parse_fields(message, tree);
  cursor_.advance(tree.path);  // complains about what cannot be read at the very end
  return cursor_.braces_match();
}

bool MessageParser::parse_value_of(const FieldDescriptor& field, Message& message, FieldTree& tree) {
  const std::string path = path_of_next(field, tree);
  const Token start = cursor_.now();
  if (start.is("[")) {
    parse_list(field, start, message, tree);
  } else if (cursor_.starts_scalar() || start.opens()) {
    parse_value(field, start, false, message, tree);
  } else {
    refuse(field, start, tree, "has no value; " + remedy(field));
  }
  if (!cursor_.at_end() && cursor_.before().faults.empty()) {
    cursor_.complain(cursor_.now(), path,
                     "\"" + cursor_.now().word + "\" stands behind the value; give one value only");
  }
  while (!cursor_.at_end()) cursor_.advance(path);
  cursor_.advance(path);
  return cursor_.braces_match();
}

void MessageParser::parse_fields(Message& message, FieldTree& tree) {
  while (!cursor_.at_end()) {
    const Token& now = cursor_.now();
    const bool is_quoted_name = now.kind == Token::text && cursor_.ahead(1).is(":");
    if (now.extra) {
      cursor_.advance(tree.path);
    } else if (now.closes()) {
      return;
    } else if (now.kind == Token::identifier || is_quoted_name) {
      parse_field(message, tree);
    } else {
      if (now.faults.empty()) {
        cursor_.complain(now, tree.path,
                         "a field should start here, not " + now.word + "; write NAME: VALUE or NAME { ... }");
      }
      tree.unclear = true;
      cursor_.skip_rest_of_line(tree.path);
    }
  }
}

void MessageParser::parse_field(Message& message, FieldTree& tree) {
  Token name = cursor_.now();
  if (name.kind == Token::text) {
    google::protobuf::io::Tokenizer::ParseString(cursor_.now().word, &name.word);
    cursor_.complain(name, tree.path_to(name.word), "names stand without quotes; write " + name.word + ":");
  }
  cursor_.advance(tree.path);
  const FieldDescriptor* const field = message.GetDescriptor()->FindFieldByName(name.word);
  if (field == nullptr) {
    parse_unknown_field(name, message, tree);
  } else if (may_be_given(*field, name, tree)) {
    parse_known_field(*field, name, message, tree);
  } else {
    const std::unique_ptr<Message> ignored(message.New());
    FieldTree ignored_tree;
    ignored_tree.path = tree.path;
    parse_known_field(*field, name, *ignored, ignored_tree);
  }
}

// A colon, or an equals sign where a colon should be.
bool MessageParser::parse_colon(const std::string& path) {
  if (cursor_.now().is("=")) {
    cursor_.complain(cursor_.now(), path, "an equals sign stands where a colon should be; write NAME: VALUE");
  } else if (!cursor_.now().is(":")) {
    return false;
  }
  cursor_.advance(path);
  return true;
}

void MessageParser::parse_known_field(const FieldDescriptor& field, const Token& name, Message& message,
                                      FieldTree& tree) {
  const std::string path = path_of_next(field, tree);
  const bool has_colon = parse_colon(path);
  const bool is_list = cursor_.now().is("[");
  const bool has_value = cursor_.now().opens() || is_list || (cursor_.starts_scalar() && !cursor_.starts_field());
  if (!has_value) {
    refuse(field, name, tree, "has no value; " + remedy(field));
  } else {
    const bool needs_colon = !is_message(field) && !cursor_.now().opens();
    if (needs_colon && !has_colon) {
      cursor_.complain(name, path,
                       "has no colon; write " + name.word + ": " + cursor_.now().word +
                           (cursor_.now().is("-") ? cursor_.ahead(1).word : ""));
    }
    is_list ? parse_list(field, name, message, tree) : parse_value(field, name, false, message, tree);
  }
  if (cursor_.now().is(",") || cursor_.now().is(";")) cursor_.advance(path);
}

void MessageParser::parse_unknown_field(const Token& name, Message& message, FieldTree& tree) {
  const Descriptor& descriptor = *message.GetDescriptor();
  const std::vector<std::string> names = field_names(descriptor);
  const std::string path = tree.path_to(name.word);
  cursor_.complain(name, path,
                   "is not a field of " + descriptor.name() + "; " + suggestion(name.word, names, "its fields are"));
  // Reads on as if the nearest name had been written, so that what is inside is checked and nothing counts as missing.
  const std::string meant = nearest_name(name.word, names);
  const FieldDescriptor* const field = meant.empty() ? nullptr : descriptor.FindFieldByName(meant);
  parse_colon(path);
  const bool is_free = field != nullptr && (field->is_repeated() || !tree.is_given(meant));
  if (is_free && is_message(*field) && cursor_.now().opens()) {
    parse_block(*field, name, message, tree);
  } else {
    if (is_free) tree.remember_unreadable(meant, cursor_.place_of(name));
    if (!cursor_.starts_field()) skip_unknown_value(path, message);
  }
  if (cursor_.now().is(",") || cursor_.now().is(";")) cursor_.advance(path);
}

void MessageParser::skip_unknown_value(const std::string& path, const Message& message) {
  const bool is_scalar = cursor_.starts_scalar();
  cursor_.skip_value(path);
  if (is_scalar && has_rest(message)) cursor_.skip_rest_of_line(path);
}

bool MessageParser::may_be_given(const FieldDescriptor& field, const Token& name, const FieldTree& tree) {
  if (field.is_repeated()) return true;
  const std::string path = tree.path_to(field.name());
  if (const Place* const first = tree.first_place(field.name())) {
    cursor_.complain(name, path, "is given a second time; it stands " + where(*first) + " already, delete one of them");
    return false;
  }
  const OneofDescriptor* const choice = field.real_containing_oneof();
  for (int i = 0; choice != nullptr && i < choice->field_count(); ++i) {
    const std::string& other = choice->field(i)->name();
    const Place* const first = tree.first_place(other);
    if (first == nullptr) continue;
    cursor_.complain(
        name, path,
        "contradicts " + other + " " + where(*first) + "; give only one of " + either_of(member_names(*choice)));
    return false;
  }
  return true;
}

void MessageParser::parse_value(const FieldDescriptor& field, const Token& at, bool in_list, Message& message,
                                FieldTree& tree) {
  const bool is_block = cursor_.now().opens();
  if (is_message(field) && is_block) {
    parse_block(field, at, message, tree);
  } else if (is_message(field) || is_block) {
    refuse(field, at, tree,
           (is_block ? "is a single value and no block; " : "is a block and no single value; ") + remedy(field));
    cursor_.skip_value(tree.path_to(field.name()));
  } else {
    parse_scalar(field, at, in_list, message, tree);
  }
}

void MessageParser::parse_list(const FieldDescriptor& field, const Token& name, Message& message, FieldTree& tree) {
  const std::string path = tree.path_to(field.name());
  if (!field.is_repeated()) {
    refuse(field, name, tree, "is not a list; leave out the brackets");
    cursor_.skip_value(path);
    return;
  }
  const auto breaks_off = [&] { return cursor_.at_end() || cursor_.now().closes() || cursor_.starts_field(); };
  cursor_.advance(path);
  while (!cursor_.now().is("]") && !breaks_off()) {
    const Token entry = cursor_.now();
    if (entry.opens() || cursor_.starts_scalar()) {
      parse_value(field, entry, true, message, tree);
    } else {
      cursor_.complain(entry, path, "an entry should stand here, not " + entry.word + "; write [A, B, C]");
      tree.remember_unreadable(field.name(), cursor_.place_of(entry));
      if (!entry.is(",")) cursor_.skip_rest_of_line(path, true);
    }
    if (cursor_.now().is("]") || breaks_off()) break;
    if (!cursor_.now().is(",")) {
      cursor_.complain(cursor_.now(), path, "a comma is missing before " + cursor_.now().word + "; write [A, B, C]");
      if (!cursor_.starts_scalar() && !cursor_.now().opens()) cursor_.skip_rest_of_line(path, true);
      continue;
    }
    const Token comma = cursor_.now();
    cursor_.advance(path);
    if (cursor_.now().is("]")) cursor_.complain(comma, path, "a comma stands before the end of the list; delete it");
  }
  if (breaks_off()) {
    cursor_.complain(name, path, "its [ is not closed; add ]");
  } else {
    cursor_.advance(path);
  }
}

void MessageParser::parse_block(const FieldDescriptor& field, const Token& at, Message& message, FieldTree& tree) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  Message* const inner =
      field.is_repeated() ? reflection.AddMessage(&message, &field) : reflection.MutableMessage(&message, &field);
  FieldTree& inner_tree = tree.add(field.name(), field.is_repeated(), cursor_.place_of(at));
  const Token opening = cursor_.now();
  cursor_.advance(inner_tree.path);
  parse_fields(*inner, inner_tree);
  const Token closing = cursor_.now();
  if (closing.mended) {
    cursor_.complain_of_brace(at, inner_tree.path, "its " + opening.word + " is not closed; add }");
  } else if (opening.is("{") != closing.is("}")) {
    cursor_.complain(closing, inner_tree.path,
                     "a block that " + opening.word + " opens is closed by " + closing.word + "; use { and }");
  }
  cursor_.advance(inner_tree.path);
}

void MessageParser::parse_scalar(const FieldDescriptor& field, const Token& at, bool in_list, Message& message,
                                 FieldTree& tree) {
  const std::string path = path_of_next(field, tree);
  ScalarText value;
  if (!cursor_.read_scalar(path, in_list, value)) {
    tree.remember_unreadable(field.name(), cursor_.place_of(at));
    if (!in_list && has_rest(message)) cursor_.skip_rest_of_line(path);
    return;
  }
  if (!in_list && has_rest(message)) {
    const std::string rest = cursor_.now().word;
    if (cursor_.now().faults.empty()) {
      cursor_.complain(at, path,
                       "\"" + rest + "\" stands behind the value; write one value, without unit and arithmetic");
    }
    tree.remember_unreadable(field.name(), cursor_.place_of(at));
    cursor_.skip_rest_of_line(path);
    return;
  }
  const std::string wrong = put_scalar(value, field, message);
  if (wrong.empty()) {
    tree.add(field.name(), field.is_repeated(), cursor_.place_of(at));
  } else {
    refuse(field, at, tree, wrong);
  }
}

void MessageParser::refuse(const FieldDescriptor& field, const Token& at, FieldTree& tree,
                           const std::string& sentence) {
  cursor_.complain(at, path_of_next(field, tree), sentence);
  tree.remember_unreadable(field.name(), cursor_.place_of(at));
}

// Whether something that is no field stands behind the value on the same line: a unit, arithmetic.
bool MessageParser::has_rest(const Message& message) const {
  const Token& now = cursor_.now();
  const bool is_field = cursor_.starts_field() || (now.kind == Token::identifier &&
                                                   message.GetDescriptor()->FindFieldByName(now.word) != nullptr);
  const bool is_separator = now.is(",") || now.is(";");
  return now.line == cursor_.before().line && !is_field && !is_separator && !now.closes() && !cursor_.at_end();
}

}  // namespace couplet::scene
