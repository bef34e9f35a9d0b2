#include "solid-server/assembly/sparse_cholesky.hpp"

#include <cholmod.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "proto/report/failure.hpp"
#include "solid-server/assembly/machine_memory.hpp"

namespace couplet::solid {

namespace {

using Long = SuiteSparse_long;

/// The settings, work space and messages of CHOLMOD.
struct Session {
  cholmod_common common{};

  Session() {
    // CHOLMOD copies entries by four threads, however many cores there are; they wait awake and take the cores from
    // others.
    omp_set_max_active_levels(0);
    cholmod_l_start(&common);
    common.print = 0;
    common.nmethods = 2;
    common.method[0].ordering = CHOLMOD_AMD;
    common.method[1].ordering = CHOLMOD_METIS;
    common.quick_return_if_not_posdef = 1;
  }
  ~Session() { cholmod_l_finish(&common); }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

struct FreeFactor {
  cholmod_common* common;
  void operator()(cholmod_factor* factor) const { cholmod_l_free_factor(&factor, common); }
};
using Factor = std::unique_ptr<cholmod_factor, FreeFactor>;

struct FreeDense {
  cholmod_common* common;
  void operator()(cholmod_dense* dense) const { cholmod_l_free_dense(&dense, common); }
};
using Dense = std::unique_ptr<cholmod_dense, FreeDense>;

[[noreturn]] void refuse_singular() {
  throw SingularMatrix("linear system", "the tangent stiffness is singular",
                       "a part of a body is free to move or to turn without resistance: fix it, or give it mass by "
                       "a dynamic time integration; a single row of 20-node hexahedra needs points_per_element: 14");
}

}  // namespace

struct SparseCholesky::Parts {
  mutable Session session;
  std::vector<Index> unknown;       // of each node and component, -1 where it is held, (n_nodes, 3)
  std::vector<Long> start, row;     // the lower triangle in compressed columns
  std::vector<std::size_t> source;  // of each entry in the blocks
  std::vector<double> value;
  Factor definite{nullptr, {}}, indefinite{nullptr, {}};  // the second one is made when it is needed
  bool is_definite = true;
  int n_negative = 0;
  double n_operations = 0;
  std::size_t n_factor_entries = 0;

  Index n_unknowns() const { return static_cast<Index>(start.size()) - 1; }

  void number(const FreeComponents& free);
  void make_pattern(const NodePairs& pairs);
  cholmod_sparse matrix();
  void check_memory() const;
  bool factorise_definite();
  void factorise_indefinite();
  void count_negative();
};

void SparseCholesky::Parts::number(const FreeComponents& free) {
  Index n = 0;
  for (Eigen::Index place = 0; place < free.size(); ++place) unknown.push_back(free.data()[place] ? n++ : -1);
}

void SparseCholesky::Parts::make_pattern(const NodePairs& pairs) {
  const auto unknown_of = [&](Index node, std::size_t component) {
    return unknown[3 * static_cast<std::size_t>(node) + component];
  };
  start.push_back(0);
  for (Index column = 0; column < pairs.n_nodes(); ++column)
    for (std::size_t k = 0; k < 3; ++k) {
      if (unknown_of(column, k) < 0) continue;
      for (Index p = pairs.start[static_cast<std::size_t>(column)];
           p < pairs.start[static_cast<std::size_t>(column) + 1]; ++p) {
        const Index node = pairs.row[static_cast<std::size_t>(p)];
        for (std::size_t i = node == column ? k : 0; i < 3; ++i) {
          if (unknown_of(node, i) < 0) continue;
          row.push_back(unknown_of(node, i));
          source.push_back(9 * static_cast<std::size_t>(p) + 3 * i + k);
        }
      }
      start.push_back(static_cast<Long>(row.size()));
    }
  value.resize(row.size());
}

cholmod_sparse SparseCholesky::Parts::matrix() {
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(n_unknowns());
  matrix.nzmax = row.size();
  matrix.p = start.data();
  matrix.i = row.data();
  matrix.x = value.data();
  matrix.stype = -1;  // symmetric, the lower triangle is given
  matrix.itype = CHOLMOD_LONG;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
  return matrix;
}

void SparseCholesky::Parts::check_memory() const {
  const double factor_bytes = 8 * static_cast<double>(n_factor_entries);
  if (session.common.status != CHOLMOD_OUT_OF_MEMORY && session.common.status != CHOLMOD_TOO_LARGE &&
      factor_bytes < machine_memory())
    return;
  throw report::NumericsError("linear system",
                              "there is no memory for the factors of " + std::to_string(n_unknowns()) + " unknowns, " +
                                  report::text(1e-9 * factor_bytes) + " GB",
                              "take a coarser mesh, a larger machine, or the explicit central difference method");
}

bool SparseCholesky::Parts::factorise_definite() {
  cholmod_sparse A = matrix();
  cholmod_l_factorize(&A, definite.get(), &session.common);
  check_memory();
  // Supernodes only know a pivot that is not positive; one that is next to nothing shows in the smallest of them.
  is_definite = session.common.status == CHOLMOD_OK && cholmod_l_rcond(definite.get(), &session.common) > 1e-14;
  return is_definite;
}

void SparseCholesky::Parts::factorise_indefinite() {
  cholmod_sparse A = matrix();
  cholmod_common& common = session.common;
  const cholmod_common kept = common;
  common.supernodal = CHOLMOD_SIMPLICIAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  common.postorder = 0;
  if (!indefinite)
    indefinite = Factor(cholmod_l_analyze_p(&A, static_cast<Long*>(definite->Perm), nullptr, 0, &common), {&common});
  if (indefinite) cholmod_l_factorize(&A, indefinite.get(), &common);
  common.supernodal = kept.supernodal;
  common.nmethods = kept.nmethods;
  common.method[0].ordering = kept.method[0].ordering;
  common.postorder = kept.postorder;
  check_memory();
  if (!indefinite || common.status != CHOLMOD_OK) refuse_singular();
  count_negative();
}

/// From D, which stands at the start of each column of L.
void SparseCholesky::Parts::count_negative() {
  const auto* const first = static_cast<const Long*>(indefinite->p);
  const auto* const entry = static_cast<const double*>(indefinite->x);
  double largest = 0;
  for (std::size_t j = 0; j < indefinite->n; ++j) largest = std::max(largest, std::abs(entry[first[j]]));
  n_negative = 0;
  for (std::size_t j = 0; j < indefinite->n; ++j) {
    const double pivot = entry[first[j]];
    if (!(std::abs(pivot) > 1e-14 * largest)) refuse_singular();
    n_negative += pivot < 0;
  }
}

SparseCholesky::SparseCholesky(const NodePairs& pairs, const FreeComponents& free) : parts_(std::make_unique<Parts>()) {
  Parts& p = *parts_;
  p.number(free);
  p.make_pattern(pairs);
  cholmod_sparse A = p.matrix();
  p.session.common.supernodal = CHOLMOD_SUPERNODAL;
  p.definite = Factor(cholmod_l_analyze(&A, &p.session.common), {&p.session.common});
  p.n_operations = p.session.common.fl;
  p.n_factor_entries = static_cast<std::size_t>(std::max(0.0, p.session.common.lnz));
  p.check_memory();
}

SparseCholesky::~SparseCholesky() {
  parts_->definite.reset();  // before the session that they belong to
  parts_->indefinite.reset();
}

void SparseCholesky::factorise(const std::vector<double>& blocks) {
  Parts& p = *parts_;
  for (std::size_t n = 0; n < p.value.size(); ++n) p.value[n] = blocks[p.source[n]];
  if (!std::all_of(p.value.begin(), p.value.end(), [](double v) { return std::isfinite(v); }))
    throw report::NumericsError("linear system", "the tangent stiffness has an entry that is not a finite number",
                                "check the loads and the material; take smaller steps");
  p.n_negative = 0;
  if (!p.factorise_definite()) p.factorise_indefinite();
}

int SparseCholesky::n_negative_pivots() const {
  return parts_->n_negative;
}

NodeVectors SparseCholesky::solve(const NodeVectors& rhs) const {
  const Parts& p = *parts_;
  cholmod_common& common = p.session.common;
  const Dense b(cholmod_l_allocate_dense(static_cast<std::size_t>(p.n_unknowns()), 1,
                                         static_cast<std::size_t>(p.n_unknowns()), CHOLMOD_REAL, &common),
                {&common});
  p.check_memory();
  auto* const b_value = static_cast<double*>(b->x);
  for (std::size_t n = 0; n < p.unknown.size(); ++n)
    if (p.unknown[n] >= 0)
      b_value[p.unknown[n]] = rhs(static_cast<Eigen::Index>(n / 3), static_cast<Eigen::Index>(n % 3));
  const Dense x(cholmod_l_solve(CHOLMOD_A, (p.is_definite ? p.definite : p.indefinite).get(), b.get(), &common),
                {&common});
  p.check_memory();
  const auto* const x_value = static_cast<const double*>(x->x);
  NodeVectors solution = NodeVectors::Zero(rhs.rows(), 4);
  for (std::size_t n = 0; n < p.unknown.size(); ++n)
    if (p.unknown[n] >= 0)
      solution(static_cast<Eigen::Index>(n / 3), static_cast<Eigen::Index>(n % 3)) = x_value[p.unknown[n]];
  return solution;
}

Index SparseCholesky::n_unknowns() const {
  return parts_->n_unknowns();
}
double SparseCholesky::n_operations() const {
  return parts_->n_operations;
}
std::size_t SparseCholesky::n_factor_entries() const {
  return parts_->n_factor_entries;
}
std::size_t SparseCholesky::memory_bytes() const {
  const Parts& p = *parts_;
  return p.n_factor_entries * sizeof(double) + p.row.size() * (2 * sizeof(Long) + sizeof(double));
}

}  // namespace couplet::solid
