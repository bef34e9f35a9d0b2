#pragma once
// The rules that the schema declares on the fields (rules.proto), checked by reflection.

#include <google/protobuf/message.h>

#include <filesystem>

#include "proto/scene/review.hpp"

namespace couplet::scene {

/// Missing fields, limits, numbers of entries, choices without a choice, files that do not exist, formulas that cannot
/// be read, numbers that are not finite: in the message and everything inside it. Relative paths start at `folder`.
void check_fields(const google::protobuf::Message& message, const std::filesystem::path& folder, Review& review);

}  // namespace couplet::scene
