// The error type that a failed call returns. The engine throws nothing, prints nothing, exits
// never.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

namespace vp {

enum class Errc : std::uint8_t {
  invalid_argument,  // NaN, infinity, negative size, an id that no longer exists
  unsupported,       // well formed, but this version cannot simulate it
  singular,       // the equations have no unique solution, for instance a joint that moves no mass
  not_converged,  // an iteration or a step size control did not converge within its limits
  bad_data,       // bytes passed to restore() are not a snapshot of this world's version
};

struct Error {
  Errc code;
  std::string message;  // one sentence: what is wrong and what to do
};

template <class T>
using Expected = tl::expected<T, Error>;

}  // namespace vp
