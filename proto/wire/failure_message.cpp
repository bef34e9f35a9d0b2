#include "proto/wire/failure_message.hpp"

#include <new>

#include "proto/report/failure.hpp"

namespace couplet::wire {

namespace {

v1::Failure::Kind kind_on_wire(report::FailureKind kind) {
  switch (kind) {
    case report::FailureKind::scene:
      return v1::Failure::SCENE;
    case report::FailureKind::numerics:
      return v1::Failure::NUMERICS;
    case report::FailureKind::peer:
      return v1::Failure::PEER;
    case report::FailureKind::file:
      return v1::Failure::FILE;
    case report::FailureKind::bug:
      return v1::Failure::BUG;
  }
  return v1::Failure::BUG;
}

v1::Failure make_failure(v1::Failure::Kind kind, const std::string& where, const std::string& sentence,
                         const std::string& advice) {
  v1::Failure failure;
  failure.set_kind(kind);
  failure.set_where(where);
  failure.set_sentence(sentence);
  failure.set_advice(advice);
  return failure;
}

}  // namespace

v1::Failure describe_failure(const std::exception_ptr& fault) {
  try {
    std::rethrow_exception(fault);
  } catch (const report::Failure& failure) {
    return make_failure(kind_on_wire(failure.kind()), failure.where(), failure.sentence(), failure.advice());
  } catch (const std::bad_alloc&) {
    return make_failure(v1::Failure::NUMERICS, "", "out of memory", "use a coarser mesh or fewer stored states");
  } catch (const std::exception& bug) {
    return make_failure(v1::Failure::BUG, "", std::string("this is a bug in Couplet: ") + bug.what(),
                        "please report it with the scene");
  } catch (...) {
    return make_failure(v1::Failure::BUG, "", "this is a bug in Couplet: an exception of unknown type",
                        "please report it with the scene");
  }
}

void throw_failure(const v1::Failure& failure, const std::string& whose) {
  const std::string where = failure.where().empty() ? whose : failure.where();
  switch (failure.kind()) {
    case v1::Failure::SCENE:
      throw report::SceneError(where, failure.sentence(), failure.advice());
    case v1::Failure::NUMERICS:
      throw report::NumericsError(where, failure.sentence(), failure.advice());
    case v1::Failure::PEER:
      throw report::PeerError(where, failure.sentence(), failure.advice());
    case v1::Failure::FILE:
      throw report::FileError(where, failure.sentence(), failure.advice());
    case v1::Failure::BUG:
    case v1::Failure::KIND_UNSPECIFIED:
      break;
  }
  throw report::Failure(report::FailureKind::bug, where, failure.sentence(), failure.advice());
}

}  // namespace couplet::wire
