#pragma once
// Vectors and numbers with their rates in time, so that the velocity of a constructed point is the exact rate of its
// place.

#include "flow-server/immersed/triangle_geometry.hpp"

namespace couplet::flow {

struct MovingNumber {
  double x;  // value
  double u;  // its rate
};

struct MovingPoint {
  Point x;  // value
  Point u;  // its rate
};

inline MovingNumber operator+(double a, const MovingNumber& b) {
  return {a + b.x, b.u};
}
inline MovingNumber inverse(const MovingNumber& a) {
  return {1 / a.x, -a.u / (a.x * a.x)};
}

inline MovingPoint operator+(const MovingPoint& a, const MovingPoint& b) {
  return {a.x + b.x, a.u + b.u};
}
inline MovingPoint operator-(const MovingPoint& a, const MovingPoint& b) {
  return {a.x - b.x, a.u - b.u};
}
inline MovingPoint operator*(double s, const MovingPoint& a) {
  return {s * a.x, s * a.u};
}
inline MovingPoint operator*(const MovingNumber& s, const MovingPoint& a) {
  return {s.x * a.x, s.u * a.x + s.x * a.u};
}
inline MovingNumber dot(const MovingPoint& a, const MovingPoint& b) {
  return {dot(a.x, b.x), dot(a.u, b.x) + dot(a.x, b.u)};
}
inline MovingPoint cross(const MovingPoint& a, const MovingPoint& b) {
  return {cross(a.x, b.x), cross(a.u, b.x) + cross(a.x, b.u)};
}

/// a / |a|; its rate is that of a across it, over its length.
inline MovingPoint unit(const MovingPoint& a) {
  const double inverse_length = 1 / length(a.x);
  const Point direction = inverse_length * a.x;
  return {direction, inverse_length * (a.u - dot(a.u, direction) * direction)};
}

}  // namespace couplet::flow
