#pragma once
// What every pressure solver does alike: failures, and sums that do not depend on the number of ranks.

#include "flow-server/grid/block_decomposition.hpp"
#include "flow-server/grid/field.hpp"

namespace couplet::flow {

/// Throws NumericsError where the norm of the source, or of the residual at the start, is not a number.
void refuse_unless_finite(double norm);

/// Throws the NumericsError of a residual that is not a number or does not fall.
[[noreturn]] void refuse_residual(double residual, double at_start, int iterations, double wanted);

/// Throws the NumericsError of a residual that is still above the wanted one when the allowed iterations are used up.
[[noreturn]] void refuse_iterations(double residual, int iterations, double wanted);

/// A mean over all ranks to a 2^-46th of the norm: so that it hardly ever depends on the number of ranks in its last
/// digits. What is left of it is far below any residual that can be asked for.
double rounded_mean(double mean, double norm);

/// Ghosts beyond the borders of the whole become 0, in all layers that the field has.
void clear_ghosts_beyond_borders(const BlockDecomposition& decomposition, Field<double>& field);

}  // namespace couplet::flow
