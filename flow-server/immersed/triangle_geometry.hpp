#pragma once
// Points, triangles and what follows from them.

#include <cmath>

#include "flow-server/boundary/space_time_value.hpp"

namespace couplet::flow {

inline Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point operator-(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Point operator*(double s, const Point& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Point& a) {
  return std::sqrt(dot(a, a));
}
inline double distance(const Point& a, const Point& b) {
  return length(b - a);
}

/// Normal times area of a triangle [m^2].
inline Point area_vector(const Point& a, const Point& b, const Point& c) {
  return 0.5 * cross(b - a, c - a);
}

}  // namespace couplet::flow
