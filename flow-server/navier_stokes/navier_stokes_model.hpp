#pragma once
// The incompressible flow in two and three dimensions behind the door of all flow models.

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "flow-server/flow_model.hpp"
#include "flow-server/immersed/body_surfaces.hpp"
#include "flow-server/navier_stokes/fractional_step.hpp"
#include "flow-server/navier_stokes/navier_stokes_checkpoint.hpp"
#include "flow-server/output/field_writer.hpp"
#include "flow-server/output/flow_measurement.hpp"
#include "flow-server/output/momentum_balance.hpp"

namespace couplet::flow {

/// What is looked at in a flow, beside what is always reported.
struct FlowObservation {
  /// The moment of the force on a body about a point.
  struct Moment {
    std::size_t body = 0;
    Point about;              // with the body at rest [m]
    bool is_carried = false;  // by the prescribed motion of the body
  };
  std::vector<FieldRegion> regions;  // stored at the times of the run's results
  std::vector<PlaneCut> planes;
  std::vector<PointProbe> probes;
  std::vector<BalanceBox> balances;  // of momentum, around bodies
  std::vector<Moment> moments;
  bool has_integrals = false;
  std::optional<ExactFlow> exact;  // that the flow is compared with
};

struct NavierStokesOptions {
  NavierStokesSetup setup;
  std::optional<Triple> shape = {};         // blocks along each axis; not set: chosen
  std::filesystem::path initial_file = {};  // checkpoint whose flow is that at t = 0; empty: as the setup says
  FlowObservation observed = {};
  std::vector<BodySetup> bodies = {};  // setup.bodies is made of them
  std::optional<int> coupled = {};     // the one of them that is moved from outside
};

/// Blocks of a grid for the ranks there are. Throws SceneError when they do not fit.
BlockDecomposition decompose(const StretchedGrid& grid, const std::optional<Triple>& shape, MPI_Comm ranks);

/// Made and called on all ranks of a communicator with equal arguments.
class NavierStokesModel : public FlowModel {
 public:
  /// The communicator stays the caller's, carries nothing else and outlives this.
  NavierStokesModel(NavierStokesOptions options, MPI_Comm ranks);

  const surface::SurfaceMesh& interface() const override { return interface_; }
  std::vector<std::string> needs() const override;
  double time() const override { return accepted_.time; }
  void align_time(double accepted_time) override { accepted_.time = accepted_time; }
  void solve_step(double duration, const surface::FieldSet& motion) override;
  const surface::NodeArray& force() const override { return force_; }
  std::vector<FlowQuantity> accept_step() override;
  void write_checkpoint(const std::filesystem::path& path) const override;
  void resume(const std::filesystem::path& path) override;
  void start_results(const std::filesystem::path& results_folder) override;
  void append_results() override;
  std::vector<FlowQuantity> costs() const override;

  const FlowState& state() const { return accepted_; }
  const BlockDecomposition& decomposition() const { return decomposition_; }
  /// Sentences for the log on the surfaces of bodies: what was done to them, where they lie.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  FlowPart part() const;
  std::optional<BodySurfaces> make_surfaces();
  std::vector<std::string> note_placement();
  void measure_loads(const FlowState& state);
  void read_state(const std::filesystem::path& path, bool is_same_run);
  void require_same_bodies(const StoredBodies& stored, const std::filesystem::path& path) const;
  void add_body_quantities(std::vector<FlowQuantity>& quantities) const;
  void add_measurements(std::vector<FlowQuantity>& quantities) const;

  NavierStokesOptions options_;
  std::optional<BodySurfaces> surfaces_;
  BlockDecomposition decomposition_;
  std::vector<std::string> notes_;
  FractionalStep step_;
  FlowState accepted_, trial_;
  AdvanceReport report_;
  std::optional<FieldWriter> results_;
  std::vector<StoredSurface> stored_surfaces_;
  std::vector<SurfaceLoad> loads_;  // of each body, in the state that was measured last
  surface::SurfaceMesh interface_;  // without nodes where no body is moved from outside
  surface::NodeArray force_;
  std::int64_t n_substeps_ = 0;  // of all solves
  double solve_seconds_ = 0, measure_seconds_ = 0, results_seconds_ = 0;
  mutable double checkpoint_seconds_ = 0;
};

}  // namespace couplet::flow
