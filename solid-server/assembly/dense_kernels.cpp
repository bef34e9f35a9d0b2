#include "solid-server/assembly/dense_kernels.hpp"

#include <dlfcn.h>
#include <unistd.h>
#include <cstdlib>
#include <filesystem>

namespace couplet::solid {

std::string_view better_kernels(std::string_view chosen, bool has_avx2, bool has_avx512) {
  if (chosen != "Prescott") return "";
  return has_avx512 ? "SkylakeX" : has_avx2 ? "Haswell" : "";
}

void use_better_kernels([[maybe_unused]] char** argv) {
#ifdef __x86_64__
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (std::getenv(variable)) return;
  // Not linked by name: the system may offer another BLAS at any time.
  const auto name_of_kernels = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  if (!name_of_kernels) return;
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  const std::string_view better = better_kernels(name_of_kernels(), has_avx2, has_avx512);
  if (better.empty()) return;
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  setenv(variable, better.data(), 1);  // a literal, so it ends with a zero
  execv(program.c_str(), argv);        // comes back only where it cannot be done: the slow kernels do as well
#endif
}

}  // namespace couplet::solid
