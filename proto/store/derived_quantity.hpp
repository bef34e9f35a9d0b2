#pragma once
// The named results of a scene, found from the columns of its history.

#include "couplet/v1/output.pb.h"
#include "proto/store/summary.hpp"
#include "proto/store/table_file.hpp"

namespace couplet::store {

/// One quantity, as output.proto defines it. Samples need not be equally spaced. Throws NumericsError when the history
/// does not hold it (fewer than three cycles, no spectral line, values that are not finite); a run then ends well
/// without this quantity. Throws SceneError listing the columns when a column does not exist.
SummaryQuantity derive_quantity(const v1::Quantity& quantity, const Table& history);

}  // namespace couplet::store
