#include "proto/scene/describe_schema.hpp"

#include <algorithm>
#include <regex>
#include <set>

#include "couplet/v1/hosts.pb.h"
#include "couplet/v1/scene.pb.h"
#include "proto/report/failure.hpp"
#include "proto/scene/schema_reference.hpp"
#include "proto/scene/wording.hpp"

namespace couplet::scene {

namespace {

// Everything that a scene can be made of, in the order in which it stands there.
struct Language {
  struct Field {
    const FieldDescriptor* field;
    std::string path;  // solid.body.material
  };
  std::vector<Field> fields;
  struct Message {
    const Descriptor* message;
    std::string path;  // where it first stands
  };
  std::vector<Message> messages;  // each once
};

void collect(const Descriptor& message, const std::string& path, Language& language) {
  const auto is_this = [&](const Language::Message& known) { return known.message == &message; };
  if (std::none_of(language.messages.begin(), language.messages.end(), is_this)) {
    language.messages.push_back({&message, path});
  }
  for (int i = 0; i < message.field_count(); ++i) {
    const FieldDescriptor& field = *message.field(i);
    const std::string inner = path.empty() ? field.name() : path + "." + field.name();
    language.fields.push_back({&field, inner});
    if (is_message(field)) collect(*field.message_type(), inner, language);
  }
}

std::string pages_from(const Descriptor& start, const Language& language) {
  Language inside;
  collect(start, "", inside);
  std::string text;
  for (const Language::Message& page : inside.messages) {
    const auto is_this = [&](const Language::Message& known) { return known.message == page.message; };
    const auto found = std::find_if(language.messages.begin(), language.messages.end(), is_this);
    if (!text.empty()) text += '\n';
    text += message_reference(*page.message, found->path);
  }
  return text;
}

bool ends_with_path(const std::string& path, const std::string& end) {
  return path == end || (path.size() > end.size() && path.ends_with(end) && path[path.size() - end.size() - 1] == '.');
}

std::vector<std::string> all_names(const Language& language) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const Language::Message& known : language.messages) add(short_name(*known.message));
  for (const Language::Field& known : language.fields) add(known.field->name());
  return names;
}

}  // namespace

std::string describe_schema(const std::string& message) {
  Language language;
  collect(*v1::Scene::descriptor(), "", language);
  if (message.empty()) return pages_from(*v1::Scene::descriptor(), language);
  collect(*v1::Hosts::descriptor(), "file of hosts", language);

  const std::string package = v1::Scene::descriptor()->file()->package() + ".";
  const std::string wanted = message.starts_with(package) ? message.substr(package.size()) : message;
  for (const Language::Message& known : language.messages) {
    if (lower(short_name(*known.message)) == lower(wanted)) return pages_from(*known.message, language);
  }
  const std::string path = std::regex_replace(wanted, std::regex(R"(\[[0-9]*\])"), "");
  std::string text;
  for (const Language::Field& known : language.fields) {
    if (!ends_with_path(known.path, path)) continue;
    if (is_message(*known.field)) return pages_from(*known.field->message_type(), language);
    text += field_reference(*known.field, known.path, 0);
  }
  if (!text.empty()) return text;

  const std::string last = path.substr(path.rfind('.') + 1);
  const std::string nearest = nearest_name(last, all_names(language));
  throw report::SceneError("", "the scene language has no message or field \"" + message + "\"",
                           nearest.empty() ? "couplet describe lists all of them" : "did you mean " + nearest + "?");
}

}  // namespace couplet::scene
