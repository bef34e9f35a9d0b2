#include "proto/scene/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>
#include <vector>

#include "proto/report/failure.hpp"

namespace couplet::scene {
namespace {

std::string refusal(const std::string& formula) {
  try {
    Expression{formula};
  } catch (const report::SceneError& error) {
    return error.sentence();
  }
  return "accepted";
}

TEST(Expression, ComputesInAllVariables) {
  const Expression formula("0.6*(y/0.010)^2*sin(pi*z/0.020) + x - 2*t");
  const double expected = 0.6 * 0.25 * std::sin(std::numbers::pi * 0.25) + 3 - 2 * 0.5;
  EXPECT_NEAR(formula.at(3, 0.005, 0.005, 0.5), expected, 1e-14);  // round-off of a handful of operations
}

TEST(Expression, GivesTheSameEveryTime) {
  const Expression formula("sin(x)*exp(-t)");
  const double first = formula.at(0.3, 0, 0, 0.7);
  formula.at(9, 9, 9, 9);
  EXPECT_EQ(formula.at(0.3, 0, 0, 0.7), first);
}

TEST(Expression, CanBeMoved) {
  Expression formula("x+y");
  const Expression moved(std::move(formula));
  EXPECT_EQ(moved.at(1, 2, 0, 0), 3);
}

TEST(Expression, ComputesInSeveralThreadsWithAnObjectEach) {
  std::vector<double> sums(4);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    threads.emplace_back([&sums, i] {
      const Expression formula("x*x + sin(y)");
      for (int k = 0; k < 1000; ++k) sums[i] += formula.at(k, 0.5, 0, 0);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double sum : sums) EXPECT_EQ(sum, sums[0]);
}

TEST(Expression, SaysWhereAFormulaIsWrong) {
  EXPECT_EQ(refusal("2*foo"), "the formula \"2*foo\" cannot be read at character 3: \"foo\" is unknown");
  EXPECT_EQ(refusal("sin("), "the formula \"sin(\" cannot be read at character 5: it ends too early");
  EXPECT_EQ(refusal("(1+x"), "the formula \"(1+x\" cannot be read at character 5: a closing parenthesis is missing");
  EXPECT_EQ(refusal("1+x)"),
            "the formula \"1+x)\" cannot be read at character 4: this parenthesis does not belong here");
  EXPECT_EQ(refusal("x+*2"), "the formula \"x+*2\" cannot be read at character 3: \"*\" does not belong here");
  EXPECT_EQ(refusal(" "), "the formula \" \" cannot be read at character 1: it is empty");
  EXPECT_EQ(refusal("x,y"), "the formula \"x,y\" cannot be read at character 2: a comma separates two values");
  EXPECT_EQ(refusal("sin(x,y)"),
            "the formula \"sin(x,y)\" cannot be read at character 8: the function sin takes fewer values");
}

TEST(Expression, RefusesToAssign) {
  EXPECT_EQ(refusal("x=2"), "the formula \"x=2\" cannot be read at character 2: \"=\" does not belong here");
}

}  // namespace
}  // namespace couplet::scene
