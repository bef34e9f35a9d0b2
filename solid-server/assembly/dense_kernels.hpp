#pragma once
// The dense kernels under the sparse factorisation: those of the processor that the program runs on.

#include <string_view>

namespace couplet::solid {

/// What OpenBLAS should be told to use instead of the kernels that it has `chosen` by itself, "" for nothing. A
/// processor that is newer than the library counts as a Pentium 4 ("Prescott"), although it has the instructions of
/// later ones.
std::string_view better_kernels(std::string_view chosen, bool has_avx2, bool has_avx512);

/// Starts the program once more, with `argv` and OPENBLAS_CORETYPE, where there are better kernels: OpenBLAS reads this
/// variable while it is loaded and has no other way. Factorisations are twice as fast then (OpenBLAS 0.3.21 on an Intel
/// Xeon of 2023, 64,000 unknowns: 4.2 s instead of 9.2). Does nothing when the variable is set, or with another BLAS.
/// To be called first of all.
void use_better_kernels(char** argv);

}  // namespace couplet::solid
