#pragma once
// The 20-node serendipity hexahedron: where its nodes stand and which of them make its faces. Node order of VTK's
// quadratic hexahedron: 8 corners, 4 edges of the bottom, 4 of the top, 4 upright.

#include <array>

namespace couplet::solid::hex20 {

constexpr int n_nodes = 20;
constexpr int n_faces = 6;
constexpr int n_face_nodes = 8;

/// Natural coordinates (xi, eta, zeta) of the nodes, each -1, 0 or 1.
constexpr std::array<std::array<int, 3>, n_nodes> node_coordinate = {{
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},  // bottom corners
    {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1},   // top corners
    {0, -1, -1},  {1, 0, -1},  {0, 1, -1}, {-1, 0, -1},  // bottom edges
    {0, -1, 1},   {1, 0, 1},   {0, 1, 1},  {-1, 0, 1},   // top edges
    {-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, 0},   // upright edges
}};

enum Side : int { xi_min, xi_max, eta_min, eta_max, zeta_min, zeta_max };

/// Nodes of each face: four corners, then the midside nodes between corners 0-1, 1-2, 2-3, 3-0. The right-hand normal
/// points out of the element.
constexpr std::array<std::array<int, n_face_nodes>, n_faces> face_node = {{
    {0, 4, 7, 3, 16, 15, 19, 11},  // xi = -1
    {1, 2, 6, 5, 9, 18, 13, 17},   // xi = +1
    {0, 1, 5, 4, 8, 17, 12, 16},   // eta = -1
    {3, 7, 6, 2, 19, 14, 18, 10},  // eta = +1
    {0, 3, 2, 1, 11, 10, 9, 8},    // zeta = -1
    {4, 5, 6, 7, 12, 13, 14, 15},  // zeta = +1
}};

}  // namespace couplet::solid::hex20
