#pragma once
// The conditions on the borders of the grid, face by face, and the values they give.

#include <cstdint>
#include <functional>
#include <vector>

#include "flow-server/boundary/face_condition.hpp"
#include "flow-server/boundary/wall_ghost.hpp"
#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"
#include "flow-server/grid/stretched_grid.hpp"
#include "flow-server/grid/traffic.hpp"

namespace couplet::flow {

enum class BorderKind : std::uint8_t { prescribed, opening, outflow, slip };

class FlowBorder {
 public:
  using IsFluid = std::function<bool(const Point& centre)>;

  /// Collective. `is_fluid` may be empty. Throws SceneError where a condition cannot hold.
  FlowBorder(const StretchedGrid& grid, const BlockDecomposition& decomposition, const BorderConditions& conditions,
             const IsFluid& is_fluid, bool balances_inflow);

  /// Of the border face beside the cell with these local indices; only where the block ends at that border.
  BorderKind kind(int direction, int side, const Triple& cell) const;
  bool has_openings() const { return has_openings_; }
  /// Is every face of that border an opening, is any (on all ranks)?
  bool is_all_open(int direction, int side) const { return all_open_[direction][side]; }
  bool is_partly_open(int direction, int side) const { return partly_open_[direction][side]; }

  /// Collective, once a step: notes what flows through openings and outflows in the beginning.
  void begin_step(const VectorField& velocity);
  /// Collective. The velocities on the border at `time`, `elapsed` after `begin`, the velocity in the beginning of the
  /// step. Throws when a value is not a number, or when what flows in has no way out (unless it is balanced).
  void set_time(double time, double elapsed, const VectorField& begin);
  /// The pressures on the openings at `time`.
  void set_pressure_time(double time);
  double net_inflow() const { return net_inflow_; }  // prescribed, before it was balanced [m^3/s]

  /// Writes the known normal velocities of border faces; with or without those of outflows.
  void impose(VectorField& velocity, bool with_outflow = true) const;
  /// Fills the ghost layer beyond the borders. Reads one ghost layer beside neighbours.
  void fill_velocity_ghosts(VectorField& velocity) const { fill_ghosts(velocity, 1, velocity); }
  /// The same of a change of `velocity` that leaves what borders give as it is.
  void fill_change_ghosts(const VectorField& velocity, VectorField& change) const { fill_ghosts(velocity, 0, change); }
  void fill_pressure_ghosts(Field<double>& pressure) const;
  /// Beyond openings phi = 0, at the border.
  void fill_increment_ghosts(Field<double>& phi) const;
  /// velocity -= factor * gradient of (pressure on the opening now - what the ghosts of `pressure` hold).
  void add_pressure_change(double factor, const Field<double>& pressure, VectorField& velocity) const;
  /// The rate of change of the known normal velocities between two times, for the initial pressure [m/s^2].
  void impose_rate(double time, double elapsed, const VectorField& velocity, VectorField& rate);

  /// Keeps the present velocities of the border, so that changes from them can be told.
  void remember();
  /// For each edge with a velocity `component` tangential to a border of `direction`: visit(cell next to the border,
  /// side, weights that make the ghost from border, first and second value, change of the border's value since
  /// remember()).
  template <class Visit>
  void visit_tangential(int component, int direction, const VectorField& velocity, const Visit& visit) const {
    for (const Border& border : borders_) {
      if (border.direction != direction) continue;
      const Layer& layer = border.layer[component];
      for_each(border, layer, [&](Triple cell, std::size_t m) {
        const GhostWeights ghost = ghost_weights(border, component, cell, m, velocity);
        cell[direction] = border.inside;
        const bool is_prescribed = layer.kind[m] == BorderKind::prescribed;
        visit(cell, border.side, ghost, is_prescribed ? layer.value[m] - layer.remembered[m] : 0.0);
      });
    }
  }

  std::int64_t reductions() const { return reductions_; }

 private:
  struct Layer {  // of one component on one border; indices in the two other directions
    Triple begin{}, end{};
    std::vector<BorderKind> kind;
    std::vector<std::uint8_t> is_beside_fluid;  // empty: all are; the others are neither read nor written
    std::vector<std::uint16_t> patch;
    std::vector<double> value;       // prescribed or outflow velocity [m/s]
    std::vector<double> remembered;  // an earlier value [m/s]
    std::vector<double> pressure;    // of openings, normal component only [Pa]
    std::size_t at(const Triple& cell, int direction) const {
      const int a = (direction + 1) % 3, b = (direction + 2) % 3;
      return static_cast<std::size_t>(cell[a] - begin[a]) +
             static_cast<std::size_t>(cell[b] - begin[b]) * static_cast<std::size_t>(end[a] - begin[a]);
    }
  };
  struct Border {
    int direction, side;
    int outside, face, inside, next;  // ghost, border face, first and second cell along the direction
    double outward;                   // -1 or 1
    double width;                     // of the first cell [m]
    GhostWeights ghost;
    std::array<Layer, 3> layer;
  };
  struct Patch {
    FacePatch patch;
    std::string place;
    bool varies_in_time = false;
  };

  template <class Visit>
  static void for_each(const Border& border, const Layer& layer, const Visit& visit) {
    const int d = border.direction, a = (d + 1) % 3, b = (d + 2) % 3;
    std::size_t n = 0;
    Triple cell{};
    for (cell[b] = layer.begin[b]; cell[b] < layer.end[b]; ++cell[b])
      for (cell[a] = layer.begin[a]; cell[a] < layer.end[a]; ++cell[a], ++n)
        if (layer.is_beside_fluid.empty() || layer.is_beside_fluid[n] != 0) visit(cell, n);
  }
  /// `given`: what the values of the border count.
  void fill_ghosts(const VectorField& velocity, double given, VectorField& field) const;
  GhostWeights ghost_weights(const Border& border, int component, Triple cell, std::size_t m,
                             const VectorField& velocity) const;
  Point place_of(const Border& border, int component, const Triple& cell) const;
  void leave_out_solid(const IsFluid& is_fluid);
  double face_area(const Border& border, const Triple& cell) const;
  void sum_over_ranks(std::vector<double>& sums);
  void evaluate_prescribed(double time);

  const StretchedGrid& grid_;
  const BlockDecomposition& decomposition_;
  int n_dimensions_;
  Triple sizes_{};
  bool balances_inflow_;
  std::vector<Patch> patches_;  // the first is the wall at rest
  std::vector<Border> borders_;
  std::array<std::array<bool, 2>, 3> all_open_{}, partly_open_{};
  bool has_openings_ = false, has_outflow_ = false, prescribed_varies_ = false, is_evaluated_ = false;
  double evaluated_time_ = 0;
  double pressure_time_ = 0;
  bool pressure_is_evaluated_ = false, opening_varies_ = false;
  std::vector<double> outside_share_;  // of each patch: momentum that comes along with inflow through an opening
  double outflow_speed_ = 0;           // mean over all outflows, not negative [m/s]
  double outflow_area_ = 0;            // [m^2]
  double net_inflow_ = 0;
  std::int64_t reductions_ = 0;
};

}  // namespace couplet::flow
