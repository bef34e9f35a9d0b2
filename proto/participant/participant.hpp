#pragma once
// A physics program as the coupler sees it, whatever lies between them.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "couplet/v1/scene.pb.h"
#include "proto/surface/surface_field.hpp"
#include "proto/surface/surface_mesh.hpp"

namespace couplet::participant {

struct OpenRequest {
  v1::Scene scene;                                   // complete and checked
  std::string scene_folder;                          // relative paths in the scene start here
  std::string run_folder;                            // results go to run_folder/results; empty: write nothing
  std::string resume_from;                           // this participant's checkpoint file; empty: start at t = 0
  std::optional<surface::SurfaceMesh> peer_surface;  // the surface that the other participant offers
};

struct Opened {
  surface::SurfaceMesh surface;     // interface nodes; every array below follows their order
  double time = 0;                  // of the accepted state [s]
  std::vector<std::string> needs;   // names of the fields that solve_step must be given
  std::vector<std::string> offers;  // names of the fields that solve_step returns
  surface::FieldSet fields;         // the offered fields at `time`
};

struct StepInterval {
  std::int64_t step = 0;  // 1, 2, 3, ...
  int iteration = 0;      // 1, 2, 3, ...
  double start = 0;       // [s]
  double duration = 0;    // [s]
};

struct StepSolved {
  surface::FieldSet fields;  // the offered fields at the end of the step
  double seconds = 0;        // of computation
  int inner_iterations = 0;
  double residual = 0;
};

/// A number that a participant reports beside its fields; at the end, and in estimates, also a text.
struct NamedNumber {
  std::string name;
  double value = 0;
  std::string unit;
  std::string text = {};  // in place of the number; empty: none
};

/// The contract. Calls come in the order: open, then for each step one or more solve_step and at most one accept_step
/// (after it write_checkpoint may follow), then close. SI units. Any call may throw a report::Failure, after which only
/// close follows.
class Participant {
 public:
  virtual ~Participant() = default;

  virtual Opened open(const OpenRequest& request) = 0;

  /// Solves [start, start + duration] from the last accepted state, given the needed fields at the end of the step.
  /// Repeating it, with any interval, changes nothing but the trial state: equal arguments in equal order since the
  /// last accepted step give equal bits.
  virtual StepSolved solve_step(const StepInterval& interval, const surface::FieldSet& fields) = 0;

  /// From now on a long solve_step calls this now and then with the time that it has reached [s]; when it answers
  /// false, the step is given up with report::Interrupted. A participant whose steps are short need not.
  virtual void watch_steps(std::function<bool(double time)>) {}

  /// solve_step in two halves, so that two participants can work at the same time. A participant in this process simply
  /// works in the first half; one behind a channel overrides both.
  virtual void start_step(const StepInterval& interval, const surface::FieldSet& fields) {
    started_ = solve_step(interval, fields);
  }
  virtual StepSolved finish_step() { return std::move(started_); }

  /// Makes the last trial state the accepted one. Returns quantities for history.csv: the same names and units every
  /// time.
  virtual std::vector<NamedNumber> accept_step(std::int64_t step) = 0;

  /// accept_step in two halves, likewise.
  virtual void start_accept(std::int64_t step) { accepted_ = accept_step(step); }
  virtual std::vector<NamedNumber> finish_accept() { return std::move(accepted_); }

  /// Writes the accepted state so that open(resume_from = path) continues with equal bits. Returns the bytes written.
  virtual std::uint64_t write_checkpoint(const std::string& path) = 0;

  /// Ends the session; results are complete on disk afterwards. Returns at least seconds [s] and peak_memory_bytes [1];
  /// one that works in several processes also core_seconds [s] of all of them.
  virtual std::vector<NamedNumber> close(const std::string& reason) = 0;

 private:
  StepSolved started_;
  std::vector<NamedNumber> accepted_;
};

}  // namespace couplet::participant
