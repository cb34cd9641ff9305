#include "compile_cost.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <vector>

extern char** environ;

namespace vp::bench {
namespace {

struct Ended {
  int status;
  rusage used;
};

// Runs a program and waits for it. Discards its output; its errors go to our standard error.
tl::expected<Ended, std::string> run(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0)
    return tl::make_unexpected(words[0] + " could not be started: " + std::strerror(failed));
  Ended ended{};
  // The resources used by the child and its own children: a compiler's driver does little itself.
  if (wait4(child, &ended.status, 0, &ended.used) != child) {
    return tl::make_unexpected(words[0] + " could not be waited for");
  }
  return ended;
}

// A temporary folder, removed by the destructor.
class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "multibody-bench-XXXXXX").string();
    if (mkdtemp(name.data())) path_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

tl::expected<CompileCost, std::string> compile_cost() {
  const Scratch scratch;
  if (scratch.path().empty()) return tl::make_unexpected("no folder for the compiler's output");
  const std::string program = scratch.path() + "/user_program";
  // Other load on the machine only adds time: the fastest of three counts.
  CompileCost cost{std::numeric_limits<double>::infinity(), 0.0};
  for (int i = 0; i < 3; ++i) {
    const auto begun = std::chrono::steady_clock::now();
    const auto compiler = run({BENCH_CXX, "-std=c++20", "-O2", "-I" BENCH_INCLUDE,
                               BENCH_USER_PROGRAM, BENCH_LIBRARY, "-o", program});
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
    if (!compiler) return tl::make_unexpected(compiler.error());
    if (compiler->status != 0) {
      return tl::make_unexpected("a user's program does not compile: " BENCH_USER_PROGRAM);
    }
    cost.seconds = std::min(cost.seconds, took.count());
    cost.megabytes =
        std::max(cost.megabytes, static_cast<double>(compiler->used.ru_maxrss) / 1024.0);
  }
  const auto ran = run({program});
  if (!ran) return tl::make_unexpected(ran.error());
  if (ran->status != 0)
    return tl::make_unexpected(
        "a user's program compiles, but fails when it runs: " BENCH_USER_PROGRAM);
  return cost;
}

}  // namespace vp::bench
