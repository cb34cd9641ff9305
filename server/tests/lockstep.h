// A server whose ticks the test controls, with real sockets on loopback.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "probe_client.h"
#include "server/server.h"

namespace server {

// A folder of this process only, so that runs share no files. Removed when the process ends.
class TempFolder {
 public:
  TempFolder() {
    if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no folder " + path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    if (::getpid() == maker_) std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_ = testing::TempDir() + "sf_server_XXXXXX";
  ::pid_t maker_ = ::getpid();
};

inline std::string temp_path(const std::string& name) {
  static const TempFolder folder;
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  return folder.path() + "/" + test->test_suite_name() + "_" + test->name() + "_" + name;
}

class Lockstep {
 public:
  static constexpr std::uint64_t kSession = 0x5E5510;

  explicit Lockstep(const std::function<void(ServerOptions&)>& change = [](ServerOptions&) {}) {
    ServerOptions options;
    options.session = kSession;
    options.limits.seat_kept_us = 0;  // most tests leave without a Bye, for good
    options.random = [token = std::uint64_t{1000}]() mutable { return ++token; };
    options.log = [this](LogLevel, const std::string& text) {
      const std::lock_guard guard(mutex_);
      log_ += text + "\n";
    };
    change(options);
    auto made = Server::create(std::move(options));
    if (made) {
      server_ = std::move(*made);
    } else {
      error_ = made.error();
    }
  }

  // Throws the error sentence if the server did not start.
  Server& operator*() {
    if (!server_) throw std::runtime_error(error_.sentence);
    return *server_;
  }
  Server* operator->() { return &**this; }
  bool started() const { return server_ != nullptr; }
  const StartError& error() const { return error_; }
  std::uint16_t port() { return (*this)->port(); }
  std::int64_t now_us() const { return now_us_; }

  void tick(int count = 1) {
    for (int i = 0; i < count; ++i) {
      (*this)->tick(now_us_ += 1000);
      (*this)->wait_sent();
    }
  }
  // Ticks until the condition holds: for work that another thread must pass on first.
  bool tick_until(const std::function<bool()>& condition, int max_ms = 30000) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(max_ms);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > until) return false;
      tick();
    }
    return true;
  }
  // The same for work that the other thread does without ticks: simulated time stands still, on a
  // machine under any load.
  static bool wait_until(const std::function<bool()>& condition, int max_ms = 30000) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(max_ms);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > until) return false;
      std::this_thread::yield();
    }
    return true;
  }
  std::string log() {
    const std::lock_guard guard(mutex_);
    return log_;
  }

 private:
  std::mutex mutex_;
  std::string log_;
  StartError error_{};
  std::int64_t now_us_ = 1'000'000;
  std::unique_ptr<Server> server_;  // last: its threads log until it is destroyed
};

}  // namespace server
