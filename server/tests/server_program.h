// The server program, started by a test.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "process.h"

namespace server {

inline std::vector<std::string> serve(std::vector<std::string> options) {
  options.insert(options.begin(), SERVER_BINARY);
  return options;
}

inline std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// A server at any free port, which it writes to its log.
class RunningServer {
 public:
  explicit RunningServer(std::vector<std::string> options, const std::string& address = "127.0.0.1")
      : process_(with_port(options)) {
    const std::string said = "listening at " + address + ":";
    EXPECT_TRUE(process_.says(said) && process_.says("memory ")) << process_.output();
    const auto at = process_.output().find(said) + said.size();
    port_ = static_cast<std::uint16_t>(std::atoi(process_.output().c_str() + at));
  }
  std::uint16_t port() const { return port_; }
  Process* operator->() { return &process_; }

 private:
  static std::vector<std::string> with_port(std::vector<std::string> options) {
    options.insert(options.begin(), {SERVER_BINARY, "--port", "0"});
    return options;
  }
  Process process_;
  std::uint16_t port_ = 0;
};

// A server whose files cannot grow: to it the disk is full.
inline std::vector<std::string> on_a_full_disk(std::vector<std::string> options) {
  options = serve(std::move(options));
  options.insert(options.begin(),
                 {"/bin/bash", "-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\""});
  return options;
}

}  // namespace server
