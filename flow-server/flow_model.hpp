#pragma once
// The door to every flow model, one-dimensional or three-dimensional.

#include <filesystem>
#include <string>
#include <vector>

#include "proto/surface/surface_field.hpp"

namespace couplet::flow {

/// A number that a model reports beside its force, for example the flow rate.
struct FlowQuantity {
  std::string name;
  double value = 0;
  std::string unit;
};

/// What a flow model must answer. SI units; arrays follow the node order of interface().
///
/// A model holds two states, the last accepted one and a trial one. It is made in its state at rest at t = 0; resume()
/// may follow. Then come, for each step, any number of solve_step() and at most one accept_step(). A model that works
/// on several MPI ranks is called on all of them with equal arguments and returns equal values.
class FlowModel {
 public:
  virtual ~FlowModel() = default;

  /// The surface that takes motion and gives force. Without nodes: no solid takes part.
  virtual const surface::SurfaceMesh& interface() const = 0;

  /// Names of the fields that solve_step() must be given: displacement [m], velocity [m/s], both (n_nodes, 3).
  virtual std::vector<std::string> needs() const = 0;

  /// Time of the accepted state [s].
  virtual double time() const = 0;
  /// The same time as the coupler has it, which adds up steps with another round-off.
  virtual void align_time(double accepted_time) = 0;

  /// Solves from the accepted state over `duration` [s] to the moved surface at its end. Changes the trial state only;
  /// equal arguments in equal order since then give equal bits. Throws NumericsError when there is no solution.
  virtual void solve_step(double duration, const surface::FieldSet& motion) = 0;

  /// Force of the fluid on the interface nodes (n_nodes, 3) [N], of the last solve; before the first one of the
  /// accepted state.
  virtual const surface::NodeArray& force() const = 0;

  /// Makes the trial state the accepted one; returns the same names every time. Throws NumericsError when that state is
  /// beyond what the model can describe.
  virtual std::vector<FlowQuantity> accept_step() = 0;

  /// The accepted state, complete: resume() from it continues with equal bits. Both throw FileError.
  virtual void write_checkpoint(const std::filesystem::path& path) const = 0;
  virtual void resume(const std::filesystem::path& path) = 0;

  /// Fields of the accepted state as files for ParaView. start_results() comes once, before the first append_results();
  /// after resume() it continues the files that are there.
  virtual void start_results(const std::filesystem::path& results_folder) = 0;
  virtual void append_results() = 0;

  /// What the work so far has cost, for the summary of the run: cells, nanoseconds a cell and step, bytes a cell.
  virtual std::vector<FlowQuantity> costs() const { return {}; }
};

}  // namespace couplet::flow
