// The elastic tube with the coupler's own defaults: no case may fail, and the published numbers of iterations are upper
// limits.
#include <gtest/gtest.h>

#include <cmath>

#include "proto/report/failure.hpp"
#include "tests/oracle/coupled_march.hpp"
#include "tests/oracle/elastic_tube_participants.hpp"

namespace couplet::oracle {
namespace {

v1::Coupling criteria_of_the_benchmark() {
  v1::Coupling coupling;
  for (const char* field : {"area", "pressure"}) {
    v1::Convergence* criterion = coupling.add_convergence();
    criterion->set_field(field);
    criterion->set_relative(1e-5);
  }
  return coupling;
}

CoupledMarch march_tube(double young_modulus, double step, const v1::Coupling& coupling, double end = 1) {
  ElasticTube tube;
  tube.young_modulus = young_modulus;
  ElasticTubeFlow flow(tube);
  ElasticTubeWall wall(tube);
  return march(flow, wall, coupling, end, step);
}

struct TubeCase {
  double young_modulus, step, iterations_max;
};

class ElasticTubeDefaults : public testing::TestWithParam<TubeCase> {};
// Limits: the mean iterations of preCICE 3.4.1 on the same discretisation, its best row where several were
// measured; 6.5 at E = 1e4, dt = 0.01.
INSTANTIATE_TEST_SUITE_P(Published, ElasticTubeDefaults,
                         testing::Values(TubeCase{1e5, 0.01, 5.62}, TubeCase{3e4, 0.01, 6.80}, TubeCase{1e4, 0.01, 6.5},
                                         TubeCase{5e3, 0.01, 13.5}, TubeCase{1e4, 0.02, 8.56},
                                         TubeCase{1e4, 0.005, 9.58}, TubeCase{1e4, 0.002, 33}));

TEST_P(ElasticTubeDefaults, NeedFewerIterationsThanPublishedAndNeverFail) {
  const CoupledMarch run = march_tube(GetParam().young_modulus, GetParam().step, criteria_of_the_benchmark());
  EXPECT_EQ(run.n_discarded, 0);
  EXPECT_LT(run.iterations_mean(), GetParam().iterations_max);
}

TEST(ElasticTube, ConvergesForTheHardestCombinationsToo) {
  for (const double young_modulus : {5e3, 1e5}) {
    for (const double step : {0.02, 0.002}) {
      EXPECT_EQ(march_tube(young_modulus, step, criteria_of_the_benchmark(), 0.2).n_discarded, 0)
          << young_modulus << " " << step;
    }
  }
}

TEST(ElasticTube, GivesTheSameAnswerByEveryAcceleration) {
  v1::Coupling coupling = criteria_of_the_benchmark();
  for (v1::Convergence& criterion : *coupling.mutable_convergence()) criterion.set_relative(1e-9);
  coupling.set_iterations_max(2000);
  v1::Coupling aitken = coupling, imvj = coupling, parallel = coupling;
  aitken.mutable_aitken();
  imvj.mutable_iqn_imvj();
  parallel.set_scheme(v1::Coupling::PARALLEL_IMPLICIT);
  const Eigen::VectorXd reference = march_tube(1e5, 0.01, coupling, 0.1).steps.back().state.load;
  for (const v1::Coupling& other : {aitken, imvj, parallel}) {
    const Eigen::VectorXd load = march_tube(1e5, 0.01, other, 0.1).steps.back().state.load;
    EXPECT_LT((load - reference).norm(), 1e-6 * reference.norm());  // ten steps of 1e-9, enlarged by the added mass
  }
}

TEST(ElasticTube, NeverAcceptsAnOverflow) {
  // Without relaxation, or with far too little, the iterations overflow; saturated values stop changing and look
  // converged.
  for (const double factor : {1., 0.5, 0.2, 0.1}) {
    v1::Coupling coupling = criteria_of_the_benchmark();
    coupling.set_iterations_max(500);
    coupling.set_halvings_max(2);
    v1::ConstantRelaxation* constant = coupling.mutable_constant();
    constant->set_displacement(factor), constant->set_velocity(factor), constant->set_force(1);
    EXPECT_THROW(march_tube(1e4, 0.01, coupling, 0.05), report::NumericsError) << factor;
  }
}

TEST(ElasticTube, SaysWhyItFails) {
  v1::Coupling coupling = criteria_of_the_benchmark();
  coupling.set_iterations_max(4);
  coupling.set_halvings_max(1);
  try {
    march_tube(1e4, 0.01, coupling, 0.05);
    FAIL() << "four iterations cannot be enough";
  } catch (const report::NumericsError& failure) {
    const std::string text = failure.what();
    EXPECT_NE(text.find("step 1 from t = 0 s by dt = 0.005 s"), std::string::npos) << text;
    EXPECT_NE(text.find("area still changes by"), std::string::npos) << text;
    EXPECT_NE(text.find("pressure still changes by"), std::string::npos) << text;
    EXPECT_NE(text.find("allowed 1e-05 relative"), std::string::npos) << text;
    EXPECT_NE(text.find("added-mass number is"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace couplet::oracle
