#include "coupler/predictor/make_predictor.hpp"

#include "coupler/predictor/fitted_predictor.hpp"
#include "coupler/predictor/polynomial_predictor.hpp"

namespace couplet::coupling {

std::unique_ptr<Predictor> make_predictor(const v1::Coupling& coupling, Eigen::Index n_primary) {
  switch (coupling.predictor()) {
    case v1::Coupling::CONSTANT:
      return std::make_unique<PolynomialPredictor>(0);
    case v1::Coupling::LINEAR:
      return std::make_unique<PolynomialPredictor>(1);
    case v1::Coupling::QUADRATIC:
      return std::make_unique<PolynomialPredictor>(2);
    case v1::Coupling::FITTED:
      break;
  }
  if (coupling.scheme() == v1::Coupling::EXPLICIT) return std::make_unique<PolynomialPredictor>(2);
  return std::make_unique<FittedPredictor>(n_primary);
}

}  // namespace couplet::coupling
