// What one coupling iteration costs beside the solvers: the exchange with two processes, and the update of IQN-ILS.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "coupler/acceleration/iqn_ils.hpp"
#include "coupler/scheme/interface_pair.hpp"
#include "proto/participant/remote_participant.hpp"
#include "proto/participant/serve_participant.hpp"
#include "proto/report/failure.hpp"
#include "proto/report/version.hpp"
#include "proto/wire/memory_channel.hpp"
#include "proto/wire/mpi_job.hpp"
#include "proto/wire/zeromq_channel.hpp"

namespace {

using namespace couplet;
using Clock = std::chrono::steady_clock;
using surface::NodeArray;

constexpr const char* about =
    "cost of one coupling iteration: exchange with two trivial solvers, update of IQN-ILS with 50 columns";

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// Answers at once, with fields that it made when it was opened.
class TrivialSolver : public participant::Participant {
 public:
  TrivialSolver(Eigen::Index n_nodes, bool is_flow) : n_nodes_(n_nodes), is_flow_(is_flow) {}
  participant::Opened open(const participant::OpenRequest&) override {
    participant::Opened opened;
    opened.surface.node_position = NodeArray::Zero(n_nodes_, 3);
    opened.surface.node_position.col(0) = Eigen::VectorXd::LinSpaced(n_nodes_, 0, 1);
    const NodeArray values = NodeArray::Ones(n_nodes_, 3);
    if (is_flow_) {
      fields_ = {{"force", "N", values}};
      opened.needs = {"displacement", "velocity"}, opened.offers = {"force"};
    } else {
      fields_ = {{"displacement", "m", values}, {"velocity", "m/s", values}};
      opened.needs = {"force"}, opened.offers = {"displacement", "velocity"};
    }
    opened.fields = fields_;
    return opened;
  }
  participant::StepSolved solve_step(const participant::StepInterval&, const surface::FieldSet&) override {
    return {fields_, 0, 0, 0};
  }
  std::vector<participant::NamedNumber> accept_step(std::int64_t) override { return {}; }
  std::uint64_t write_checkpoint(const std::string&) override { return 0; }
  std::vector<participant::NamedNumber> close(const std::string&) override { return {}; }

 private:
  Eigen::Index n_nodes_;
  bool is_flow_;
  surface::FieldSet fields_;
};

void serve(wire::Channel& channel, Eigen::Index n_nodes, bool is_flow) {
  TrivialSolver solver(n_nodes, is_flow);
  participant::ServeOptions options;
  options.program = is_flow ? "trivial flow" : "trivial solid";
  participant::serve_participant(channel, solver, options);
}

/// Median time of one serial-implicit iteration: displacement and velocity to the flow, force back, force to the solid,
/// displacement and velocity back; mapping and stacking included.
double exchange_ms(participant::Participant& flow, participant::Participant& solid, Eigen::Index n_nodes) {
  const participant::Opened solid_opened = solid.open({}), flow_opened = flow.open({});
  coupling::InterfacePair pair(flow, solid, flow_opened, solid_opened, coupling::MappingKind::automatic);
  const int n_iterations = static_cast<int>(std::clamp<Eigen::Index>(2000000 / n_nodes, 50, 500));
  std::vector<double> times;
  Eigen::VectorXd motion = pair.start().motion;
  for (int k = 0; k < n_iterations; ++k) {
    const auto start = Clock::now();
    const participant::StepInterval interval{1, k + 1, 0, 1};
    motion = pair.solve_solid(interval, pair.solve_flow(interval, motion));
    times.push_back(milliseconds_since(start));
  }
  flow.close("done"), solid.close("done");
  return median(times);
}

double exchange_ms(std::unique_ptr<wire::Channel> flow, std::unique_ptr<wire::Channel> solid, Eigen::Index n_nodes) {
  participant::RemoteParticipant remote_flow(std::move(flow), {.name = "flow", .run = "bench"});
  participant::RemoteParticipant remote_solid(std::move(solid), {.name = "solid", .run = "bench"});
  return exchange_ms(remote_flow, remote_solid, n_nodes);
}

/// A child process that serves over ZeroMQ and tells its address through a pipe.
struct ServerProcess {
  pid_t id;
  std::string address;
};

ServerProcess start_server(Eigen::Index n_nodes, bool is_flow, bool is_tcp) {
  const std::string where = is_tcp
                                ? "tcp://127.0.0.1:*"
                                : "ipc://@couplet-bench-" + std::to_string(getpid()) + (is_flow ? "-flow" : "-solid");
  int ends[2];
  if (pipe(ends) != 0) throw report::FileError("pipe", "cannot be made");
  std::fflush(stdout);
  const pid_t id = fork();
  if (id == 0) {
    ::close(ends[0]);
    auto channel = wire::listen_zeromq(where, {});
    const std::string address = channel->describe();
    if (write(ends[1], address.data(), address.size()) < 0) _exit(1);
    ::close(ends[1]);
    serve(*channel, n_nodes, is_flow);
    channel.reset();  // lets the last reply leave
    _exit(0);
  }
  ::close(ends[1]);
  char address[256];
  const ssize_t n_read = read(ends[0], address, sizeof address);
  ::close(ends[0]);
  return {id, std::string(address, static_cast<std::size_t>(std::max<ssize_t>(n_read, 0)))};
}

double over_zeromq(Eigen::Index n_nodes, bool is_tcp) {
  const ServerProcess flow = start_server(n_nodes, true, is_tcp), solid = start_server(n_nodes, false, is_tcp);
  const double time =
      exchange_ms(wire::connect_zeromq(flow.address, {}), wire::connect_zeromq(solid.address, {}), n_nodes);
  for (const pid_t id : {flow.id, solid.id}) waitpid(id, nullptr, 0);
  return time;
}

double over_memory(Eigen::Index n_nodes) {
  auto flow = wire::make_memory_channel(), solid = wire::make_memory_channel();
  std::thread flow_thread([&] { serve(*flow.second, n_nodes, true); });
  std::thread solid_thread([&] { serve(*solid.second, n_nodes, false); });
  const double time = exchange_ms(std::move(flow.first), std::move(solid.first), n_nodes);
  flow_thread.join(), solid_thread.join();
  return time;
}

double without_channel(Eigen::Index n_nodes) {
  TrivialSolver flow(n_nodes, true), solid(n_nodes, false);
  return exchange_ms(flow, solid, n_nodes);
}

/// Median time of one update of IQN-ILS that holds 50 columns: a new difference in, the oldest out, the next
/// displacement and velocity.
double acceleration_ms(Eigen::Index n_nodes) {
  constexpr int n_columns = 50;
  coupling::QuasiNewtonOptions options;
  options.columns_max = n_columns;
  coupling::IqnIls acceleration({3 * n_nodes, 6 * n_nodes}, options);
  acceleration.start_step();
  std::srand(1);
  std::vector<double> times;
  const int n_timed = n_nodes > 50000 ? 15 : 40;
  for (int k = 0; k < n_columns + n_timed; ++k) {
    const Eigen::VectorXd input = Eigen::VectorXd::Random(6 * n_nodes), output = Eigen::VectorXd::Random(6 * n_nodes);
    const auto start = Clock::now();
    acceleration.next_input(input, output);
    if (k >= n_columns) times.push_back(milliseconds_since(start));
  }
  return median(times);
}

struct Row {
  Eigen::Index n_nodes;
  std::string transport;
  double exchange, acceleration;
};

void print(const Row& row) {
  std::printf("%8td  %-8s %12.3f %16.3f\n", row.n_nodes, row.transport.c_str(), row.exchange, row.acceleration);
  std::fflush(stdout);
}

constexpr Eigen::Index all_n_nodes[] = {1000, 10000, 100000};

std::vector<Row> measure_all() {
  std::vector<Row> rows;
  for (const Eigen::Index n_nodes : all_n_nodes) {
    const double acceleration = acceleration_ms(n_nodes);
    const auto add = [&](const std::string& transport, double exchange) {
      rows.push_back({n_nodes, transport, exchange, acceleration});
      print(rows.back());
    };
    add("zmq", over_zeromq(n_nodes, true));
    add("zmq-ipc", over_zeromq(n_nodes, false));
    add("memory", over_memory(n_nodes));
    add("direct", without_channel(n_nodes));
  }
  return rows;
}

/// Every process of `mpirun -np 3 bench-coupling-cost --mpi`: coupler, flow and solid by rank.
std::vector<Row> measure_mpi(wire::MpiJob& job) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  wire::MpiConnections connections = job.connect(static_cast<wire::MpiRole>(rank), {});
  std::vector<Row> rows;
  constexpr Eigen::Index n_nodes = 10000;
  if (rank > 0) {
    serve(*connections.coupler, n_nodes, rank == 1);
    return rows;
  }
  const double exchange = exchange_ms(std::move(connections.flow), std::move(connections.solid), n_nodes);
  rows.push_back({n_nodes, "mpi", exchange, acceleration_ms(n_nodes)});
  print(rows.back());
  return rows;
}

void write_json(const std::string& path, const std::vector<Row>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    list.push_back({{"nodes", row.n_nodes},
                    {"transport", row.transport},
                    {"exchange_ms", row.exchange},
                    {"acceleration_ms", row.acceleration},
                    {"commit", report::commit()}});
  }
  std::ofstream(path) << list.dump(1) << "\n";
}

int run(int argc, char** argv) {
  CLI::App app(about, "bench-coupling-cost");
  std::string json;
  bool wants_about = false, is_mpi = false;
  app.add_option("--json", json, "write the rows there");
  app.add_flag("--about", wants_about, "say in one line what is measured");
  app.add_flag("--mpi", is_mpi, "inside mpirun -np 3: exchange over MPI at 10000 nodes");
  CLI11_PARSE(app, argc, argv);
  if (wants_about) return std::printf("%s\n", about), 0;
  if (is_mpi) {
    return wire::run_in_mpi("bench-coupling-cost", [&](wire::MpiJob& job) {
      const std::vector<Row> rows = measure_mpi(job);
      if (!json.empty() && !rows.empty()) write_json(json, rows);
      return 0;
    });
  }
  std::printf(
      "medians; force (n, 3) to the solid, displacement and velocity (n, 3) to the flow; IQN-ILS with 50 columns\n");
  std::printf("%8s  %-8s %12s %16s\n", "nodes", "channel", "exchange ms", "acceleration ms");
  const std::vector<Row> rows = measure_all();
  if (!json.empty()) write_json(json, rows);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return couplet::report::run_program("bench-coupling-cost", run, argc, argv);
}
