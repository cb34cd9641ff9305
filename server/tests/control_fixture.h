// Shared by the tests of the control port: a server in lockstep, and messages of a client.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lockstep.h"

namespace server {

using Code = wire::Refusal::Code;

inline std::vector<std::byte> bytes_of(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  return bytes;
}

inline std::string notice_of(ProbeClient& client) {
  return client.receive_a<wire::Notice>().value_or(wire::Notice{}).text;
}

}  // namespace server
