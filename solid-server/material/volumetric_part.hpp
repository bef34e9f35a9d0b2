#pragma once
// The part of a strain energy that feels the change of volume alone.

namespace couplet::solid {

/// U = K/2 (J - 1)^2   [Holzapfel 2000, 6.5]; all of [Pa], J = det F is a number or a pack of numbers.
struct VolumetricPart {
  double bulk_modulus = 0;  // K [Pa]

  template <class Real>
  [[gnu::always_inline]] inline Real energy(const Real& J) const {
    return 0.5 * bulk_modulus * (J - 1.0) * (J - 1.0);
  }

  /// U' = K (J - 1).
  template <class Real>
  [[gnu::always_inline]] inline Real pressure(const Real& J) const {
    return bulk_modulus * (J - 1.0);
  }

  /// U'' = K, whatever J is.
  template <class Real>
  [[gnu::always_inline]] inline Real stiffness(const Real&) const {
    return Real{} + bulk_modulus;
  }
};

}  // namespace couplet::solid
