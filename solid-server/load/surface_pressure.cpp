#include "solid-server/load/surface_pressure.hpp"

#include "solid-server/element/lane_transpose.hpp"

namespace couplet::solid {

namespace {

template <int n_nodes, int n_points>
void force_of_packs(const FacePacks& faces, Index first, Index last, double pressure, const double* displacement,
                    StoredPack* force) {
  for (Index p = first; p < last; ++p) {
    const Index* start = &faces.node_start[static_cast<std::size_t>(p) * n_nodes * n_lanes];
    const StoredPack* position = &faces.position[static_cast<std::size_t>(p) * n_nodes * 3];
    Pack x[n_nodes][3], f[n_nodes][3]{};
    for (int a = 0; a < n_nodes; ++a) {
      load_nodes(displacement, start + a * n_lanes, x[a][0], x[a][1], x[a][2]);
      for (int i = 0; i < 3; ++i) x[a][i] += load(position[3 * a + i]);
    }
    for (int q = 0; q < n_points; ++q) {
      Pack t[2][3]{};  // tangents x,xi and x,eta
      for (int a = 0; a < n_nodes; ++a)
        for (int k = 0; k < 2; ++k)
          for (int i = 0; i < 3; ++i) t[k][i] += x[a][i] * faces.gradient[q][a][k];
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        const Pack push = (-pressure * faces.weight[q]) * (t[0][j] * t[1][l] - t[0][l] * t[1][j]);
        for (int a = 0; a < n_nodes; ++a) f[a][i] += push * faces.shape[q][a];
      }
    }
    StoredPack* out = force + static_cast<std::size_t>(p) * (4 * n_nodes);
    for (int a = 0; a < n_nodes; ++a) store_nodes(f[a][0], f[a][1], f[a][2], out + 4 * a);
  }
}

}  // namespace

void pressure_force(const FacePacks& faces, Index first, Index last, double pressure, const double* displacement,
                    StoredPack* force) {
  with_face_shape(faces, [&]<int n_nodes, int n_points>() {
    force_of_packs<n_nodes, n_points>(faces, first, last, pressure, displacement, force);
  });
}

}  // namespace couplet::solid
