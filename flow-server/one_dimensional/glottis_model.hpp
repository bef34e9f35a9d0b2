#pragma once
// The one-dimensional glottal flow behind the door of all flow models.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "flow-server/flow_model.hpp"
#include "flow-server/one_dimensional/fold_channel.hpp"
#include "flow-server/one_dimensional/glottal_flow.hpp"
#include "flow-server/one_dimensional/prescribed_channel.hpp"
#include "flow-server/output/station_results.hpp"

namespace couplet::flow {

struct GlottisOptions {
  GlottalLaw law;
  int n_stations = 140;
  std::function<double(double t)> subglottal_pressure;  // [Pa]
  double exit_pressure = 0;                             // [Pa]
  double largest_driving_pressure = 0;  // over the whole run [Pa]; far beyond it a state is not believed
};

/// A fold and its mirror image, by the surface of the fold.
struct FoldOptions {
  surface::SurfaceMesh surface;
  GapRule gap;
  MaterialLines lines;
};

class GlottisModel : public FlowModel {
 public:
  /// At rest at t = 0 with the steady flow of that time.
  GlottisModel(const GlottisOptions& options, FoldOptions fold);
  GlottisModel(const GlottisOptions& options, PrescribedChannel::Shape channel);

  const surface::SurfaceMesh& interface() const override { return interface_; }
  std::vector<std::string> needs() const override;
  double time() const override { return time_; }
  void align_time(double accepted_time) override { time_ = accepted_time; }
  void solve_step(double duration, const surface::FieldSet& motion) override;
  const surface::NodeArray& force() const override { return force_; }
  std::vector<FlowQuantity> accept_step() override;
  void write_checkpoint(const std::filesystem::path& path) const override;
  void resume(const std::filesystem::path& path) override;
  void start_results(const std::filesystem::path& results_folder) override;
  void append_results() override;

  /// The last accepted flow.
  const GlottalSolution& flow() const { return flow_.history().accepted; }

 private:
  void start();
  EndPressures pressures_at(double t) const;
  const SectionProfile& channel_at(double t, const surface::NodeArray& displacement);
  void find_force(const GlottalSolution& solution, const EndPressures& pressures);
  void refuse_unbelievable() const;  // a fold that has been destroyed; a prescribed channel is always believed
  [[noreturn]] void report_divergence(const std::string& what) const;

  GlottisOptions options_;
  StationAxis axis_;
  GlottalFlow flow_;
  surface::SurfaceMesh interface_;
  std::variant<std::monostate, FoldChannel, PrescribedChannel> channel_;
  Eigen::ArrayXd first_position_;  // of the stations at t = 0 [m]
  double first_length_ = 0;        // of the channel at t = 0 [m]
  double first_largest_area_ = 0;  // at t = 0 [m^2]

  double time_ = 0;                    // of the accepted state [s]
  double trial_time_ = 0;              // [s]
  surface::NodeArray force_;           // of the last solve (n_nodes, 3) [N]
  surface::NodeArray accepted_force_;  // (n_nodes, 3) [N]
  SectionProfile trial_profile_;
  SectionProfile accepted_profile_;
  double n_clipped_ = 0;  // accepted steps whose flow rate fits the pressures only nearly
  std::optional<StationResults> results_;
};

}  // namespace couplet::flow
