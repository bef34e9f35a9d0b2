#include "solid-server/element/internal_force.hpp"

#include "solid-server/element/packed_force.hpp"

namespace couplet::solid {

Index internal_force(const ElementPacks& packs, const Material& material, Index first, Index last,
                     const double* displacement, StoredPack* force, StoredPack* energy) {
  const ForceRequest request{packs, first, last, displacement, force, energy};
  switch (packs.formulation) {
    case ElementFormulation::standard:
      return standard_force(request, material);
    case ElementFormulation::near_incompressible:
      return near_incompressible_force(request, material);
    case ElementFormulation::stabilised:
      return stabilised_force(request, material);
  }
  __builtin_unreachable();
}

}  // namespace couplet::solid
