#include "solid-server/element/packed_tangent.hpp"

#include "solid-server/element/tangent_sums.hpp"

namespace couplet::solid {

Index packed_tangent(const ElementPacks& packs, const Material& material, Index first, Index last,
                     const double* displacement, StoredPack* blocks, const double* increment) {
  const TangentRequest request{packs, first, last, displacement, increment, blocks};
  switch (packs.formulation) {
    case ElementFormulation::standard:
      return standard_tangent(request, material);
    case ElementFormulation::near_incompressible:
      return near_incompressible_tangent(request, material);
    case ElementFormulation::stabilised:
      return stabilised_tangent(request, material);
  }
  __builtin_unreachable();
}

}  // namespace couplet::solid
