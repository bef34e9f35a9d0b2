#include "solid-server/service/solid_participant.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "proto/report/failure.hpp"
#include "proto/store/result_reader.hpp"
#include "solid-server/mesh/parametric/box_mesh.hpp"
#include "solid-server/service/estimate_solid.hpp"
#include "solid-server/service/make_setup.hpp"
#include "solid-server/service/mesh_size.hpp"

namespace couplet::solid {
namespace {

constexpr double coupling_step = 2e-5;  // [s]

const std::string solid_text = R"scene(
  title: "a fold"
  time { end: 1 step: 2e-5 }
  solid {
    body {
      name: "fold"
      vocal_fold { medial_thickness: 1.75e-3 elements_x: 3 elements_y: 4 elements_z: 4 half_length: true }
      material { density: 1040 mooney_rivlin { a10: 2290 a01: 250 bulk_modulus: 1e5 } }
      fixed: "lateral" fixed: "anterior"
      symmetry { surface: "posterior" normal: Z }
      wetted: "inferior" wetted: "medial" wetted: "superior"
      mass_damping: 0.05
    }
    rigid_plane { y: 0.0101 }
    settling { until: 1e-4 mass_damping: 400 }
    kick { time: 1e-4 velocity { y: "0.6*(y/0.01)^2*sin(pi*z/0.02)"
}
}
time_integration {
estimate_every:
  3
}
}
)scene";
const std::string flow_text = R"scene(
  flow {
    fluid { density: 1.1 viscosity: 1e-5 }
    glottis { model: B1 subglottal_pressure { row { time: 0 value: 100 } } midplane: 0.0102 }
  }
)scene";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

participant::OpenRequest request(const std::string& text) {
  participant::OpenRequest out;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &out.scene));
  return out;
}

/// A solid that is led by hand.
struct Driven {
  SolidParticipant solid{{.threads = 1}};
  participant::Opened opened;
  std::int64_t step = 0;

  explicit Driven(const participant::OpenRequest& open_request) : opened(solid.open(open_request)) {
    step = std::llround(opened.time / coupling_step);
  }

  surface::FieldSet load() const {
    surface::NodeArray force = surface::NodeArray::Zero(opened.surface.n_nodes(), 3);
    force.col(0).setConstant(1e-6 * static_cast<double>(step + 1));
    return {{"force", "N", force}};
  }

  participant::StepSolved solve() {
    const double start = opened.time;
    return solid.solve_step({step + 1, 1, start, coupling_step}, load());
  }

  surface::FieldSet go() {
    const auto solved = solve();
    numbers = solid.accept_step(++step);
    opened.time += coupling_step;
    return solved.fields;
  }

  std::vector<participant::NamedNumber> numbers;
};

std::filesystem::path fresh_folder(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("couplet_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "results");
  return folder;
}

const participant::NamedNumber& find(const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
  const auto found = std::find_if(numbers.begin(), numbers.end(), [&](const auto& n) { return n.name == name; });
  if (found == numbers.end()) throw std::out_of_range(name);
  return *found;
}
double value_of(const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
  return find(numbers, name).value;
}
std::string text_of(const std::vector<participant::NamedNumber>& numbers, const std::string& name) {
  return find(numbers, name).text;
}

std::vector<std::string> names(const std::vector<participant::NamedNumber>& numbers) {
  std::vector<std::string> out;
  for (const auto& number : numbers) out.push_back(number.name);
  return out;
}

TEST(SolidParticipant, NeedsForceWhereThereIsAFlowAndNothingElsewhere) {
  SolidParticipant coupled({}), alone({});
  EXPECT_EQ(coupled.open(request(solid_text + flow_text)).needs, std::vector<std::string>{"force"});
  const auto opened = alone.open(request(solid_text));
  EXPECT_TRUE(opened.needs.empty());
  EXPECT_EQ(opened.offers, (std::vector<std::string>{"displacement", "velocity"}));
  EXPECT_EQ(opened.time, 0);
  EXPECT_EQ(surface::find_field(opened.fields, "velocity").values.rows(), opened.surface.n_nodes());
  EXPECT_TRUE(opened.surface.marker.contains("C1"));
}

TEST(SolidParticipant, ReportsTheSameQuantitiesAtEveryStep) {
  Driven driven(request(solid_text + flow_text));
  for (int n = 0; n < 7; ++n) {
    driven.go();
    EXPECT_THAT(
        names(driven.numbers),
        testing::ElementsAre("solid.kinetic_energy", "solid.strain_energy", "solid.contact_energy",
                             "solid.contact_force", "solid.substeps", "solid.reaction.lateral.x",
                             "solid.reaction.lateral.y", "solid.reaction.lateral.z", "solid.reaction.anterior.x",
                             "solid.reaction.anterior.y", "solid.reaction.anterior.z", "solid.reaction.posterior.x",
                             "solid.reaction.posterior.y", "solid.reaction.posterior.z"));
  }
  EXPECT_GT(driven.numbers[0].value, 0);
  EXPECT_GE(driven.numbers[4].value, 1);
  EXPECT_THAT(names(driven.solid.close("done")), testing::IsSupersetOf({"seconds", "peak_memory_bytes", "substeps"}));
}

TEST(SolidParticipant, ReportsHowCloseSurfacesAre) {
  Driven driven(request(R"scene(
    time { end: 1 step: 2e-5 }
    solid {
      body {
        name: "valve" valve { thickness: 0.3e-3 elements_u: 4 elements_v: 2 } fixed: "base"
        material { density: 1000 saint_venant_kirchhoff { young_modulus: 1.5e6 poisson_ratio: 0.4 } }
      }
      pressure { surface: "ventricular" value { row { time: 0 value: -2000 } } }
      contact { first: "contact_1" second: "contact_2" distance: 5e-5 }
    }
  )scene"));
  const auto find = [&](const std::string& name) {
    return std::find_if(driven.numbers.begin(), driven.numbers.end(), [&](const auto& n) { return n.name == name; });
  };
  driven.go();
  ASSERT_NE(find("solid.contact_distance"), driven.numbers.end());
  EXPECT_EQ(find("solid.contact_distance")->unit, "m");
  EXPECT_EQ(find("solid.contact_distance")->value, 5e-5);  // the leaflets are 0.1 mm apart: nothing touches yet
  EXPECT_EQ(find("solid.contact_force")->value, 0);
  int n_steps = 0;
  while (find("solid.contact_force")->value == 0 && ++n_steps < 100) driven.go();
  EXPECT_LT(find("solid.contact_distance")->value, 5e-5);
  EXPECT_GT(find("solid.contact_distance")->value, 0);
}

TEST(SolidParticipant, ResumesFromACheckpointWithTheSameBits) {
  const auto path = fresh_folder("solid_resume") / "fold.h5";
  Driven through(request(solid_text + flow_text)), first(request(solid_text + flow_text));
  for (int n = 0; n < 4; ++n) {
    through.go();
    first.go();
  }
  const std::uint64_t n_bytes = first.solid.write_checkpoint(path.string());
  EXPECT_EQ(n_bytes, std::filesystem::file_size(path));
  auto again = request(solid_text + flow_text);
  again.resume_from = path.string();
  Driven second(again);
  EXPECT_EQ(second.step, 4);
  for (int n = 0; n < 5; ++n) {  // over a kick, the end of settling and an estimate of the stable step
    const auto a = through.go(), b = second.go();
    EXPECT_EQ(surface::find_field(a, "displacement").values, surface::find_field(b, "displacement").values);
    EXPECT_EQ(surface::find_field(a, "velocity").values, surface::find_field(b, "velocity").values);
    EXPECT_EQ(through.numbers[1].value, second.numbers[1].value);
  }
}

TEST(SolidParticipant, RefusesACheckpointOfAnotherMesh) {
  const auto path = fresh_folder("solid_other_mesh") / "fold.h5";
  Driven driven(request(solid_text));
  driven.go();
  driven.solid.write_checkpoint(path.string());
  auto other = request(solid_text);
  other.scene.mutable_solid()->mutable_body(0)->mutable_vocal_fold()->set_elements_x(4);
  other.resume_from = path.string();
  SolidParticipant solid({});
  EXPECT_THROW(solid.open(other), report::FileError);
}

TEST(SolidParticipant, RefusesToGoOnByAnotherMethod) {
  const auto path = fresh_folder("solid_other_method") / "fold.h5";
  Driven driven(request(solid_text));
  driven.go();
  driven.solid.write_checkpoint(path.string());
  auto other = request(solid_text);
  auto& integration = *other.scene.mutable_solid()->mutable_time_integration();
  integration.set_method(v1::TimeIntegration::GENERALIZED_ALPHA);
  other.resume_from = path.string();
  SolidParticipant solid({});
  try {
    solid.open(other);
    ADD_FAILURE() << "accepted";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(
        error.what(),
        "solid.time_integration.method: the scene asks for GENERALIZED_ALPHA, but the checkpoint was written by "
        "CENTRAL_DIFFERENCE; go on with that method, or start a new run");
  }
  integration.set_method(v1::TimeIntegration::AUTO);  // goes on as the run began
  EXPECT_NO_THROW(SolidParticipant({}).open(other));
}

/// What the scene is refused with.
std::string refusal(const std::string& text) {
  SolidParticipant solid({});
  try {
    solid.open(request(text));
  } catch (const report::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SolidParticipant, RefusesASurfaceThatWouldFeelTheFlowTwice) {
  EXPECT_EQ(
      refusal(replaced(solid_text, R"(wetted: "superior")", R"(wetted: "superior" wetted: "medial")") + flow_text),
      "wetted: \"medial\" and \"medial\" have a face in common, which would feel the flow twice; name each part of "
      "the surface once");
}

TEST(SolidParticipant, RefusesAProbeThatIsNotInTheBody) {
  const auto probed = [](const std::string& place) {
    return refusal(solid_text + "output { probe { name: 'tip' at { position { " + place + " } } } }");
  };
  EXPECT_NE(
      probed("x: 1 y: 9 z: 1").find("output.probe[0].at.position: (1, 9, 1) m is not in the solid: its nearest node"),
      std::string::npos);
  EXPECT_EQ(probed("x: 0 y: 0 z: 0"), "accepted");
}

TEST(SolidParticipant, RefusesAMotionThatBeginsWithAJump) {
  const auto moved = [](const std::string& x) {
    return refusal(
        replaced(solid_text, "rigid_plane", "prescribed_motion { nodes: 'anterior' x: '" + x + "' } rigid_plane"));
  };
  EXPECT_NE(moved("1e-4 * cos(t)").find("gives 0.0001 m at t = 0"), std::string::npos) << moved("1e-4 * cos(t)");
  EXPECT_EQ(moved("1e-4 * sin(t)"), "accepted");
}

TEST(SolidParticipant, RefusesAStepThatDoesNotStartAtTheAcceptedTime) {
  Driven driven(request(solid_text));
  EXPECT_THROW(driven.solid.solve_step({1, 1, coupling_step, coupling_step}, {}), report::PeerError);
}

// Both programs add up times; after millions of steps their round-off differs by more than that of one step.
TEST(SolidParticipant, FollowsTheRoundOffOfTheCoupler) {
  Driven driven(request(solid_text + flow_text));
  for (int n = 0; n < 5; ++n) {
    EXPECT_NO_THROW(driven.go()) << n;
    driven.opened.time += 0.8e-6 * coupling_step;  // off by less than 1e-6 of a step each time, by more in all
  }
}

TEST(SolidParticipant, RefusesAForceOfAnotherSize) {
  Driven driven(request(solid_text + flow_text));
  const surface::FieldSet wrong = {{"force", "N", surface::NodeArray::Zero(3, 3)}};
  EXPECT_THROW(driven.solid.solve_step({1, 1, 0, coupling_step}, wrong), report::PeerError);
  EXPECT_THROW(driven.solid.solve_step({1, 1, 0, coupling_step}, {}), report::PeerError);
}

TEST(SolidParticipant, StoresStatesAtTheWantedTimesAlsoAfterAResume) {
  const auto folder = fresh_folder("solid_results");
  auto open_request = request(solid_text + "output { results_start: 2e-5 results_interval: 5e-5 }");
  open_request.run_folder = folder.string();
  {
    Driven driven(open_request);
    for (int n = 0; n < 6; ++n) driven.go();  // to 120 us
    driven.solid.write_checkpoint((folder / "fold.h5").string());
    driven.solid.close("done");
  }
  open_request.resume_from = (folder / "fold.h5").string();
  Driven driven(open_request);
  for (int n = 0; n < 3; ++n) driven.go();  // to 180 us
  driven.solid.close("done");
  // Wanted at 20, 70, 120 and 170 us: the first accepted state then or after.
  const store::ResultReader reader(folder / "results", "fold");
  std::vector<double> times;
  for (std::size_t n = 0; n < reader.n_states(); ++n) times.push_back(reader.time(n));
  EXPECT_THAT(times, testing::Pointwise(testing::DoubleNear(1e-12), {2e-5, 8e-5, 12e-5, 18e-5}));
  EXPECT_EQ(reader.field_names(), (std::vector<std::string>{"displacement", "velocity"}));
}

TEST(SolidParticipant, StoresTheFieldsThatTheSceneNames) {
  const auto folder = fresh_folder("solid_fields");
  auto open_request = request(solid_text + "output { results_interval: 2e-5 }");
  open_request.run_folder = folder.string();
  for (const auto field : {v1::Solid::CAUCHY_STRESS, v1::Solid::REGION_NUMBER, v1::Solid::VOLUME_RATIO})
    open_request.scene.mutable_solid()->add_field(field);
  Driven driven(open_request);
  for (int n = 0; n < 8; ++n) driven.go();  // past the kick
  driven.solid.close("done");
  const store::ResultReader reader(folder / "results", "fold");
  EXPECT_THAT(reader.field_names(), testing::ElementsAre("displacement", "velocity", "cauchy_stress", "volume_ratio"));
  ASSERT_EQ(reader.n_states(), 9U);
  EXPECT_EQ(reader.field(0, "cauchy_stress").cols(), 9);
  EXPECT_GT(reader.field(8, "cauchy_stress").cwiseAbs().maxCoeff(), 1);  // [Pa]
  EXPECT_EQ(reader.mesh().cell_number.front().value.size(), 24U);
}

TEST(SolidParticipant, ReportsTheEnergyBalanceWhenAsked) {
  auto open_request = request(solid_text);
  open_request.scene.mutable_solid()->set_energy_balance(true);
  Driven driven(open_request);
  for (int n = 0; n < 8; ++n) driven.go();
  EXPECT_GT(value_of(driven.numbers, "solid.external_work"), 0);
  EXPECT_GT(value_of(driven.numbers, "solid.damping_work"), 0);
  EXPECT_LE(std::abs(value_of(driven.numbers, "solid.energy_imbalance")),
            1e-2 * value_of(driven.numbers, "solid.external_work"));  // (omega h)^2/8 of the modes that move
}

TEST(SolidParticipant, WritesNothingWithoutARunFolder) {
  Driven driven(request(solid_text + "output { results_interval: 4e-5 }"));
  EXPECT_NO_THROW(driven.go());
}

TEST(Estimate, SaysHowBigAndHowLong) {
  const auto numbers = estimate_solid(request(solid_text), 1);
  EXPECT_THAT(names(numbers),
              testing::IsSupersetOf({"elements", "nodes", "degrees_of_freedom", "memory_bytes", "stable_step",
                                     "substeps_per_step", "seconds_per_substep", "seconds"}));
  for (const auto& number : numbers) EXPECT_NE(number.value > 0, !number.text.empty()) << number.name;
  EXPECT_EQ(text_of(numbers, "time_integration"), "CENTRAL_DIFFERENCE");
  EXPECT_EQ(text_of(numbers, "elements_of_body"), "24 of hexahedron20, 27 points, standard");
  EXPECT_GT(value_of(numbers, "degrees_of_freedom"), value_of(numbers, "nodes"));
  EXPECT_LT(value_of(numbers, "degrees_of_freedom"), 3 * value_of(numbers, "nodes"));  // supports hold some
}

TEST(Estimate, MeasuresImplicitAndStaticStepsByAFactorisation) {
  for (const char* const method : {"GENERALIZED_ALPHA", "STATIC"}) {
    auto implicit = request(solid_text);
    implicit.scene.mutable_solid()->clear_kick();
    v1::TimeIntegration::Method value{};
    ASSERT_TRUE(v1::TimeIntegration::Method_Parse(method, &value));
    implicit.scene.mutable_solid()->mutable_time_integration()->set_method(value);
    const auto numbers = estimate_solid(implicit, 1);
    EXPECT_EQ(text_of(numbers, "time_integration"), method);
    EXPECT_EQ(value_of(numbers, "substeps_per_step"), 1);
    EXPECT_NEAR(value_of(numbers, "seconds") / value_of(numbers, "seconds_per_step"), 50000, 1);  // 1 s of 2e-5 s
    EXPECT_GT(value_of(numbers, "memory_bytes"), value_of(estimate_solid(request(solid_text), 1), "memory_bytes"));
  }
}

TEST(Estimate, WarnsOfALongRunWithoutNumericalDissipation) {
  const auto warns = [](double spectral_radius, double end) {
    auto open = request(solid_text);
    open.scene.mutable_time()->set_end(end);
    auto* integration = open.scene.mutable_solid()->mutable_time_integration();
    integration->set_method(v1::TimeIntegration::GENERALIZED_ALPHA);
    integration->set_spectral_radius(spectral_radius);
    const auto found = names(estimate_solid(open, 1));
    return std::count(found.begin(), found.end(), "warning") == 1;
  };
  EXPECT_TRUE(warns(1, 1));
  EXPECT_FALSE(warns(0.99, 1));
  EXPECT_FALSE(warns(1, 100 * coupling_step));
}

TEST(MeshSize, RefusesWhatCannotBeNumberedOrHeld) {
  auto large = request(solid_text).scene.solid();
  auto& fold = *large.mutable_body(0)->mutable_vocal_fold();
  EXPECT_NO_THROW(refuse_too_many_elements(large, 1e9));
  EXPECT_EQ(n_elements_wanted(large.body(0)), 24);
  EXPECT_EQ(make_setup(large, ".").mesh.n_elements(), 24);
  fold.set_elements_x(100);
  fold.set_elements_y(100);
  fold.set_elements_z(100);
  const auto message = [&](double memory) -> std::string {
    try {
      refuse_too_many_elements(large, memory);
    } catch (const report::SceneError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(1e9), "");
  EXPECT_EQ(message(5e8),
            "solid.body[0].vocal_fold: 500000 elements need at least 1 GB of memory, but this machine has 0 GB; give "
            "fewer elements");
  fold.set_elements_x(1000);
  fold.set_elements_y(1000);
  fold.set_elements_z(1000);
  EXPECT_EQ(message(1e15),
            "solid.body[0].vocal_fold: 5e+08 elements are more than the 107 million that can be numbered; give fewer "
            "elements");
}

TEST(Placement, TurnsAndMovesABody) {
  v1::Solid solid;
  const std::string text = R"(body {
      name: "block"
      box { length { x: 3 y: 2 z: 1 } }
      material { density: 1 neo_hookean { shear_modulus: 1 bulk_modulus: 1 } }
      fixed: "x_min"
      placement { rotation_axis { z: 2 } rotation_angle: 90 translation { x: 10 y: 20 z: 30 } }
    })";
  ASSERT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &solid));
  const SolidMesh mesh = make_setup(solid, ".").mesh;
  // (x, y, z) -> (10 - y, 20 + x, 30 + z), to the round-off of 30 m.
  EXPECT_TRUE(mesh.node_position.colwise().minCoeff().isApprox(Eigen::RowVector3d(8, 20, 30), 1e-15));
  EXPECT_TRUE(mesh.node_position.colwise().maxCoeff().isApprox(Eigen::RowVector3d(10, 23, 31), 1e-15));
  for (const Index node : mesh.find_nodes("x_min", "")) EXPECT_NEAR(mesh.node_position(node, 1), 20, 1e-14);

  solid.mutable_body(0)->mutable_placement()->mutable_rotation_axis()->set_z(0);
  try {
    make_setup(solid, ".");
    ADD_FAILURE() << "an axis without a direction is accepted";
  } catch (const report::SceneError& error) {
    EXPECT_STREQ(error.what(),
                 "solid.body[0].placement.rotation_axis: the axis (0, 0, 0) has no direction; give it a length");
  }
}

TEST(WorthwhileThreads, AreNeverMoreThanOfferedAndOneForASmallBody) {
  SolidSetup setup;
  setup.mesh = make_box_mesh({{1, 1, 1}, {10, 10, 10}});
  setup.properties = {{MooneyRivlin{1, 1, 1}, 1, 8}};
  EXPECT_EQ(worthwhile_threads(4, setup), 2);  // 8000 points, at least 4000 for each
  setup.properties.front().n_points = 27;
  EXPECT_EQ(worthwhile_threads(4, setup), 4);
  EXPECT_GE(worthwhile_threads(0, setup), 1);
  setup.mesh = make_box_mesh({{1, 1, 1}, {2, 2, 2}});
  EXPECT_EQ(worthwhile_threads(4, setup), 1);
}

}  // namespace
}  // namespace couplet::solid
