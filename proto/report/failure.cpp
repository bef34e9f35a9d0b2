#include "proto/report/failure.hpp"

#include <cstdio>
#include <exception>
#include <new>
#include <sstream>
#include <utility>

namespace couplet::report {

namespace {

std::string one_line(const std::string& where, const std::string& sentence, const std::string& advice) {
  std::string line = where.empty() ? sentence : where + ": " + sentence;
  if (!advice.empty()) line += "; " + advice;
  return line;
}

}  // namespace

int exit_code(FailureKind kind) {
  switch (kind) {
    case FailureKind::scene:
      return 2;
    case FailureKind::numerics:
      return 3;
    case FailureKind::peer:
      return 4;
    case FailureKind::file:
      return 5;
    case FailureKind::bug:
      return 70;
  }
  return 70;
}

Failure::Failure(FailureKind kind, std::string where, std::string sentence, std::string advice)
    : std::runtime_error(one_line(where, sentence, advice)),
      kind_(kind),
      where_(std::move(where)),
      sentence_(std::move(sentence)),
      advice_(std::move(advice)) {}

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

int run_program(const std::string& program, const std::function<int(int, char**)>& body, int argc, char** argv) {
  try {
    return body(argc, argv);
  } catch (const Failure& failure) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), failure.what());
    return exit_code(failure.kind());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "%s: out of memory; use a coarser mesh or fewer stored states\n", program.c_str());
    return exit_code(FailureKind::numerics);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "%s: this is a bug in Couplet: %s; please report it with the scene\n", program.c_str(),
                 fault.what());
    return exit_code(FailureKind::bug);
  }
}

}  // namespace couplet::report
