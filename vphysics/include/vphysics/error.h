// What a refused call returns. The engine throws nothing, prints nothing, exits never.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>

namespace vp {

enum class Errc : std::uint8_t {
  invalid_argument,  // NaN, infinity, negative size, an id that no longer exists
  unsupported,       // well formed, but not within what this version can simulate
  singular,          // the equations have no unique solution, as of a joint that moves no mass
  not_converged,     // an iteration or a step's control reached no answer within its limits
  bad_data,          // bytes handed to restore() are not a snapshot of this world's version
};

struct Error {
  Errc code;
  std::string message;  // one sentence: what is wrong and what to do
};

template <class T>
using Expected = tl::expected<T, Error>;

}  // namespace vp
