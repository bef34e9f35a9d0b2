#include "proto/report/version.hpp"

namespace couplet::report {

std::string version() {
  return COUPLET_VERSION;
}
std::string commit() {
  return COUPLET_COMMIT;
}
std::string compiler() {
  return COUPLET_COMPILER;
}

}  // namespace couplet::report
