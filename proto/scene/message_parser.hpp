#pragma once
// The text format of a scene, read to its end whatever is wrong with it.
//
//   message = *field
//   field   = name ":" ( scalar | list ) | name [":"] ( block | list )        followed by an optional , or ;
//   block   = "{" message "}" | "<" message ">"
//   list    = "[" [ value *( "," value ) ] "]"
//   scalar  = [ "-" ] number | word | 1*text
//
// The library's own reader of this format stops at the first error and points one word late; this one complains at
// the field itself and reads on. On texts without fault both build the same message (tested).

#include <google/protobuf/message.h>

#include <string>

#include "proto/scene/complaint.hpp"
#include "proto/scene/field_tree.hpp"
#include "proto/scene/token_cursor.hpp"

namespace couplet::scene {

class MessageParser {
 public:
  using Message = google::protobuf::Message;
  using FieldDescriptor = google::protobuf::FieldDescriptor;

  /// With a setting, that is the place of everything that is read.
  MessageParser(const std::string& text, const std::string& setting, ComplaintList& complaints)
      : cursor_(text, setting, complaints) {}

  /// Reads the whole text into a message. Returns false when braces were missing or too many, so that fields may have
  /// been read into other blocks than was meant.
  bool parse_all(Message& message, FieldTree& tree);

  /// Reads the whole text as the value of a field; of a list as one more entry, or as a [list] of them. Returns the
  /// same.
  bool parse_value_of(const FieldDescriptor& field, Message& message, FieldTree& tree);

 private:
  void parse_fields(Message& message, FieldTree& tree);
  void parse_field(Message& message, FieldTree& tree);
  bool parse_colon(const std::string& path);
  void parse_known_field(const FieldDescriptor& field, const Token& name, Message& message, FieldTree& tree);
  void parse_unknown_field(const Token& name, Message& message, FieldTree& tree);
  bool may_be_given(const FieldDescriptor& field, const Token& name, const FieldTree& tree);
  void parse_value(const FieldDescriptor& field, const Token& at, bool in_list, Message& message, FieldTree& tree);
  void parse_list(const FieldDescriptor& field, const Token& name, Message& message, FieldTree& tree);
  void parse_block(const FieldDescriptor& field, const Token& at, Message& message, FieldTree& tree);
  void parse_scalar(const FieldDescriptor& field, const Token& at, bool in_list, Message& message, FieldTree& tree);
  void refuse(const FieldDescriptor& field, const Token& at, FieldTree& tree, const std::string& sentence);
  void skip_unknown_value(const std::string& path, const Message& message);
  bool has_rest(const Message& message) const;

  TokenCursor cursor_;
};

}  // namespace couplet::scene
