#include "app/watch_program.h"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "os/file_descriptor.h"

namespace client {
namespace {

constexpr const char* kName = "space-foosball-watch";

}  // namespace

tl::expected<WatchProgram, std::string> WatchProgram::start(
    const std::vector<std::string>& options) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / kName).string();
  std::vector<std::string> words{program};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int failure =
      ::posix_spawn(&process, program.c_str(), nullptr, nullptr, arguments.data(), environ);
  if (failure != 0) {
    return tl::unexpected(program + " cannot be started (" + std::strerror(failure) +
                          "): build or install it with the game.");
  }
  return WatchProgram(process);
}

WatchProgram::WatchProgram(WatchProgram&& other) noexcept
    : process_(std::exchange(other.process_, -1)) {}

WatchProgram::~WatchProgram() {
  if (process_ < 0) return;
  constexpr int kPatienceMs = 2000;  // it may have a picture to finish
  // As a raw system call: Debian 12's <sys/pidfd.h> declares it without C linkage.
  const os::FileDescriptor process(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0)));
  ::kill(process_, SIGTERM);
  pollfd end{process.get(), POLLIN, 0};
  if (process) (void)::poll(&end, 1, kPatienceMs);
  if (!ended()) ::kill(process_, SIGKILL);
}

std::optional<int> WatchProgram::ended() {
  if (process_ < 0) return std::nullopt;
  int status = 0;
  pid_t waited = 0;
  do {
    waited = ::waitpid(process_, &status, WNOHANG);
  } while (waited < 0 && errno == EINTR);
  if (waited == 0) return std::nullopt;
  process_ = -1;
  return waited > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace client
