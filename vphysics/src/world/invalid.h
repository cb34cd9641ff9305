// Errors that rejected calls return.
#pragma once

#include <string>
#include <utility>

#include "vphysics/error.h"

namespace vp {

inline tl::unexpected<Error> invalid(Errc code, std::string message) {
  return tl::make_unexpected(Error{code, std::move(message)});
}
inline tl::unexpected<Error> invalid(std::string message) {
  return invalid(Errc::invalid_argument, std::move(message));
}
// call: the public call; what: the argument, such as "the body" or "body a".
inline tl::unexpected<Error> unknown_id(const char* call, const char* what) {
  return invalid(std::string(call) + ": " + what +
                 " does not exist (any more); keep the id that its creation returned");
}

}  // namespace vp
