// Exit codes of the server's programs and of tools/.
#pragma once

namespace server {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed =
    1;  // a replay differs, a recording has no end record, or something failed
inline constexpr int kExitUsage = 2;  // an option or a file that cannot be used
inline constexpr int kExitPortTaken = 3;
inline constexpr int kExitCutShort =
    4;  // a recording without an end record: no difference up to the end of the file

}  // namespace server
