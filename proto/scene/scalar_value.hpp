#pragma once
// A single value of a scene's text and the field that takes it.

#include <google/protobuf/message.h>

#include <string>

#include "proto/scene/scene_tokens.hpp"

namespace couplet::scene {

struct ScalarText {
  Token::Kind kind = Token::end;
  bool is_negative = false;
  std::string word;  // as written without the sign; of a text: what stands between the quotes

  std::string text() const;  // as a complaint quotes it
};

/// Sets a field that is no list, or appends to one that is. Returns what is wrong with the value and the remedy;
/// empty when it fits.
std::string put_scalar(const ScalarText& value, const google::protobuf::FieldDescriptor& field,
                       google::protobuf::Message& message);

}  // namespace couplet::scene
