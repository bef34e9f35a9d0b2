#include "proto/scene/check_scene.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <system_error>

#include "couplet/v1/rules.pb.h"
#include "proto/report/failure.hpp"
#include "proto/scene/expression.hpp"
#include "proto/scene/field_facts.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

using google::protobuf::Message;
using google::protobuf::Reflection;

// One field of a message; `index` is -1 for a field that is no list.
struct Entry {
  const Message& message;
  const FieldDescriptor& field;
  int index;

  double number() const {
    const Reflection& reflection = *message.GetReflection();
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_INT32) {
      return index < 0 ? reflection.GetInt32(message, &field) : reflection.GetRepeatedInt32(message, &field, index);
    }
    return index < 0 ? reflection.GetDouble(message, &field) : reflection.GetRepeatedDouble(message, &field, index);
  }
  std::string text() const {
    const Reflection& reflection = *message.GetReflection();
    return index < 0 ? reflection.GetString(message, &field) : reflection.GetRepeatedString(message, &field, index);
  }
  const Message& block() const {
    const Reflection& reflection = *message.GetReflection();
    return index < 0 ? reflection.GetMessage(message, &field) : reflection.GetRepeatedMessage(message, &field, index);
  }
};

bool is_control_character(char c) {
  return (c >= 0 && c < ' ') || c == 0x7F;
}

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
}

class FieldCheck {
 public:
  FieldCheck(const std::filesystem::path& folder, Review& review) : folder_(folder), review_(review) {}

  void check_message(const Message& message, const std::string& path) {
    const Descriptor& descriptor = *message.GetDescriptor();
    for (int i = 0; i < descriptor.field_count(); ++i) check_field(message, *descriptor.field(i), path);
    for (int i = 0; i < descriptor.real_oneof_decl_count(); ++i) {
      check_choice(message, *descriptor.oneof_decl(i), path);
    }
  }

 private:
  static std::string inside(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "." + name;
  }

  void check_field(const Message& message, const FieldDescriptor& field, const std::string& outer) {
    const Reflection& reflection = *message.GetReflection();
    const std::string path = inside(outer, field.name());
    if (field.is_repeated()) {
      const int n_entries = reflection.FieldSize(message, &field);
      check_count(field, n_entries, path);
      for (int i = 0; i < n_entries; ++i) check_entry({message, field, i}, path + "[" + std::to_string(i) + "]");
    } else if (reflection.HasField(message, &field)) {
      check_entry({message, field, -1}, path);
    } else if (field.options().GetExtension(v1::must_be_given)) {
      review_.complain_missing(path, "is missing; " + remedy(field));
    }
  }

  void check_entry(const Entry& entry, const std::string& path) {
    switch (entry.field.cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        check_message(entry.block(), path);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
      case FieldDescriptor::CPPTYPE_INT32:
        check_number(entry, path);
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        check_text(entry, path);
        break;
      default:
        break;
    }
  }

  void check_number(const Entry& entry, const std::string& path) {
    const double number = entry.number();
    if (!std::isfinite(number)) {
      review_.complain(path, number_text(number) + " is not a finite number; " + remedy(entry.field));
      return;
    }
    const v1::Limits& limits = entry.field.options().GetExtension(v1::limits);
    const std::string wrong = outside(limits, number);
    if (wrong.empty()) return;
    const std::string what =
        limits.has_remedy() ? limits.remedy() : "give a value " + range_text(entry.field) + unit_text(entry.field);
    review_.complain(path, number_text(number) + " is not " + wrong + "; " + what);
  }

  // The limit that a number breaks, `above 0`; empty when it keeps all of them.
  static std::string outside(const v1::Limits& limits, double number) {
    if (limits.has_above() && !(number > limits.above())) return "above " + number_text(limits.above());
    if (limits.has_at_least() && !(number >= limits.at_least())) return "at least " + number_text(limits.at_least());
    if (limits.has_below() && !(number < limits.below())) return "below " + number_text(limits.below());
    if (limits.has_at_most() && !(number <= limits.at_most())) return "at most " + number_text(limits.at_most());
    return {};
  }

  // Texts go into tables, file names, JSON and reports.
  void check_text(const Entry& entry, const std::string& path) {
    const std::string text = entry.text();
    if (entry.field.options().GetExtension(v1::is_file)) check_file(text, path);
    if (entry.field.options().GetExtension(v1::is_expression)) check_expression(text, path);
    const bool is_name = entry.field.options().GetExtension(v1::is_name);
    const bool is_required = entry.field.options().GetExtension(v1::must_be_given);
    if (is_required && text.empty()) {
      review_.complain(path, "is empty; " + remedy(entry.field));
    } else if (!is_utf8(text)) {
      review_.complain(path, "is not text in UTF-8; save the scene in UTF-8");
    } else if (std::any_of(text.begin(), text.end(), is_control_character)) {
      review_.complain(path, "holds a line break, a tab or another invisible character; write one line of text");
    } else if (is_name && !std::all_of(text.begin(), text.end(), is_name_character)) {
      review_.complain(path, "\"" + text + "\" is no name; use letters, digits, _ - and . only");
    }
  }

  void check_file(const std::string& name, const std::string& path) {
    const std::filesystem::path file = folder_ / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored)) return;
    const bool is_folder = std::filesystem::is_directory(file, ignored);
    review_.complain(path, "the file \"" + name + "\" " + (is_folder ? "is a folder" : "does not exist") +
                               "; give a file, its path starting from the folder of the scene");
  }

  void check_expression(const std::string& formula, const std::string& path) {
    try {
      Expression{formula};
    } catch (const report::SceneError& error) {
      review_.complain(path, error.sentence() + "; " + error.advice());
    }
  }

  void check_count(const FieldDescriptor& field, int n_entries, const std::string& path) {
    const v1::Count& count = field.options().GetExtension(v1::count);
    if (n_entries == 0 && count.at_least() > 0) {
      review_.complain_missing(path, "is missing; " + remedy(field));
    } else if (n_entries < count.at_least()) {
      review_.complain_missing(path, "has too few entries; give at least " + std::to_string(count.at_least()));
    }
    if (count.has_at_most() && n_entries > count.at_most()) {
      review_.complain(
          path + "[" + std::to_string(count.at_most()) + "]",
          "is one entry too many; at most " + std::to_string(count.at_most()) + " may be given, delete the others");
    }
  }

  void check_choice(const Message& message, const OneofDescriptor& choice, const std::string& path) {
    if (!choice.options().GetExtension(v1::one_must_be_given)) return;
    if (message.GetReflection()->HasOneof(message, &choice)) return;
    const std::vector<std::string> members = member_names(choice);
    review_.complain_missing_choice(path, members, "has no " + choice.name() + "; give " + either_of(members));
  }

  const std::filesystem::path& folder_;
  Review& review_;
};

}  // namespace

void check_fields(const Message& message, const std::filesystem::path& folder, Review& review) {
  FieldCheck(folder, review).check_message(message, "");
}

}  // namespace couplet::scene
