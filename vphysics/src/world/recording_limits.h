// What a recording may hold, for the one who writes it and the one who reads it.
#pragma once

#include "world/recorded_call.h"

namespace vp::recording {

// Those that change the structure of the world; its digest follows them.
inline bool builds(const RecordedCall& call) {
  return call.what.index() <= RecordedCall::What(calls::DestroyJoint{}).index() ||
         std::holds_alternative<calls::SetMassFromColliders>(call.what);
}

}  // namespace vp::recording
