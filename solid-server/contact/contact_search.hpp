#pragma once
// Which faces of one region may be within reach of which points of another.

#include "solid-server/contact/contact_region.hpp"

namespace couplet::solid {

struct SearchReach {
  double reach = 0;               // distance within which a face must be found [m]
  double skin = 0;                // further distance at which it is listed, so that the list lasts [m]
  double neighbour_distance = 0;  // a face of the same patch that is closer to the point than this at rest is its
                                  // neighbour and never listed [m]
};

/// By how much points may come nearer to faces on the straight way from one set of positions to another, judged by the
/// motion of nodes [m]; 0 when they stay further apart than `reach`. A motion that both have in common does not count.
double largest_approach(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& from,
                        const ContactPositions& to, double reach);

/// A list of (point, face) that is kept until points and faces may have come closer by the skin than they were when it
/// was made (Verlet 1967); while the boxes of the two regions are apart, until they may have met. A motion that both
/// regions have in common does not count. Listed are all pairs within reach, so that what is computed from the closest
/// face does not depend on when the list was made. Faces that share a node with the point's own face are left out.
///
/// Found by a tree of boxes of the faces, halved by position at rest, refitted for each search.
class ContactSearch {
 public:
  ContactSearch(const ContactRegion& faces, const ContactPositions& rest, const SearchReach& reach);

  /// Searches when due. `faces` is the region of the constructor.
  void update(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x);

  /// Points that have faces in the list, rising.
  const std::vector<Index>& active_point() const { return active_point_; }
  /// The faces of active point number n, rising.
  std::span<const Index> faces_near(std::size_t n) const {
    return {&face_[first_face_[n]], first_face_[n + 1] - first_face_[n]};
  }
  const SearchReach& reach() const { return reach_; }
  long n_searches() const { return n_searches_; }

 private:
  struct Branch {
    Box box;
    Index first = 0, last = 0;  // faces in order_
    Index right = 0;            // the left half follows its parent; 0: a leaf
  };

  void grow(const ContactRegion& faces, const ContactPositions& rest, Index first, Index last);
  void refit(const ContactRegion& faces, const ContactPositions& x);
  void search(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x);
  bool is_due(const ContactRegion& points, const ContactRegion& faces, const ContactPositions& x) const;
  bool are_neighbours(const ContactRegion& points, const ContactPoint& point, const ContactRegion& faces,
                      Index face) const;

  SearchReach reach_;
  ContactPositions rest_, searched_;  // at the last search
  std::vector<Branch> tree_;
  std::vector<Index> order_;
  std::vector<Box> box_;
  double slack_ = -1;  // by how much the regions may come closer before the next search [m]
  long n_searches_ = 0;
  std::vector<Index> active_point_, face_;
  std::vector<std::size_t> first_face_{0};
};

}  // namespace couplet::solid
