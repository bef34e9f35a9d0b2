#include "solid-server/service/estimate_solid.hpp"

#include <cmath>

#include "solid-server/choose_time_method.hpp"
#include "solid-server/service/make_setup.hpp"
#include "solid-server/service/time_integration_warning.hpp"

namespace couplet::solid {

namespace {

const char* name_of(ElementFormulation formulation) {
  switch (formulation) {
    case ElementFormulation::standard:
      return "standard";
    case ElementFormulation::near_incompressible:
      return "near-incompressible";
    case ElementFormulation::stabilised:
      return "stabilised";
  }
  return "";
}

const char* name_of(TimeMethod method) {
  switch (method) {
    case TimeMethod::central_difference:
      return "CENTRAL_DIFFERENCE";
    case TimeMethod::generalized_alpha:
      return "GENERALIZED_ALPHA";
    case TimeMethod::static_equilibrium:
      return "STATIC";
  }
  return "";
}

/// "48 of hexahedron20, 8 points, standard" for each region.
void add_regions(const SolidSetup& setup, std::vector<participant::NamedNumber>& numbers) {
  for (std::size_t b = 0; b < setup.mesh.block.size(); ++b) {
    const ElementBlock& block = setup.mesh.block[b];
    const BlockProperties& properties = setup.properties[b];
    const std::string n_points =
        std::to_string(properties.n_points) + (properties.n_points == 1 ? " point" : " points");
    numbers.push_back({"elements_of" + (block.region.empty() ? std::string("_body") : "." + block.region), 0, "",
                       std::to_string(block.n_elements()) + " of " + topology(block.shape).name + ", " + n_points +
                           ", " + name_of(properties.formulation)});
  }
}

}  // namespace

std::vector<participant::NamedNumber> estimate_solid(const participant::OpenRequest& request, int threads) {
  SolidSetup setup = make_setup(request.scene.solid(), request.scene_folder);
  setup.n_threads = worthwhile_threads(threads, setup.mesh.n_elements());
  const double n_threads = setup.n_threads;
  const double step = request.scene.time().step(), n_steps = std::ceil(request.scene.time().end() / step);
  std::vector<participant::NamedNumber> numbers;
  TimeMethodChoice choice;
  if (request.scene.solid().time_integration().method() == v1::TimeIntegration::AUTO) {
    choice = choose_time_method(setup, step);
    setup.method = choice.method;
  }
  numbers.push_back({"time_integration", 0, "", choice.reason.empty() ? name_of(setup.method) : choice.reason});
  if (const std::string warning = time_integration_warning(request.scene, setup.method); !warning.empty())
    numbers.push_back({"warning", 0, "", warning});
  add_regions(setup, numbers);

  SolidModel model(std::move(setup));
  const SolidMesh& mesh = model.mesh();
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, double>>{
           {"elements", mesh.n_elements()},
           {"nodes", mesh.n_nodes()},
           {"degrees_of_freedom", model.n_free_components()},
           {"interface_nodes", static_cast<double>(model.wetted().solid_node.size())},
           {"memory_bytes", static_cast<double>(model.memory_bytes())},
           {"threads", n_threads}})
    numbers.push_back({name, value, "1"});
  if (choice.seconds_implicit > 0) {
    numbers.push_back({"seconds_per_explicit_step", choice.seconds_explicit, "s"});
    numbers.push_back({"seconds_per_implicit_step", choice.seconds_implicit, "s"});
  }
  const int n_substeps = model.n_substeps(step);
  numbers.push_back({"substeps_per_step", static_cast<double>(n_substeps), "1"});
  double seconds_per_step = 0;
  if (model.accepted().method == TimeMethod::central_difference) {
    const double seconds = seconds_of_substep(model, step);
    numbers.push_back({"stable_step", model.accepted().motion.estimate.stable_step, "s"});
    numbers.push_back({"seconds_per_substep", seconds, "s"});
    seconds_per_step = seconds * n_substeps;
  } else {
    seconds_per_step = n_substeps * seconds_of_implicit_substep(model, step);
    numbers.push_back({"seconds_per_step", seconds_per_step, "s"});
  }
  numbers.push_back({"seconds", seconds_per_step * n_steps, "s"});
  return numbers;
}

}  // namespace couplet::solid
