#pragma once
// A deformable body behind the contract of a participant.

#include "proto/participant/participant.hpp"
#include "proto/participant/server_program.hpp"
#include "solid-server/output/orifice.hpp"
#include "solid-server/service/offered_surface.hpp"
#include "solid-server/service/result_output.hpp"
#include "solid-server/service/solid_checkpoint.hpp"
#include "solid-server/solid_model.hpp"

namespace couplet::solid {

/// Needs force (when the scene has a flow), offers displacement and velocity of the wetted nodes; alone,
/// of the markers and probed nodes. accept_step reports
/// solid.kinetic_energy, solid.strain_energy, solid.contact_energy [J], solid.contact_force [N] of the accepted state
/// solid.substeps of its step, solid.softened_elements when a law may lose stiffness in compression, the force
/// solid.reaction.NAME.x, .y, .z of each support [N] and the open area of each orifice [m^2]; when the scene asks for
/// the energy balance and the method is explicit, solid.external_work, solid.damping_work and solid.energy_imbalance
/// [J].
class SolidParticipant : public participant::Participant {
 public:
  explicit SolidParticipant(participant::ServerOptions options) : options_(options) {}

  participant::Opened open(const participant::OpenRequest& request) override;
  void watch_steps(std::function<bool(double time)> goes_on) override;
  participant::StepSolved solve_step(const participant::StepInterval& interval,
                                     const surface::FieldSet& fields) override;
  std::vector<participant::NamedNumber> accept_step(std::int64_t step) override;
  std::uint64_t write_checkpoint(const std::string& path) override;
  std::vector<participant::NamedNumber> close(const std::string& reason) override;

 private:
  bool is_explicit() const;
  void warn_of_contact_at_rest() const;
  void warn_of_cut(double duration);
  participant::NamedNumber softened_elements();
  void add_implicit_numbers(std::vector<participant::NamedNumber>& numbers) const;
  surface::FieldSet fields_at_surface(const Motion& motion) const;
  surface::NodeArray received_force(const surface::FieldSet& fields) const;

  participant::ServerOptions options_;
  std::function<bool(double time)> goes_on_;
  std::unique_ptr<SolidModel> model_;
  SolidIdentity identity_;  // of the model
  std::unique_ptr<ResultOutput> results_;
  OfferedSurface offered_;
  std::vector<Orifice> orifices_;
  bool needs_force_ = false, has_warned_of_softening_ = false, has_warned_of_cut_ = false;
  double seconds_ = 0;  // of computation
};

}  // namespace couplet::solid
