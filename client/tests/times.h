// Times [us].
#pragma once

#include <cstdint>

namespace client {

inline constexpr std::int64_t kSecond = 1'000'000, kFrame = 16'667;

}  // namespace client
