#pragma once
// Where every field of a scene was given.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/scene/complaint.hpp"

namespace couplet::scene {

/// One given field with the fields inside it. Mirrors the message: entry i of a repeated field is entry i here.
class FieldTree {
 public:
  std::string path;      // solid.body[0].material; empty at the root
  Place place;           // of the field's name (an entry of a list: of the entry)
  bool unclear = false;  // its text could not be read to the end: nothing in it counts as missing

  /// Path of a field inside this one, entry `index` when it is a list (index >= 0).
  std::string path_to(const std::string& name, int index = -1) const;

  /// Path of the entry that add() would make.
  std::string path_of_next(const std::string& name, bool is_list) const;
  FieldTree& add(const std::string& name, bool is_list, const Place& at);
  /// Remembers that a field was given but could not be read.
  void remember_unreadable(const std::string& name, const Place& at);

  /// Forgets what was given for a field, so that something else can be given.
  void clear(const std::string& name);
  /// Keeps the first n entries only.
  void keep_first(const std::string& name, int n);
  /// Takes a field from another tree of the same block, or only one entry of it.
  void take(const std::string& name, std::optional<int> index, const FieldTree& other);

  const FieldTree* entry(const std::string& name, int index = 0) const;
  FieldTree* entry(const std::string& name, int index = 0);
  /// True when the field stands in the scene, readable or not.
  bool is_given(const std::string& name) const;
  /// True when the field stands in the scene but could not be read, or an entry of it could not.
  bool is_unreadable(const std::string& name) const { return unreadable_.contains(name); }
  /// Place of the first time a field was given; nullptr when it was not.
  const Place* first_place(const std::string& name) const;

  /// The deepest given field on the way along a path such as solid.body[0].material: the field itself if it is given.
  const FieldTree& deepest(const std::string& wanted_path) const;

 private:
  std::map<std::string, std::vector<FieldTree>> entries_;
  std::map<std::string, Place> unreadable_;
};

}  // namespace couplet::scene
