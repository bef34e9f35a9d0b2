#pragma once
// Where sharp edges of bodies pass through the faces of cells.

#include <array>
#include <span>
#include <vector>

#include "flow-server/grid/box.hpp"
#include "flow-server/immersed/body_surface.hpp"
#include "flow-server/immersed/surface_point.hpp"

namespace couplet::flow {

/// A point of a face in which the trace of a surface turns.
struct FaceBend {
  Eigen::Vector2d place;  // in the face, from 0 to 1 along d + 1 and d + 2
  SurfacePoint point;
};

/// Between two crossings of a face's rim the trace of a smooth surface is a chord. Where an edge of a body passes
/// through the face it is not: chords alone cut the corner off, the more the nearer a wall stands to a face that is
/// parallel to it, and the pressure on that wall jumps as it passes the face.
class FaceBends {
 public:
  explicit FaceBends(bool is_flat) : is_flat_(is_flat) {}

  /// All surfaces, at their present place and at all `shifts` of it, in the faces of some cells; `corners`: along each
  /// axis, from cells.begin to cells.end included [m].
  void update(std::span<const BodySurface> surfaces, std::span<const Eigen::Vector3d> shifts, const Box& cells,
              const std::array<std::vector<double>, 3>& corners);

  /// Of the face normal to d whose corner with the smallest coordinates is given; in two dimensions those along z are
  /// one.
  std::span<const FaceBend> in_face(int d, const Triple& corner) const;

 private:
  struct Face {
    int direction;
    Triple corner;
    auto operator<=>(const Face&) const = default;
  };
  struct Found {
    Face face;
    FaceBend bend;
  };

  void cross_faces(const BodySurface& surface, int surface_index, const SharpEdge& edge, const Eigen::Vector3d& shift,
                   const Box& cells, const std::array<std::vector<double>, 3>& corners);

  bool is_flat_;
  std::vector<Found> found_;
  std::vector<Face> face_;      // with bends, in rising order
  std::vector<FaceBend> bend_;  // of each of them, in the same order
};

}  // namespace couplet::flow
