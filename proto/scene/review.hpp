#pragma once
// What a rule about a scene works with: the scene's places and the list of complaints.

#include <string>
#include <vector>

#include "proto/scene/complaint.hpp"
#include "proto/scene/field_tree.hpp"

namespace couplet::scene {

class Review {
 public:
  /// With `braces_match` false, fields may stand in other blocks than was meant: nothing is then complained to be
  /// missing.
  Review(const FieldTree& tree, bool braces_match, ComplaintList& complaints)
      : tree_(tree), braces_match_(braces_match), complaints_(complaints) {}

  /// A complaint at the place of a field; at that of the block around it when the field is not given.
  void complain(const std::string& path, const std::string& sentence);

  /// A complaint about a field that is not there. None when it was given but could not be read, or when the text of
  /// its block could not be read to the end.
  void complain_missing(const std::string& path, const std::string& sentence);

  /// The same about a choice of which none is given.
  void complain_missing_choice(const std::string& block_path, const std::vector<std::string>& members,
                               const std::string& sentence);

  /// Whether every field stands in the block that was meant, so that rules between fields make sense.
  bool is_readable() const { return braces_match_; }

 private:
  const FieldTree& tree_;
  bool braces_match_;
  ComplaintList& complaints_;
};

}  // namespace couplet::scene
