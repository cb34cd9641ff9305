// Which calls build, for the writer and the reader of recordings.
#pragma once

#include "world/recorded_call.h"

namespace vp::recording {

// Calls that change the topology hash; the hash follows them in a recording. By code: the first
// calls, which build, and all from SetMotion on.
inline bool builds(const RecordedCall& call) {
  const std::size_t code = call.what.index();
  return code <= RecordedCall::What(calls::DestroyJoint{}).index() ||
         code == RecordedCall::What(calls::SetMassFromColliders{}).index() ||
         code >= RecordedCall::What(calls::SetMotion{}).index();
}

}  // namespace vp::recording
