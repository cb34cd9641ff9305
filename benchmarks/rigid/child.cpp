#include "child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <utility>

namespace rigid {
namespace {

using Clock = std::chrono::steady_clock;

bool is_answer(const std::string& word) {
  return word == "ready" || word == "cannot" || word == "more" || word == "end";
}

}  // namespace

tl::expected<Child, std::string> Child::start(const std::vector<std::string>& words,
                                              const std::string& log) {
  signal(SIGPIPE, SIG_IGN);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0) return tl::make_unexpected("no pipe");
  if (pipe2(from, O_CLOEXEC) != 0) {
    close(to[0]);
    close(to[1]);
    return tl::make_unexpected("no pipe");
  }
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0644);
  pid_t pid = -1;
  const int failed =
      posix_spawnp(&pid, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(to[0]);
  close(from[1]);
  if (failed != 0) {
    close(to[1]);
    close(from[0]);
    return tl::make_unexpected(words[0] + " could not be started: " + std::strerror(failed));
  }
  return Child(pid, to[1], from[0]);
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      to_(std::exchange(other.to_, -1)),
      from_(std::exchange(other.from_, -1)),
      received_(std::move(other.received_)) {}

Child& Child::operator=(Child&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(to_, other.to_);
  std::swap(from_, other.from_);
  std::swap(received_, other.received_);
  return *this;
}

Child::~Child() {
  end();
}

void Child::end() {
  if (to_ >= 0) close(std::exchange(to_, -1));
  if (from_ >= 0) close(std::exchange(from_, -1));
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(std::exchange(pid_, -1), nullptr, 0);
  }
}

// Call at the end of its output: it has ended or is about to.
std::string Child::how_it_ended() {
  int status = 0;
  waitpid(std::exchange(pid_, -1), &status, 0);
  if (WIFSIGNALED(status)) return fmt::format("crashed: {}", strsignal(WTERMSIG(status)));
  return fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

void Child::send(const std::string& line) {
  const std::string whole = line + "\n";
  // A failed write is ignored: receive() detects that the program has ended.
  [[maybe_unused]] const ssize_t written = write(to_, whole.data(), whole.size());
}

tl::expected<Answer, std::string> Child::receive(double seconds) {
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    for (std::size_t at; (at = received_.find('\n')) != std::string::npos;) {
      const std::string line = received_.substr(0, at);
      received_.erase(0, at + 1);
      const std::string word = line.substr(0, line.find(' '));
      if (is_answer(word)) return Answer{word, line.substr(std::min(line.size(), word.size() + 1))};
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now());
    pollfd poll_for{from_, POLLIN, 0};
    if (left.count() <= 0 || poll(&poll_for, 1, static_cast<int>(left.count())) == 0) {
      end();
      return tl::make_unexpected(fmt::format("gave no answer within {:.0f} s", seconds));
    }
    char bytes[512];
    const ssize_t got = read(from_, bytes, sizeof(bytes));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return tl::make_unexpected(how_it_ended());
    received_.append(bytes, static_cast<std::size_t>(got));
    if (received_.size() > 100000) received_.clear();  // a line of this length is no answer
  }
}

}  // namespace rigid
