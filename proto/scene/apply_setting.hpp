#pragma once
// --set PATH=VALUE: one field of a scene from the command line.

#include <google/protobuf/message.h>

#include <string>

#include "proto/scene/complaint.hpp"
#include "proto/scene/field_tree.hpp"

namespace couplet::scene {

/// Sets the field; blocks on the way to it that the scene does not have are added. A name that a block does not have,
/// but the chosen member of one of its choices does, is looked for there: material.young_modulus. The index behind the
/// last entry of a list appends. Complaints name the setting.
/// Returns false when the value's braces do not match.
bool apply_setting(const std::string& setting, google::protobuf::Message& scene, FieldTree& tree,
                   ComplaintList& complaints);

}  // namespace couplet::scene
