#pragma once
// How the reference of the scene language reads: one page a message, one entry a field.

#include <string>

#include "proto/scene/field_facts.hpp"

namespace couplet::scene {

/// Name, kind, unit, limits, default and meaning of a field; of a choice of names also what each name means.
/// `path` is what stands for its name.
std::string field_reference(const FieldDescriptor& field, const std::string& path, int indentation);

/// What a message is for and its fields; those of which only one may be given stand together. `path`: where it first
/// stands in a scene.
std::string message_reference(const Descriptor& message, const std::string& path);

/// Name of a message as it is printed: TimeTable.Row of couplet.v1.TimeTable.Row.
std::string short_name(const Descriptor& message);

}  // namespace couplet::scene
