#include "flow-server/service/flow_participant.hpp"

#include <sys/resource.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "flow-server/service/make_flow_model.hpp"
#include "flow-server/service/rank_relay.hpp"
#include "proto/report/failure.hpp"
#include "proto/store/run_folder.hpp"

namespace couplet::flow {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

ResultSchedule make_schedule(const v1::Output& output, const std::string& run_folder) {
  if (run_folder.empty() || !output.has_results_interval()) return {};
  return {output.results_start(), output.results_interval()};
}

int n_ranks_of(MPI_Comm ranks) {
  int n_ranks = 1;
  if (ranks != MPI_COMM_NULL) MPI_Comm_size(ranks, &n_ranks);
  return n_ranks;
}

/// What the processes of all ranks have used so far.
std::vector<participant::NamedNumber> used_by_all(MPI_Comm ranks) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  std::array used{1024.0 * static_cast<double>(usage.ru_maxrss), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
  if (n_ranks_of(ranks) > 1) MPI_Allreduce(MPI_IN_PLACE, used.data(), 2, MPI_DOUBLE, MPI_SUM, ranks);
  return {{"peak_memory_bytes", used[0], "1"}, {"core_seconds", used[1], "s"}};
}

}  // namespace

participant::Opened FlowParticipant::open(const participant::OpenRequest& request) {
  const auto started = Clock::now();
  model_ = make_flow_model(request.scene, request.scene_folder, request.peer_surface, ranks_);
  if (!request.resume_from.empty()) model_->resume(request.resume_from);
  schedule_ = make_schedule(request.scene.output(), request.run_folder);
  if (schedule_.is_on()) {
    model_->start_results(store::RunFolder{request.run_folder}.results());
    const bool is_new = request.resume_from.empty();
    if (is_new && schedule_.is_due(-std::numeric_limits<double>::infinity(), model_->time())) model_->append_results();
  }
  participant::Opened opened;
  opened.surface = model_->interface();
  opened.time = model_->time();
  opened.needs = model_->needs();
  if (opened.surface.n_nodes() > 0) {
    opened.offers = {"force"};
    opened.fields = {{"force", "N", model_->force()}};
  }
  seconds_ += seconds_since(started);
  return opened;
}

participant::StepSolved FlowParticipant::solve_step(const participant::StepInterval& interval,
                                                    const surface::FieldSet& fields) {
  const auto started = Clock::now();
  // More than the round-off of one step apart means that one of the two programs lost a step.
  if (std::abs(interval.start - model_->time()) > 1e-6 * interval.duration + 1e-15 * std::abs(interval.start)) {
    throw report::PeerError("flow-server",
                            "asked for a step from t = " + std::to_string(interval.start) +
                                " s, but the accepted state is at t = " + std::to_string(model_->time()) + " s",
                            "start the run again from its last checkpoint");
  }
  model_->align_time(interval.start);
  for (const std::string& name : model_->needs()) {
    const surface::NodeArray& values = surface::find_field(fields, name).values;
    if (values.rows() != model_->interface().n_nodes() || values.cols() != 3) {
      throw report::PeerError("flow-server",
                              "the field '" + name + "' is " + std::to_string(values.rows()) + " x " +
                                  std::to_string(values.cols()) + ", not " +
                                  std::to_string(model_->interface().n_nodes()) + " x 3",
                              "check the mapping between the two surfaces");
    }
  }
  model_->solve_step(interval.duration, fields);
  participant::StepSolved solved;
  if (model_->interface().n_nodes() > 0) solved.fields = {{"force", "N", model_->force()}};
  solved.seconds = seconds_since(started);
  seconds_ += solved.seconds;
  return solved;
}

std::vector<participant::NamedNumber> FlowParticipant::accept_step(std::int64_t) {
  const auto started = Clock::now();
  const double before = model_->time();
  std::vector<participant::NamedNumber> numbers;
  for (const FlowQuantity& quantity : model_->accept_step())
    numbers.push_back({quantity.name, quantity.value, quantity.unit});
  if (schedule_.is_due(before, model_->time())) model_->append_results();
  seconds_ += seconds_since(started);
  return numbers;
}

std::uint64_t FlowParticipant::write_checkpoint(const std::string& path) {
  const auto started = Clock::now();
  model_->write_checkpoint(path);
  seconds_ += seconds_since(started);
  return static_cast<std::uint64_t>(std::filesystem::file_size(path));
}

std::vector<participant::NamedNumber> FlowParticipant::close(const std::string&) {
  std::vector<participant::NamedNumber> numbers{{"seconds", seconds_, "s"}};
  for (const participant::NamedNumber& number : used_by_all(ranks_)) numbers.push_back(number);
  // Where a rank could not make its model the others have nobody to count with.
  if (holds_on_all_ranks(model_ != nullptr)) {
    for (const FlowQuantity& cost : model_->costs()) numbers.push_back({cost.name, cost.value, cost.unit});
  }
  model_.reset();
  return numbers;
}

bool FlowParticipant::holds_on_all_ranks(bool holds) const {
  int everywhere = holds ? 1 : 0;
  if (n_ranks_of(ranks_) > 1) MPI_Allreduce(MPI_IN_PLACE, &everywhere, 1, MPI_INT, MPI_MIN, ranks_);
  return everywhere == 1;
}

std::unique_ptr<participant::Participant> make_flow_participant(MPI_Comm ranks) {
  auto own = std::make_unique<FlowParticipant>(ranks);
  if (n_ranks_of(ranks) == 1) return own;
  return std::make_unique<RelayedParticipant>(std::move(own), ranks);
}

void follow_flow_participant(MPI_Comm ranks) {
  FlowParticipant own(ranks);
  follow_calls(own, ranks);
}

}  // namespace couplet::flow
