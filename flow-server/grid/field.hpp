#pragma once
// One number a cell (or a face) of a block, with ghost layers.

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "flow-server/grid/box.hpp"

namespace couplet::flow {

/// Values on the cells 0 <= i < sizes()[0] and so on, and on `ghosts` more layers on both sides, in local indices; i
/// runs fastest. All values are 0 in the beginning. Memory that is never written to is never taken from the machine, so
/// that cells outside an active region cost next to nothing.
///
/// Velocity components live on faces: entry i of the x component is the face between the cells i and i + 1, so that all
/// components and the pressure have the same shape; entry -1 is the face at the start of the block.
template <class Number>
class Field {
 public:
  Field() = default;
  Field(const Triple& sizes, const Triple& ghosts) : sizes_(sizes), ghosts_(ghosts) {
    std::size_t n = 1;
    for (int d = 0; d < 3; ++d) n *= static_cast<std::size_t>(sizes[d] + 2 * ghosts[d]);
    stride_y_ = sizes[0] + 2 * ghosts[0];
    stride_z_ = stride_y_ * (sizes[1] + 2 * ghosts[1]);
    origin_ = ghosts[0] + ghosts[1] * stride_y_ + ghosts[2] * stride_z_;
    n_values_ = n;
    values_ = new_zeros(n);
  }

  const Triple& sizes() const { return sizes_; }
  const Triple& ghosts() const { return ghosts_; }
  std::ptrdiff_t stride_y() const { return stride_y_; }
  std::ptrdiff_t stride_z() const { return stride_z_; }
  bool is_empty() const { return !values_; }
  std::size_t n_values() const { return n_values_; }
  /// Memory taken from the machine: of large fields the pages that were touched.
  std::size_t n_bytes() const {
    const std::size_t n_mapped = values_ ? values_.get_deleter().n_mapped : 0;
    if (n_mapped == 0) return n_values_ * sizeof(Number);
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    std::vector<unsigned char> is_resident((n_mapped + page - 1) / page);
    if (mincore(values_.get(), n_mapped, is_resident.data()) != 0) return n_mapped;
    return page * static_cast<std::size_t>(std::count_if(is_resident.begin(), is_resident.end(),
                                                         [](unsigned char is) { return (is & 1u) != 0; }));
  }

  /// row(j, k)[i] is the value of cell (i, j, k).
  Number* row(int j, int k) { return values_.get() + origin_ + j * stride_y_ + k * stride_z_; }
  const Number* row(int j, int k) const { return values_.get() + origin_ + j * stride_y_ + k * stride_z_; }
  Number& operator()(int i, int j, int k) { return row(j, k)[i]; }
  const Number& operator()(int i, int j, int k) const { return row(j, k)[i]; }

  /// All values with ghosts, in memory order.
  Number* data() { return values_.get(); }
  const Number* data() const { return values_.get(); }

 private:
  struct Free {
    std::size_t n_mapped = 0;  // [byte]; 0: from the heap
    void operator()(Number* values) const {
      if (n_mapped > 0) {
        munmap(values, n_mapped);
      } else {
        std::free(values);
      }
    }
  };
  using Values = std::unique_ptr<Number[], Free>;

  /// Large blocks come as zero pages from the system; the heap would clear, and so touch, what it hands out again.
  static Values new_zeros(std::size_t n) {
    constexpr std::size_t large = 1 << 20;
    const std::size_t n_bytes = n * sizeof(Number);
    if (n_bytes < large) {
      Number* const values = static_cast<Number*>(std::calloc(n, sizeof(Number)));
      if (values == nullptr) throw std::bad_alloc();
      return Values(values);
    }
    void* const pages = mmap(nullptr, n_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return Values(static_cast<Number*>(pages), Free{n_bytes});
  }

  Triple sizes_{0, 0, 0}, ghosts_{0, 0, 0};
  std::ptrdiff_t stride_y_ = 0, stride_z_ = 0, origin_ = 0;
  std::size_t n_values_ = 0;
  Values values_;
};

/// One field a direction; in two dimensions the third is empty.
using VectorField = std::array<Field<double>, 3>;

}  // namespace couplet::flow
