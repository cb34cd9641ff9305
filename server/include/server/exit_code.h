// Exit codes of the programs of this room and of tools/.
#pragma once

namespace server {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed =
    1;  // a replay differs, a recording lacks its end, something failed
inline constexpr int kExitUsage = 2;  // an option or a file that cannot be used
inline constexpr int kExitPortTaken = 3;
inline constexpr int kExitCutShort =
    4;  // a recording without its end: all right as far as the file goes

}  // namespace server
