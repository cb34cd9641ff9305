// One client's TCP connection on the control port: reads bytes, splits them into messages, and
// sends bytes from a bounded buffer. ControlServer decides which messages are allowed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "request_rules.h"
#include "wire/control.h"
#include "wire/enums.h"
#include "wire/password_exchange.h"

namespace server {

class ControlConnection {
 public:
  enum class State : std::uint8_t {
    greeting,  // a Hello is due
    joined,
    closing,  // the reason was sent; further received data is discarded
    dead,
  };

  ControlConnection(os::FileDescriptor socket, const os::SocketAddress& peer,
                    std::int64_t hello_deadline_us);

  // Reads available data, at most one buffer per call, so that no client starves another. False if
  // the peer has disconnected, or its sealed stream is broken.
  bool receive();
  wire::ControlReader::Status next(wire::ControlMessage& message);
  // Seals both directions from the next byte sent and received.
  void seal(const wire::StreamKeys& keys);
  bool sealed() const { return opener_.has_value(); }
  // True if the first bytes under the keys could not be opened: the password was wrong.
  bool wrong_password() const { return wrong_password_; }
  // False if more than cap bytes would be pending: the peer does not read.
  bool send(const wire::ControlMessage& message, std::size_t cap);
  // False if the peer has disconnected.
  bool flush();
  // The peer has disconnected, or will send no more than what is still to be read.
  bool peer_left() const;
  // Half-close: no more will be sent. Does not cut off data that the peer has not read yet. The
  // deadline bounds the wait for the peer's end.
  void close_softly(std::int64_t deadline_us);
  bool wants_to_send() const { return sent_ < out_.size(); }
  std::size_t buffered_bytes() const { return out_.size(); }  // unsent bytes, and some sent ones
  bool broke_off() const { return state == State::greeting && received_; }

  int fd() const { return socket_.get(); }
  const os::SocketAddress& peer() const { return peer_; }
  // The local address that received the connection.
  os::SocketAddress local_address() const;
  // Another port has accepted this connection, at that address. Its inputs do not come by UDP.
  void vouch(const os::SocketAddress& local);
  bool vouched() const { return vouched_at_.has_value(); }

  State state = State::greeting;
  std::int64_t deadline_us;               // greeting, closing
  std::uint32_t client = 0;               // joined: owner of the seat
  wire::Role role = wire::Role::watcher;  // granted by the password or by this machine
  RequestAllowance requests;
  RateLimit device_queries{4, 20'000};
  bool awaits_devices = false;  // has sent a query
  bool try_charged = false;     // a password attempt was counted, and is not known to be right
  bool unread = false;          // pending data exceeds the limit: the server drops it

 private:
  void forget_sent();

  os::FileDescriptor socket_;
  os::SocketAddress peer_;
  std::optional<os::SocketAddress> vouched_at_;
  wire::ControlReader reader_;
  std::optional<wire::StreamOpener> opener_;
  std::optional<wire::StreamSealer> sealer_;
  bool opened_ = false, wrong_password_ = false;
  std::vector<std::byte> out_;
  std::size_t sent_ = 0;
  bool received_ = false;
  bool shut_when_sent_ = false;
};

}  // namespace server
