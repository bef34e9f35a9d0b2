#include "solid-server/service/make_material.hpp"

#include <numbers>

#include "proto/report/failure.hpp"

namespace couplet::solid {

Material make_material(const v1::Material& material, const std::string& where) {
  switch (material.law_case()) {
    case v1::Material::kSaintVenantKirchhoff:
      return SaintVenantKirchhoff::from_young(material.saint_venant_kirchhoff().young_modulus(),
                                              material.saint_venant_kirchhoff().poisson_ratio());
    case v1::Material::kMooneyRivlin:
      return MooneyRivlin{material.mooney_rivlin().a10(), material.mooney_rivlin().a01(),
                          material.mooney_rivlin().bulk_modulus()};
    case v1::Material::kNeoHookean:
      return NeoHookean{material.neo_hookean().shear_modulus(), material.neo_hookean().bulk_modulus()};
    case v1::Material::kHolzapfelGasserOgden: {
      const v1::HolzapfelGasserOgden& law = material.holzapfel_gasser_ogden();
      const HolzapfelGasserOgden along_axis{law.shear_modulus(), law.bulk_modulus(), law.k1(), law.k2(),
                                            law.dispersion()};
      return along_axis.with_fibres_at(law.fibre_angle() * std::numbers::pi / 180);
    }
    case v1::Material::kMayNewman: {
      const v1::MayNewman& law = material.may_newman();
      return MayNewman{law.c0(), law.c1(), law.c2(), law.matrix_shear_modulus(), law.bulk_modulus()};
    }
    case v1::Material::LAW_NOT_SET:
      break;
  }
  throw report::SceneError(where, "the material has no law", "give one, for example mooney_rivlin");
}

std::optional<FibreRule> make_fibre_rule(const v1::Fibres& fibres) {
  const auto vector = [](const v1::Vector& v) { return Eigen::Vector3d(v.x(), v.y(), v.z()); };
  if (fibres.has_constant())
    return ConstantFibres{vector(fibres.constant().along()), vector(fibres.constant().across())};
  if (fibres.has_circumferential())
    return CircumferentialFibres{vector(fibres.circumferential().point()), vector(fibres.circumferential().axis())};
  return std::nullopt;
}

}  // namespace couplet::solid
