#pragma once
// The named results of a scene, found from the columns of its history.

#include "couplet/v1/output.pb.h"
#include "proto/store/summary.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::store {

/// One quantity. Samples need not be equally spaced. Throws NumericsError when the history is too short for it.
SummaryQuantity derive_quantity(const v1::Quantity& quantity, const Table& history);

}  // namespace couplet::store
