#include "os/capabilities.h"

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdint>

namespace os {

bool drop_capabilities(bool keep_file_access) {
  __user_cap_header_struct head{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  if (::syscall(SYS_capget, &head, sets.data()) != 0) return false;
  const std::uint32_t kept = keep_file_access ? 1u << CAP_DAC_OVERRIDE : 0;
  sets[0].effective &= kept;
  sets[0].permitted &= kept;
  sets[0].inheritable = 0;
  sets[1] = {};
  const bool no_more = ::prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) == 0;
  // The ambient set follows the permitted one.
  return ::syscall(SYS_capset, &head, sets.data()) == 0 && no_more;
}

}  // namespace os
