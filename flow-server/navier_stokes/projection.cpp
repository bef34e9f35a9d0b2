#include "flow-server/navier_stokes/projection.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::flow {

namespace {

/// Measures row by row; the extremes of each column are kept so that the loops over x vectorise.
class RowMeasure {
 public:
  explicit RowMeasure(const FlowBlock& block)
      : block_(block), courant_(n()), speed_(n()), divergence_(n()), squares_(n()) {}

  template <bool three>
  void add(int begin, int end, int j, int k, const VectorField& velocity) {
    const double* __restrict inverse_width = block_.axis[0].inverse_width.from_zero();
    const double* __restrict width = block_.axis[0].width.from_zero();
    const double* u = velocity[0].row(j, k);
    const double* v = velocity[1].row(j, k);
    const double* v_south = velocity[1].row(j - 1, k);
    const double* w = three ? velocity[2].row(j, k) : nullptr;
    const double* w_bottom = three ? velocity[2].row(j, k - 1) : nullptr;
    const double y_over = block_.axis[1].inverse_width[j], z_over = block_.axis[2].inverse_width[k];
    const double area = block_.axis[1].width[j] * block_.axis[2].width[k];
    double* __restrict courant = courant_.data();
    double* __restrict speed = speed_.data();
    double* __restrict divergence = divergence_.data();
    double* __restrict squares = squares_.data();
#pragma GCC ivdep
    for (int i = begin; i < end; ++i) {
      double div = (u[i] - u[i - 1]) * inverse_width[i] + (v[i] - v_south[i]) * y_over;
      const double u_here = larger(std::abs(u[i]), std::abs(u[i - 1])),
                   v_here = larger(std::abs(v[i]), std::abs(v_south[i]));
      double rate = u_here * inverse_width[i] + v_here * y_over, square = u_here * u_here + v_here * v_here;
      if constexpr (three) {
        div += (w[i] - w_bottom[i]) * z_over;
        const double w_here = larger(std::abs(w[i]), std::abs(w_bottom[i]));
        rate += w_here * z_over;
        square += w_here * w_here;
      }
      courant[i] = larger(courant[i], rate);
      speed[i] = larger(speed[i], square);
      divergence[i] = larger(divergence[i], std::abs(div));
      squares[i] += area * width[i] * div * div;
    }
    volume_ += area * (block_.axis[0].face[end - 1] - block_.axis[0].face[begin - 1]);
  }

  FlowMeasure result() const {
    FlowMeasure all;
    for (std::size_t i = 0; i < courant_.size(); ++i) {
      all.courant_rate = std::max(all.courant_rate, courant_[i]);
      all.speed = std::max(all.speed, std::sqrt(speed_[i]));
      all.divergence = std::max(all.divergence, divergence_[i]);
      all.divergence_sum += squares_[i];
    }
    all.volume = volume_;
    return all;
  }

 private:
  std::size_t n() const {
    return static_cast<std::size_t>(block_.sizes[0]);
  }
  static double larger(double a, double b) {
    return a > b ? a : b;
  }

  const FlowBlock& block_;
  std::vector<double> courant_, speed_, divergence_, squares_;
  double volume_ = 0;
};

template <bool three>
FlowMeasure sweep(const FlowBlock& block, const ActiveCells& measured, double factor, const Field<double>* phi,
                  double viscous_factor, const Field<double>* source, const Field<double>* pressure,
                  Field<double>* new_pressure, VectorField* corrected, const VectorField& velocity) {
  RowMeasure rows(block);
  const double* __restrict x_over = block.axis[0].inverse_control_width.from_zero();
  for (int k = three && phi ? -1 : 0; k < block.sizes[2]; ++k) {
    for (int j = phi ? -1 : 0; j < block.sizes[1]; ++j) {
      if (phi) {
        const double* __restrict here = phi->row(j, k);
        for_each_interval(block.faces[0], j, k, -1, block.sizes[0], [&](int begin, int end) {
          double* __restrict u = (*corrected)[0].row(j, k);
#pragma GCC ivdep
          for (int i = begin; i < end; ++i) u[i] -= factor * x_over[i] * (here[i + 1] - here[i]);
        });
        for_each_interval(block.faces[1], j, k, 0, block.sizes[0], [&](int begin, int end) {
          double* __restrict v = (*corrected)[1].row(j, k);
          const double* __restrict north = phi->row(j + 1, k);
          const double over = factor * block.axis[1].inverse_control_width[j];
#pragma GCC ivdep
          for (int i = begin; i < end; ++i) v[i] -= over * (north[i] - here[i]);
        });
        if constexpr (three)
          for_each_interval(block.faces[2], j, k, 0, block.sizes[0], [&](int begin, int end) {
            double* __restrict w = (*corrected)[2].row(j, k);
            const double* __restrict top = phi->row(j, k + 1);
            const double over = factor * block.axis[2].inverse_control_width[k];
#pragma GCC ivdep
            for (int i = begin; i < end; ++i) w[i] -= over * (top[i] - here[i]);
          });
      }
      for_each_interval(block.cells, j, k, 0, block.sizes[0], [&](int begin, int end) {
        if (phi) {
          const double* __restrict increment = phi->row(j, k);
          const double* __restrict div = source->row(j, k);
          const double* __restrict before = pressure->row(j, k);
          double* __restrict after = new_pressure->row(j, k);
          if (viscous_factor == 0) {
#pragma GCC ivdep
            for (int i = begin; i < end; ++i) after[i] = before[i] + increment[i];
          } else {
#pragma GCC ivdep
            for (int i = begin; i < end; ++i) after[i] = before[i] + increment[i] - viscous_factor * div[i];
          }
        }
      });
      for_each_interval(measured, j, k, 0, block.sizes[0],
                        [&](int begin, int end) { rows.add<three>(begin, end, j, k, velocity); });
    }
  }
  return rows.result();
}

}  // namespace

double FlowMeasure::divergence_rms() const {
  return volume > 0 ? std::sqrt(divergence_sum / volume) : 0;
}

void take_divergence(const FlowBlock& block, const Box& part, double factor, const VectorField& velocity,
                     Field<double>& source) {
  const double* __restrict inverse_width = block.axis[0].inverse_width.from_zero();
  const bool three = block.n_dimensions == 3;
  for (int k = part.begin[2]; k < part.end[2]; ++k)
    for (int j = part.begin[1]; j < part.end[1]; ++j)
      for_each_interval(block.cells, j, k, part.begin[0], part.end[0], [&](int begin, int end) {
        const double* __restrict u = velocity[0].row(j, k);
        const double* __restrict v = velocity[1].row(j, k);
        const double* __restrict v_south = velocity[1].row(j - 1, k);
        double* __restrict out = source.row(j, k);
        const double y_over = block.axis[1].inverse_width[j];
        if (three) {
          const double* __restrict w = velocity[2].row(j, k);
          const double* __restrict w_bottom = velocity[2].row(j, k - 1);
          const double z_over = block.axis[2].inverse_width[k];
#pragma GCC ivdep
          for (int i = begin; i < end; ++i)
            out[i] = factor * ((u[i] - u[i - 1]) * inverse_width[i] + (v[i] - v_south[i]) * y_over +
                               (w[i] - w_bottom[i]) * z_over);
        } else {
#pragma GCC ivdep
          for (int i = begin; i < end; ++i)
            out[i] = factor * ((u[i] - u[i - 1]) * inverse_width[i] + (v[i] - v_south[i]) * y_over);
        }
      });
}

FlowMeasure correct(const FlowBlock& block, const ActiveCells& measured, double factor, const Field<double>& phi,
                    double viscous_factor, const Field<double>& source, const Field<double>& pressure,
                    Field<double>& new_pressure, VectorField& velocity) {
  const auto run = block.n_dimensions == 3 ? sweep<true> : sweep<false>;
  return run(block, measured, factor, &phi, viscous_factor, &source, &pressure, &new_pressure, &velocity, velocity);
}

FlowMeasure measure(const FlowBlock& block, const ActiveCells& measured, const VectorField& velocity) {
  const auto run = block.n_dimensions == 3 ? sweep<true> : sweep<false>;
  return run(block, measured, 0, nullptr, 0, nullptr, nullptr, nullptr, nullptr, velocity);
}

FlowMeasure reduce(const FlowMeasure& mine, MPI_Comm communicator) {
  std::array<double, 4> largest{mine.courant_rate, mine.speed, mine.divergence, mine.leaving};
  std::array<double, 2> sums{mine.divergence_sum, mine.volume};
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), 4, MPI_DOUBLE, MPI_MAX, communicator);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 2, MPI_DOUBLE, MPI_SUM, communicator);
  return {largest[0], largest[1], largest[2], sums[0], sums[1], largest[3]};
}

}  // namespace couplet::flow
