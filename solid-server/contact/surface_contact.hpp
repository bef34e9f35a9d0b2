#pragma once
// Contact of deformable surfaces: between bodies, and of a body with itself.

#include <string>

#include "solid-server/contact/contact_search.hpp"
#include "solid-server/contact/rolling_ball.hpp"

namespace couplet::solid {

/// Two named surfaces that keep apart: points of each against faces of the other, each with half the stiffness.
struct ContactPair {
  std::string first, second;  // second empty: the first with itself
  double stiffness = 0;       // k: pressure per depth inside the contact distance [Pa/m]
  double distance = 0;        // d0: surfaces closer than this push each other away [m]
  double largest_depth = 0;  // a point deeper behind a face than this has nothing to do with it: below the thickness of
                             // a thin sheet [m]
  bool cancels_interface_load = true;

  const std::string& other() const { return second.empty() ? first : second; }
};

/// Share of the interface load that is cancelled: it grows smoothly from 0 at d = d0 to 1 at d = d0 (1 - this).
constexpr double cancelling_range = 0.1;

/// A penalty between the points q of one surface (Gauss points of its faces, areas A_q at rest) and the closest point p
/// of the faces of the other [dissertation, eq. 3.3, with k per area; Fischer, Wriggers 2005 for points of quadrature]:
///   d = (x - p).n,  g = max(0, d0 - d),  Pi = sum over q of k/2 A_q g^2,
///   f_a = k A_q g N_a(q) n on the point's own face,  f_b = - k A_q g N_b(p) n on the other.
/// It is a potential of relative positions: momentum, angular momentum and energy are conserved. Points of quadrature
/// rather than nodes, because forces at nodes in proportion to positive areas cannot balance a uniform stress in
/// elements with midside nodes.
///
/// Beyond the border of the second region the distance is |x - p|, never negative: the border is rounded with radius
/// d0. The distance is continuous while a point slides from face to face and past the border, as long as it is in front
/// of the surface (d > 0); a point that has come behind the surface (d < 0; only if k is too small or d0 is 0) is let
/// go when it slides past the border or is deeper than `largest_depth`. A point that is closer than d0 at rest takes
/// its distance at rest for d0, so that the bodies at rest feel nothing. In self-contact, faces of the same patch
/// (faces that hang together) closer to a point than 2 d0 at rest, and those that share a node with its face, are its
/// neighbours and do not count.
///
/// Faces that are not flush leave the direction of the force continuous: ridges because the distance to an edge rounds
/// them, valleys because a ball rolls over them (rounded_distance), of radius d0 or a tenth of the size of the smallest
/// face, whichever is larger. In a valley f_b is shared between the faces that the ball touches.
///
/// There is no history: everything is a function of the displacements now, whatever came before and whenever the last
/// search was.
///
/// A team evaluates it in three phases with a barrier after each: search (one member), find_gaps, write (all members).
class SurfaceContact {
 public:
  /// Throws SceneError for unknown surfaces and values out of range.
  SurfaceContact(const SolidMesh& mesh, std::vector<ContactPair> pairs);

  bool is_empty() const { return pairs_.empty(); }
  /// The nodes of the mesh that are in a region, rising: contact node n is node()[n].
  const std::vector<Index>& node() const { return node_; }
  Index n_nodes() const { return static_cast<Index>(node_.size()); }

  /// Takes over the displacements, a NodeVectors array [m]; searches when due.
  void search(const double* displacement);
  /// The share of one member: closest points, gaps.
  void find_gaps(int member, int n_members);
  /// The share of one member of the contact nodes, share_of(n_nodes(), member, n_members): forces [N] into `force`,
  /// (n_nodes, 4), and the interface load factors. `force` must be the same array every time and zero at first: where
  /// nothing touches and nothing touched, nothing is written. Same bits for any number of members.
  void write(int member, int n_members, double* force);

  /// 1: no contact; 0: the interface load on this contact node is cancelled. It is the mean of the points around the
  /// node, weighted by |N_a| A_q.
  double interface_load_factor(Index contact_node) const { return factor_[static_cast<std::size_t>(contact_node)]; }

  struct Total {
    double energy = 0;  // Pi [J]
    double force = 0;   // sum of k A_q g: what the surfaces press on each other [N]
    long n_touching = 0;
    double smallest_distance = 0;  // d of the points that touch [m]; d0 when none does
  };
  Total total(const double* displacement);
  /// All forces, by one thread: added to `force`, a NodeVectors array of the mesh [N]. Returns the energy [J].
  double add(const double* displacement, double* force);

  /// Whether a point that find_gaps looked at last touches.
  bool is_touching() const;
  /// Whether a point comes deeper into contact, on the straight way between two displacements [m], by more than an
  /// eighth of the depth over which its pair pushes, d0 + largest_depth, or is let go at its end. A step in which none
  /// does has felt all that it met: no point has come from the front of a sheet to its back.
  bool deepens_too_fast(const double* from, const double* to);

  /// One touching point; Newton's method should search along its line, since stiffness jumps where a point comes into
  /// contact, or from face to face. Its part of the stiffness is `stiffness` c c^T [N/m]. Left out are the change of
  /// the direction and the sliding of p, of size k A g / (size of a face), which are not positive. What is here is
  /// positive semidefinite.
  struct StiffnessTerm {
    struct Weight {
      Index node;         // of the mesh
      Eigen::Vector3d c;  // N_a n on the point's own face, - lambda_f N_b n_f on others
    };
    std::vector<Weight> weight;
    double stiffness;
  };
  std::vector<StiffnessTerm> stiffness(const double* displacement);

  /// For each node of a mesh of n_nodes a number b_a [N/m] such that u.K u <= sum of b_a |u_a|^2 for the stiffness K of
  /// contact, if the whole surfaces touched: b_a / m_a bounds what contact adds to omega_max^2.
  Eigen::VectorXd stiffness_bound(Index n_nodes_of_mesh) const;

  long n_searches() const;
  std::size_t memory_bytes() const;

 private:
  /// The closest point p of a face, as far as it shares the force.
  struct Foot {
    Index face = -1;
    std::array<double, max_face_nodes> shape{};  // N_b(p)
    NodeQuad push{};                             // lambda n_f
  };
  struct Touch {
    Foot foot;
    std::vector<Foot> further_feet;  // in a valley
    NodeQuad direction{};            // d(distance)/dx: the sum of the pushes
    double distance = 0;             // d
    double gap = 0;                  // g: nothing touches where it is 0
  };
  /// Points of one region against faces of another.
  struct Side {
    std::size_t points, faces;  // regions
    double stiffness;           // [Pa/m]
    double distance, largest_depth;
    double ball_radius;  // that rounds the valleys of the faces [m]
    bool cancels_interface_load;
    ContactSearch search;
    std::vector<double> threshold;  // d0 of each point [m]
    std::vector<Touch> touch;       // of each active point
  };

  void add_side(std::size_t points, std::size_t faces, const ContactPair& pair);
  std::size_t region_of(const SolidMesh& mesh, const std::string& surface, const std::string& where);
  /// The faces around a point in a valley, and the ball between them; kept from point to point for its storage alone.
  struct Valley {
    std::vector<Index> number;
    std::vector<CurvedFace> face;
    RoundedDistance rounded;
  };
  void find_touch(const Side& side, const NodeQuad& x, std::span<const Index> faces, Valley& valley,
                  Touch& touch) const;
  void round_valley(const Side& side, const NodeQuad& x, std::span<const Index> faces, Valley& valley,
                    Touch& touch) const;
  void find_boxes(std::size_t region);
  void find_all(const double* displacement);
  ContactPositions positions_at(const double* displacement) const;
  void search_here();  // at x_
  bool has_blown_up() const;
  void add_valley(const Side& side, const ContactPoint& point, const Touch& touch,
                  std::vector<StiffnessTerm>& terms) const;
  template <class Visit>
  void for_each_touch(const Visit& visit) const;
  template <class Visit>
  void scatter(const Side& side, const ContactPoint& point, const Touch& touch, const Visit& visit) const;

  std::vector<ContactPair> pairs_;
  std::vector<Index> node_, contact_node_;  // contact node to node, and back (-1: in no region)
  std::vector<std::string> region_name_;
  std::vector<ContactRegion> region_;
  ContactPositions rest_, x_;
  std::vector<std::vector<Box>> box_;  // of each face of each region now, where a point is near
  std::vector<Side> sides_;
  std::vector<double> factor_, cancelled_area_, area_;  // of each contact node; areas are those of points around it
  bool is_active_ = false;                              // a point has a face near it
  std::vector<char> holds_force_;                       // by first node of the member's share
};

}  // namespace couplet::solid
