// What a recording may hold, for the one who writes it and the one who reads it.
#pragma once

#include "world/recorded_call.h"

namespace vp::recording {

// Those that change the structure of the world; its digest follows them. By their codes: the first
// ones build, and all from SetMotion on.
inline bool builds(const RecordedCall& call) {
  const std::size_t code = call.what.index();
  return code <= RecordedCall::What(calls::DestroyJoint{}).index() ||
         code == RecordedCall::What(calls::SetMassFromColliders{}).index() ||
         code >= RecordedCall::What(calls::SetMotion{}).index();
}

}  // namespace vp::recording
