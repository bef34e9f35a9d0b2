#include "coupler/mapping/face_shape.hpp"

#include <cassert>

namespace couplet::coupling {

namespace {

// N = (1 - a - b, a, b)
FaceShape triangle3(double a, double b) {
  return {{1 - a - b, a, b}, {-1, 1, 0}, {-1, 0, 1}};
}

// Corners L (2 L - 1), midsides 4 L_i L_j, in barycentric coordinates L = (1 - a - b, a, b).
FaceShape triangle6(double a, double b) {
  const double c = 1 - a - b;
  return {{c * (2 * c - 1), a * (2 * a - 1), b * (2 * b - 1), 4 * c * a, 4 * a * b, 4 * b * c},
          {1 - 4 * c, 4 * a - 1, 0, 4 * (c - a), 4 * b, -4 * b},
          {1 - 4 * c, 0, 4 * b - 1, -4 * a, 4 * a, 4 * (c - b)}};
}

constexpr std::array<double, 8> corner_a{-1, 1, 1, -1}, corner_b{-1, -1, 1, 1};

// N_i = (1 + a a_i) (1 + b b_i) / 4
FaceShape quadrilateral4(double a, double b) {
  FaceShape shape;
  for (int i = 0; i < 4; ++i) {
    shape.value[i] = 0.25 * (1 + a * corner_a[i]) * (1 + b * corner_b[i]);
    shape.along_a[i] = 0.25 * corner_a[i] * (1 + b * corner_b[i]);
    shape.along_b[i] = 0.25 * corner_b[i] * (1 + a * corner_a[i]);
  }
  return shape;
}

// Corners (1 + a a_i)(1 + b b_i)(a a_i + b b_i - 1) / 4; midsides (1 - a^2)(1 + b b_i) / 2 and (1 + a a_i)(1 - b^2)
// / 2.
FaceShape quadrilateral8(double a, double b) {
  FaceShape shape;
  for (int i = 0; i < 4; ++i) {
    const double ai = corner_a[i], bi = corner_b[i];
    shape.value[i] = 0.25 * (1 + a * ai) * (1 + b * bi) * (a * ai + b * bi - 1);
    shape.along_a[i] = 0.25 * ai * (1 + b * bi) * (2 * a * ai + b * bi);
    shape.along_b[i] = 0.25 * bi * (1 + a * ai) * (a * ai + 2 * b * bi);
  }
  for (const int i : {4, 6}) {  // at b = -1 and b = 1
    const double bi = i == 4 ? -1 : 1;
    shape.value[i] = 0.5 * (1 - a * a) * (1 + b * bi);
    shape.along_a[i] = -a * (1 + b * bi);
    shape.along_b[i] = 0.5 * (1 - a * a) * bi;
  }
  for (const int i : {5, 7}) {  // at a = 1 and a = -1
    const double ai = i == 5 ? 1 : -1;
    shape.value[i] = 0.5 * (1 + a * ai) * (1 - b * b);
    shape.along_a[i] = 0.5 * ai * (1 - b * b);
    shape.along_b[i] = -b * (1 + a * ai);
  }
  return shape;
}

}  // namespace

FaceShape face_shape(int n_nodes, double a, double b) {
  switch (n_nodes) {
    case 3:
      return triangle3(a, b);
    case 4:
      return quadrilateral4(a, b);
    case 6:
      return triangle6(a, b);
    default:
      assert(n_nodes == 8);
      return quadrilateral8(a, b);
  }
}

}  // namespace couplet::coupling
