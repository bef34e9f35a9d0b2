#pragma once
// The velocities beside walls: which are given by the wall, how, and what is seen through it.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "flow-server/immersed/line_of_sight.hpp"
#include "flow-server/immersed/nearest_wall.hpp"
#include "flow-server/momentum/flow_block.hpp"

namespace couplet::flow {

/// A point in the fluid at which a velocity component is interpolated, trilinearly between the eight faces around it.
/// Faces that lie on the other side of a wall have no weight.
struct WallImage {
  double ratio = 0;  // what its difference to the wall's velocity counts
  Triple base{};     // of the eight faces: those beside it in rising order, x fastest
  std::array<double, 8> weight{};

  double seen() const { return std::accumulate(weight.begin(), weight.end(), 0.0); }  // sum of the weights
};

/// A velocity component at a place near a wall, on the line through the wall's nearest point and two image points in
/// the fluid, the second one farther from the wall by two thirds:
///     u = U_wall + sum over images of ratio (u_image - U_wall),  u_image = sum of weight u + (1 - sum of weight)
///     U_wall
/// the parabola through the three; where the farther one is not seen well the straight line through wall and nearer
/// one, and where the fluid is too narrow for an image the velocity of the wall. With straight lines alone the viscous
/// stress at a wall is of first order: by 8 % too large on a circle of 50 cells, Reynolds number 40.
struct WallValue {
  int component = 0;
  Triple face;
  double wall_velocity = 0;  // [m/s]
  /// 0 in a gap too narrow for an image: what is imposed there is (1 - room) of the mean of the faces beside the place,
  /// WallLayer::beside().
  double room = 1;
  int first_beside = 0, n_beside = 0;
  std::array<WallImage, 2> image;
};

/// A face in the fluid so near to a wall that it is not, or not only, left to the equations: hybrid [Luo et al.,
/// Comput. Fluids 56 (2012) 61]. Its velocity is (1 - share) of what they say and `share` of the wall value.
struct ForcedFace {
  WallValue value;
  double share = 0;   // 1 at the wall, 0 from the blend's width on
  double closed = 1;  // share of the surface that is closed: less than 1 at a smooth free edge; a factor in `share`
  int surface = 0;
  bool is_outer = false;
};

/// The mean velocity of a piece of a face differs from that at the face's middle by the slope towards neighbouring
/// faces times the distance of the piece's middle: sum of weight (u_neighbour - u_own). Where the piece sees one of
/// both neighbours only, the other slope is that beside this one, between it and the next face along the other
/// direction.
struct PieceShift {
  int piece = 0;  // index in CutCells::pieces()
  int component = 0;
  Triple face;
  int ghost = -1;  // whose velocity is the own one; -1: that of the face
  int n_neighbours = 0;
  std::array<Triple, 2> neighbour;
  std::array<double, 2> weight{};
};

/// A face beside a wall whose neighbours are partly behind it. Entries: the neighbours of the same component before and
/// after it along x, y, z; then, for each other component in turn, its faces at the start and the end of the cell
/// before the face, and of the cell behind it.
struct CutRow {
  static constexpr int n_entries = 14;
  struct Seen {
    double blocked = 0;  // share of the ghost in what is seen there
    int ghost = -1;      // index in WallLayer::ghosts()
  };
  int component = 0;
  Triple face;
  std::array<Seen, n_entries> seen;
};

struct WallLayerSettings {
  /// Width over which the equations take over, in cells, beside surfaces that do not say it themselves.
  double blend_of_closed = 0.25;
  double blend_of_sheets = 1;
  double image_distance = 1.5;  // of the nearer image, in cells
};

class WallLayer {
 public:
  /// All must outlive this. `margin`: faces that many cells beyond the block are looked at as well.
  WallLayer(const FlowBlock& block, const CutCells& cut, const WallLayerSettings& settings);

  /// `trees`: one of each surface.
  void update(std::span<const BodySurface> surfaces, std::span<const SurfaceTree> trees);

  const std::vector<ForcedFace>& forced() const { return forced_; }  // of this rank
  /// Index of a face among the forced ones of this rank, -1 for the others.
  int find_forced(int component, const Triple& face) const;
  bool is_inside_body(int component, const Triple& face) const;
  const std::vector<WallValue>& ghosts() const { return ghosts_; }
  const std::vector<CutRow>& rows() const { return rows_; }  // of this rank
  /// Faces of this rank inside closed bodies, next to their walls, with the wall's velocity in `wall_velocity`.
  const std::vector<WallValue>& solid() const { return solid_; }

  /// (n_pieces of CutCells) the ghost that stands for the velocity of a piece of a face without the face's middle; -1
  /// for others, and for faces that this rank does not need.
  int ghost_of_piece(int piece) const { return ghost_of_piece_[static_cast<std::size_t>(piece)]; }
  /// Of pieces of faces of this rank's cells.
  const std::vector<PieceShift>& shifts() const { return shifts_; }
  static double value_of(const WallValue& value, const Field<double>& velocity);
  /// Faces of the same component next to a place where there is not enough room for its wall value: those that a forced
  /// face sees, and those that look at a ghost through its wall.
  std::span<const Triple> beside(const WallValue& value) const {
    return std::span(beside_).subspan(static_cast<std::size_t>(value.first_beside),
                                      static_cast<std::size_t>(value.n_beside));
  }
  /// What is imposed: the wall value, or the mean of those beside it, of which there is one at least.
  double imposed(const WallValue& value, const Field<double>& velocity) const;
  double mean_beside(const WallValue& value, const Field<double>& field) const;
  /// u_image - U_wall.
  static double rise_to(const WallImage& image, double wall_velocity, const Field<double>& velocity);

  /// Interpolation of a component at any point on the side of a wall from which `from` is seen.
  const LineOfSight& sight() const { return sight_; }
  /// Faces of cut cells and of the cells beside them, as far as their velocities are known to this rank.
  const std::vector<Triple>& near_faces(int component) const { return near_faces_[component]; }
  bool is_near(int component, const Triple& face) const { return (entry(component, face).marks & near_wall) != 0; }
  /// Faces that are not near but that the first images are interpolated from, or ghosts of near faces beyond borders.
  const std::vector<Triple>& image_faces(int component) const { return image_faces_[component]; }
  /// Whether a near face is one of whole fluid cells: the slope of a pressure there is the one between both.
  bool is_of_whole_cells(int component, const Triple& face) const {
    return (entry(component, face).marks & of_whole_cells) != 0;
  }
  double spacing(const Triple& cell, const Eigen::Vector3d& direction) const;
  bool is_known(int component, const Triple& face) const;
  /// Base and weights of a component at any point, from faces that are seen from `from`, which need not be near.
  WallImage image_at(int component, const Eigen::Vector3d& point, const Triple& from) const;

 private:
  /// Distances of the images from the wall: a cell apart. Farther ones would need more layers of neighbours' cells.
  static constexpr double far_over_near = 5.0 / 3;
  static constexpr std::uint8_t inside_body = 8, near_wall = 16, of_whole_cells = 32, for_images = 64;
  /// Those that keep nothing from sight.
  static constexpr std::uint8_t free_marks = near_wall | of_whole_cells | for_images;
  /// What a face whose links to the next ones along x, y, z are not all free sees there, and what is seen from there.
  struct Links {
    std::array<Sight, 3> ahead, back;
  };
  /// What is known of a face, side by side in memory.
  struct FaceEntry {
    int forced = 0;      // in forced_, counted from 1
    int last_ghost = 0;  // the last ghost made of it, in ghosts_, counted from 1
    int links = 0;       // in links_, counted from 1
    NearbyWalls walls;
    /// Bits: 1, 2, 4: blocked, wholly or partly, towards the next one along x, y, z; those named below.
    std::uint8_t marks = 0;
  };
  FaceEntry& entry(int component, const Triple& face) { return entry_[component](face[0], face[1], face[2]); }
  const FaceEntry& entry(int component, const Triple& face) const {
    return entry_[component](face[0], face[1], face[2]);
  }
  enum class Clearness : std::uint8_t { unknown, clear, not_clear };
  /// Through which side of which surface a ghost is seen, and the one made of the same face before, counted from 1.
  struct GhostSide {
    int surface;
    bool is_outer;
    int before;
  };
  struct Neighbours {
    int n = 0;
    std::array<Triple, 6> face;
  };
  /// The ghost of a face as it is seen from that side of a surface; made when it is asked for the first time.
  int ghost(int component, const Triple& face, int surface, bool is_outer);
  void collect_faces();
  void add_image_faces(const WallValue& value);
  void add_image_face(int component, const Triple& face);
  void add_faces_before_borders();
  void add_pieces();
  void add_shift(const CutFace& face, int piece);
  void find_links(int component, const Triple& face);
  void add_face(int component, const Triple& face);
  void add_row(int component, const Triple& face);
  Sight sight_to(int component, const Triple& face, int e, int step) const;
  double blend_of(const BodySurface& surface) const;
  bool is_beyond_border(int component, const Triple& face) const;
  void set_images(WallValue& value, const Eigen::Vector3d& wall, const Eigen::Vector3d& away, double distance,
                  double near, double room_for_far, const Triple& from) const;
  /// Wider gaps [cells] change nothing of a face within the blend's width, nor of a ghost (blend 0).
  double widest_gap(double blend) const { return far_over_near * (blend + settings_.image_distance) + 2; }
  double gap_before(const ClosestPoint& wall, const Eigen::Vector3d& away, double width, double most,
                    const NearbyWalls& nearby, const Triple& near_cell);
  bool is_clear_before(const CutCell& cell, int surface, bool is_outer);
  Triple cell_of(const Eigen::Vector3d& point, Triple cell) const;
  template <class Wanted>
  Neighbours fluid_neighbours(int component, const Triple& face, const Wanted& wanted) const;
  void set_room(WallValue& value, double room, const Neighbours& beside);
  void weigh_seen_faces(int component, WallImage& image, const Eigen::Vector3d& place, const Triple& from,
                        int detour) const;
  bool is_all_free(int component, const Box& faces) const;
  /// Weights of trilinear interpolation times how well each face is seen.
  template <class Seen>
  void weigh(WallImage& image, const Eigen::Vector3d& place, const Seen& seen) const;
  double openness(const FaceEntry& lower, const FaceEntry& next, int e) const;
  Eigen::Vector3d position(int component, const Triple& face) const;

  const FlowBlock& block_;
  const CutCells& cut_;
  LineOfSight sight_;
  WallLayerSettings settings_;
  NearestWall nearest_;
  std::array<Box, 3> known_;                       // faces of each component that neighbours and borders fill in
  std::array<Box, 3> within_borders_;              // those of them that are not beyond a border or on it
  std::array<std::vector<Triple>, 3> near_faces_;  // of each component, near cut cells
  std::array<std::vector<Triple>, 3> image_faces_;
  std::array<Field<FaceEntry>, 3> entry_;  // of each face of each component
  std::vector<Links> links_;
  std::vector<ForcedFace> forced_;
  std::vector<WallValue> ghosts_, solid_;
  std::vector<CutRow> rows_;
  std::vector<GhostSide> ghost_side_;  // of each ghost
  std::vector<Triple> beside_;
  std::vector<Clearness> clearness_;  // before the inner and the outer side of the wall in each cut cell
  std::vector<int> ghost_of_piece_;
  std::vector<PieceShift> shifts_;
};

}  // namespace couplet::flow
