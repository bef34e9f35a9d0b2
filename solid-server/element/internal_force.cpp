#include "solid-server/element/internal_force.hpp"

#include "solid-server/element/packed_force.hpp"

namespace couplet::solid {

void note_softened(const ElementPacks& packs, Index p, const PackMask& is_stiff, ElementFindings& findings) {
  for (int lane = 0; lane < n_lanes; ++lane) {
    const Index element = packs.lane_element[static_cast<std::size_t>(p * n_lanes + lane)];
    if (is_stiff[lane] != 0 || element < 0) continue;  // a lane that fills up the last pack has no element
    if (findings.softened < 0 || element < findings.softened) findings.softened = element;
    ++findings.n_softened;
  }
}

ElementFindings internal_force(const ElementPacks& packs, const Material& material, Index first, Index last,
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
