// A server for tests: real sockets on loopback; the test calls each step.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "os/file_descriptor.h"
#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/seal.h"
#include "wire/snapshot.h"

namespace client {

class ScriptedServer {
 public:
  explicit ScriptedServer(std::uint16_t port = 0);  // 0: any
  std::uint16_t port() const { return port_; }

  // Each waits for its event, at most kPatience; then returns false or nothing.
  static constexpr std::chrono::milliseconds kPatience{10'000};
  bool accept();
  void take_little();  // limits the receive buffer of the next clients
  std::optional<wire::ControlMessage> next_message();
  std::optional<wire::InputDatagram> next_input();
  void forget_inputs();  // drops the inputs that have arrived

  void send(const wire::ControlMessage& message);
  void send_bytes(std::span<const std::byte> bytes);
  void send_snapshot(const wire::Snapshot& snapshot);  // to the port of the client's Hello, sealed
  std::vector<std::byte> sealed(const wire::Snapshot& snapshot);
  void send_datagram(std::span<const std::byte> bytes);
  void drop_client();

  // Accepts, reads the Hello and answers with a Welcome; false if any of it fails.
  bool welcome(std::uint64_t session, std::uint64_t token = 11, std::uint8_t team = 0);
  const wire::Hello& hello() const { return hello_; }
  const wire::Welcome& said() const { return welcome_; }  // the last Welcome
  int udp() const { return udp_.get(); }

 private:
  os::FileDescriptor listener_, client_, udp_;
  std::uint16_t port_ = 0, udp_port_ = 0;
  wire::ControlReader reader_;
  wire::Hello hello_;
  wire::Welcome welcome_;
  wire::DatagramOpener inputs_;
  std::uint64_t sealed_ = 0;
  std::uint32_t welcomed_ = 0;
};

}  // namespace client
