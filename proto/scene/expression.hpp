#pragma once
// A formula in x, y, z [m], t [s] and pi.

#include <memory>
#include <string>

namespace couplet::scene {

class Expression {
 public:
  /// Throws SceneError with the place in the formula when it cannot be read.
  explicit Expression(const std::string& formula);
  Expression(Expression&&) noexcept;
  ~Expression();
  double at(double x, double y, double z, double t) const;

 private:
  struct Parsed;
  std::unique_ptr<Parsed> parsed_;
};

}  // namespace couplet::scene
