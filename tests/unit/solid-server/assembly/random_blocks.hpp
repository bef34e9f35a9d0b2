#pragma once
// Symmetric matrices of 3 x 3 blocks to factorise in tests.

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "solid-server/assembly/node_pairs.hpp"
#include "solid-server/support/free_components.hpp"

namespace couplet::solid {

/// Entries between -1 and 1, `diagonal` added on the diagonal.
inline std::vector<double> random_blocks(const NodePairs& pairs, double diagonal) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> between(-1, 1);
  std::vector<double> blocks(9 * static_cast<std::size_t>(pairs.n_pairs()));
  for (double& entry : blocks) entry = between(random);
  for (Index column = 0; column < pairs.n_nodes(); ++column) {
    double* block = &blocks[9 * static_cast<std::size_t>(pairs.start[static_cast<std::size_t>(column)])];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k <= i; ++k) block[3 * k + i] = block[3 * i + k] += i == k ? diagonal : 0;
  }
  return blocks;
}

/// The whole matrix, (3 n_nodes, 3 n_nodes); rows and columns of held components are those of the identity.
inline Eigen::MatrixXd dense(const NodePairs& pairs, const std::vector<double>& blocks, const FreeComponents& free) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * pairs.n_nodes(), 3 * pairs.n_nodes());
  for (Index column = 0; column < pairs.n_nodes(); ++column)
    for (Index p = pairs.start[static_cast<std::size_t>(column)]; p < pairs.start[static_cast<std::size_t>(column) + 1];
         ++p)
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
          const Index row = pairs.row[static_cast<std::size_t>(p)];
          if (free(row, i) && free(column, k))
            A(3 * row + i, 3 * column + k) = A(3 * column + k, 3 * row + i) =
                blocks[static_cast<std::size_t>(9 * p + 3 * i + k)];
        }
  for (Index n = 0; n < pairs.n_nodes(); ++n)
    for (int i = 0; i < 3; ++i)
      if (!free(n, i)) A(3 * n + i, 3 * n + i) = 1;
  return A;
}

}  // namespace couplet::solid
