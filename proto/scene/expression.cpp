#include "proto/scene/expression.hpp"

#include <muParser.h>

#include <numbers>

#include "proto/report/failure.hpp"

namespace couplet::scene {

struct Expression::Parsed {
  double x = 0, y = 0, z = 0, t = 0;
  mu::Parser parser;
};

namespace {

[[noreturn]] void refuse(const std::string& formula, std::size_t place, const std::string& what) {
  throw report::SceneError(
      "", "the formula \"" + formula + "\" cannot be read at character " + std::to_string(place + 1) + ": " + what,
      "write it with x, y, z, t, pi, + - * / ^ and functions such as sin, exp, sqrt, abs");
}

std::string reason(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN:
      return "\"" + error.GetToken() + "\" is unknown";
    case mu::ecUNEXPECTED_EOF:
      return "it ends too early";
    case mu::ecMISSING_PARENS:
      return "a closing parenthesis is missing";
    case mu::ecUNEXPECTED_PARENS:
      return "this parenthesis does not belong here";
    case mu::ecTOO_MANY_PARAMS:
      return "the function " + error.GetToken() + " takes fewer values";
    case mu::ecTOO_FEW_PARAMS:
      return "the function " + error.GetToken() + " takes more values";
    default:
      return "\"" + error.GetToken() + "\" does not belong here";
  }
}

// Place of an = that assigns: a formula has a value and no effect.
std::size_t place_of_assignment(const std::string& formula) {
  for (std::size_t i = 0; i < formula.size(); ++i) {
    const bool is_comparison = (i > 0 && std::string("=<>!").find(formula[i - 1]) != std::string::npos) ||
                               (i + 1 < formula.size() && formula[i + 1] == '=');
    if (formula[i] == '=' && !is_comparison) return i;
  }
  return std::string::npos;
}

}  // namespace

Expression::Expression(const std::string& formula) : parsed_(std::make_unique<Parsed>()) {
  if (formula.find_first_not_of(" \t\r\n") == std::string::npos) refuse(formula, 0, "it is empty");
  const std::size_t assignment = place_of_assignment(formula);
  if (assignment != std::string::npos) refuse(formula, assignment, "\"=\" does not belong here");
  mu::Parser& parser = parsed_->parser;
  try {
    parser.DefineVar("x", &parsed_->x);
    parser.DefineVar("y", &parsed_->y);
    parser.DefineVar("z", &parsed_->z);
    parser.DefineVar("t", &parsed_->t);
    parser.DefineConst("pi", std::numbers::pi);
    parser.SetExpr(formula);
    parser.Eval();  // translates it, so that at() only computes
  } catch (const mu::ParserError& error) {
    refuse(formula, std::min<std::size_t>(static_cast<std::size_t>(error.GetPos()), formula.size()), reason(error));
  }
  if (parser.GetNumResults() != 1) refuse(formula, formula.find(','), "a comma separates two values");
}

Expression::Expression(Expression&&) noexcept = default;
Expression::~Expression() = default;

double Expression::at(double x, double y, double z, double t) const {
  parsed_->x = x;
  parsed_->y = y;
  parsed_->z = z;
  parsed_->t = t;
  return parsed_->parser.Eval();
}

}  // namespace couplet::scene
