#include "solid-server/service/solid_participant.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "proto/report/failure.hpp"
#include "proto/store/result_reader.hpp"
#include "tests/unit/solid-server/service/fold_scene.hpp"

namespace couplet::solid {
namespace {

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

TEST(SolidParticipant, RefusesACheckpointOfAMeshWithAsManyNodesElsewhere) {
  const auto path = fresh_folder("solid_same_size") / "fold.h5";
  Driven driven(request(solid_text));
  driven.go();
  driven.solid.write_checkpoint(path.string());
  auto other = request(solid_text);
  auto& fold = *other.scene.mutable_solid()->mutable_body(0)->mutable_vocal_fold();
  fold.set_length(1.01 * fold.length());
  other.resume_from = path.string();
  SolidParticipant solid({});
  try {
    solid.open(other);
    ADD_FAILURE() << "accepted";
  } catch (const report::FileError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("was written for another mesh"));
  }
}

TEST(SolidParticipant, EstimatesTheStableStepAnewForAnotherMaterialThanThatOfTheCheckpoint) {
  const auto path = fresh_folder("solid_other_material") / "fold.h5";
  Driven driven(request(solid_text));
  driven.go();
  driven.solid.write_checkpoint(path.string());
  auto stiffer = request(solid_text);
  auto& law = *stiffer.scene.mutable_solid()->mutable_body(0)->mutable_material()->mutable_mooney_rivlin();
  law.set_a10(100 * law.a10());
  law.set_a01(100 * law.a01());
  law.set_bulk_modulus(100 * law.bulk_modulus());
  Driven anew(stiffer);
  stiffer.resume_from = path.string();
  Driven resumed(stiffer);
  anew.go();
  resumed.go();
  const std::size_t substeps = 4;  // solid.substeps
  EXPECT_GT(resumed.numbers[substeps].value, driven.numbers[substeps].value);
  EXPECT_EQ(resumed.numbers[substeps].value, anew.numbers[substeps].value);  // nothing has moved far
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

}  // namespace
}  // namespace couplet::solid
