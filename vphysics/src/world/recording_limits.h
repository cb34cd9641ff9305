// The calls that build a world, for the writer and the reader of recordings.
#pragma once

#include "world/recorded_call.h"

namespace vp::recording {

// Whether the call changes the topology hash. The hash follows such calls in a recording. Their
// codes: up to DestroyJoint, SetMassFromColliders, and all from SetMotion on.
inline bool builds(const RecordedCall& call) {
  const std::size_t code = call.what.index();
  return code <= RecordedCall::What(calls::DestroyJoint{}).index() ||
         code == RecordedCall::What(calls::SetMassFromColliders{}).index() ||
         code >= RecordedCall::What(calls::SetMotion{}).index();
}

}  // namespace vp::recording
