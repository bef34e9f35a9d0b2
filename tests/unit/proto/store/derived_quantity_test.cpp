#include "proto/store/derived_quantity.hpp"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "proto/report/failure.hpp"

namespace couplet::store {
namespace {

using std::numbers::pi;

constexpr double frequency = 137.3;  // [Hz], no whole number of samples or bins

/// Twenty cycles in the window and as many before it, sampled at steps between 5 and 15 us, as after retried steps.
Table history(bool is_uniform = false) {
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> step(5e-6, 15e-6);
  Table table{{{"time", "s"}, {"x", "m"}, {"lag", "m"}, {"ramp", "Pa"}, {"growing", "m"}, {"sum", "m"}},
              std::vector<std::vector<double>>(6)};
  for (double t = 0; t < 40 / frequency; t += is_uniform ? 1e-5 : step(generator)) {
    const double angle = 2 * pi * frequency * t;
    const double row[] = {t,     1e-3 * std::cos(angle) + 2e-4, 3e-4 * std::cos(angle - 25 * pi / 180),
                          5 * t, 1e-3 * t * std::sin(angle),    std::sin(angle) + 0.3 * std::sin(2 * angle + 1)};
    for (int column = 0; column < 6; ++column) table.values[column].push_back(row[column]);
  }
  return table;
}

SummaryQuantity derive(const std::string& text, const Table& table = history()) {
  v1::Quantity quantity;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString("name: 'q' " + text, &quantity)) << text;
  return derive_quantity(quantity, table);
}

TEST(DerivedQuantity, FrequencyOfTwentyCyclesIsGoodToTheTwentiethOfAPercent) {
  for (const bool is_uniform : {false, true}) {
    const auto found = derive("kind: FREQUENCY column: 'x'", history(is_uniform));
    EXPECT_NEAR(found.value, frequency, 5e-4 * frequency);
    EXPECT_EQ(found.unit, "Hz");
    EXPECT_EQ(found.name, "q");
    EXPECT_GE(found.n_cycles, 18);
    EXPECT_LT(found.spread, 1e-3 * frequency);
  }
}

TEST(DerivedQuantity, FrequencyOfGrowingOscillationIsThatOfItsLine) {
  EXPECT_NEAR(derive("kind: FREQUENCY column: 'growing'").value, frequency, 5e-4 * frequency);
}

TEST(DerivedQuantity, PhaseIsPositiveWhenTheColumnLeads) {
  // x is 25 degrees ahead of lag.
  EXPECT_NEAR(derive("kind: PHASE_DELAY column: 'x' reference: 'lag'").value, 25, 0.1);
  EXPECT_NEAR(derive("kind: PHASE_DELAY column: 'lag' reference: 'x'").value, -25, 0.1);
  EXPECT_EQ(derive("kind: PHASE_DELAY column: 'x' reference: 'lag'").unit, "deg");
  // Turning the sign is half a turn, and stays in (-180, 180].
  EXPECT_NEAR(derive("kind: PHASE_DELAY column: 'x' reference: 'lag' factor: -1").value, 25 - 180, 0.1);
}

TEST(DerivedQuantity, MaximumIsTheMeanOverCyclesAboveTheOffset) {
  const auto found = derive("kind: MAXIMUM column: 'x' offset: 2e-4");
  EXPECT_NEAR(found.value, 1e-3, 1e-3 * 1e-4);  // the parabola through the samples
  EXPECT_LT(found.spread, 1e-7);
  EXPECT_GE(found.n_cycles, 18);
  EXPECT_EQ(found.unit, "m");
  EXPECT_NEAR(derive("kind: MAXIMUM column: 'x' factor: -1").value, 1e-3 - 2e-4, 1e-7);
}

TEST(DerivedQuantity, MaximumOfGrowingOscillationHasASpread) {
  // Linear growth from half to the end: the tops rise evenly from 0.5 to 1 of the last one.
  const double last = 1e-3 * 40 / frequency;
  const auto found = derive("kind: MAXIMUM column: 'growing'");
  EXPECT_NEAR(found.value, 0.75 * last, 0.02 * last);  // whole cycles leave out up to one cycle in twenty
  EXPECT_NEAR(found.spread, 0.5 * last / std::sqrt(12.0), 0.02 * last);  // uniform distribution
}

TEST(DerivedQuantity, PeakToPeakIsTwiceTheAmplitude) {
  EXPECT_NEAR(derive("kind: PEAK_TO_PEAK column: 'x'").value, 2e-3, 2e-7);
}

TEST(DerivedQuantity, LineAmplitudeLeavesOutTheHarmonics) {
  EXPECT_NEAR(derive("kind: LINE_AMPLITUDE column: 'sum'").value, 1, 2e-3);
  EXPECT_GT(derive("kind: PEAK_TO_PEAK column: 'sum'").value, 2.1);
}

TEST(DerivedQuantity, MeanIsOverWholeCycles) {
  const auto found = derive("kind: MEAN column: 'x' factor: 2 offset: 1e-4");
  EXPECT_NEAR(found.value, 2 * 2e-4 - 1e-4, 2e-3 * 1e-3);
  EXPECT_GE(found.n_cycles, 18);
}

TEST(DerivedQuantity, MeanOfAColumnThatDoesNotOscillateIsThePlainOne) {
  const auto found = derive("kind: MEAN column: 'ramp'", history(true));
  EXPECT_NEAR(found.value, 5 * 0.75 * 40 / frequency, 1e-3);
  EXPECT_LT(found.n_cycles, 0);
}

TEST(DerivedQuantity, FinalIsTheLastValueOfTheWindow) {
  const Table table = history();
  EXPECT_EQ(derive("kind: FINAL column: 'ramp'", table).value, table.values[3].back());
  EXPECT_NEAR(derive("kind: FINAL column: 'ramp' until: 0.1 factor: -2 offset: 1", table).value, -2 * 5 * 0.1 - 1,
              2e-4);
}

TEST(DerivedQuantity, HasTheUnitOfTheColumnUnlessItNamesItsOwn) {
  EXPECT_EQ(derive("kind: FINAL column: 'ramp' factor: 2").unit, "Pa");
  EXPECT_EQ(derive("kind: FINAL column: 'ramp' factor: 2 result_unit: '1'").unit, "1");
  EXPECT_EQ(derive("kind: FREQUENCY column: 'x' result_unit: '1'").unit, "Hz");
}

TEST(DerivedQuantity, LargestAndSmallestNeedNoCycles) {
  const Table table = history();
  const auto& ramp = table.values[3];
  EXPECT_EQ(derive("kind: LARGEST column: 'ramp'", table).value, ramp.back());
  EXPECT_EQ(derive("kind: LARGEST column: 'ramp' window: 1 factor: -2 offset: 1", table).value, -2 * ramp.front() - 1);
  EXPECT_EQ(derive("kind: SMALLEST column: 'ramp' window: 1", table).value, ramp.front());
  // Half of the run is used where no window is named; samples are 15 us apart at most.
  EXPECT_NEAR(derive("kind: SMALLEST column: 'ramp'", table).value, ramp.back() / 2, 5 * 15e-6);
}

TEST(DerivedQuantity, WindowMayEndBeforeTheRun) {
  const double last = 1e-3 * 20 / frequency;
  const auto found = derive("kind: MAXIMUM column: 'growing' window: 0.05 until: " + std::to_string(20 / frequency));
  EXPECT_NEAR(found.n_cycles, 0.05 * frequency, 2);
  EXPECT_NEAR(found.value, last * (1 - 0.025 * frequency / 20), 0.05 * last);
}

TEST(DerivedQuantity, StandsNoiseOfOneTenth) {
  Table table = history();
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0, 1e-4);
  for (double& value : table.values[1]) value += noise(generator);
  const auto found = derive("kind: FREQUENCY column: 'x'", table);
  EXPECT_NEAR(found.value, frequency, 1e-3 * frequency);
  EXPECT_GE(found.n_cycles, 18);
  EXPECT_LE(found.n_cycles, 20);
  EXPECT_NEAR(derive("kind: PHASE_DELAY column: 'x' reference: 'lag'", table).value, 25, 1);
}

TEST(DerivedQuantity, RefusesWhatTheHistoryDoesNotHold) {
  EXPECT_THROW(derive("kind: FREQUENCY column: 'x' window: 0.015"), report::NumericsError) << "two cycles";
  EXPECT_THROW(derive("kind: MAXIMUM column: 'ramp' frequency_from: 100"), report::NumericsError);
  EXPECT_THROW(derive("kind: MEAN column: 'y'"), report::SceneError);
  EXPECT_THROW(derive("kind: PHASE_DELAY column: 'x' reference: 'y'"), report::SceneError);
  const Table empty{history().columns, std::vector<std::vector<double>>(6)};
  for (const char* kind : {"FREQUENCY", "MEAN", "FINAL", "MAXIMUM"})
    EXPECT_THROW(derive("column: 'x' kind: " + std::string(kind), empty), report::NumericsError);
}

}  // namespace
}  // namespace couplet::store
