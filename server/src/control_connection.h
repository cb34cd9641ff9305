// One client's TCP connection on the control port: bytes in, messages cut, bytes out up to a cap.
// Who may say what is decided by ControlServer.
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
    greeting,  // Hello is due
    joined,
    closing,  // has been told why; what it still sends is thrown away
    dead,
  };

  ControlConnection(os::FileDescriptor socket, const os::SocketAddress& peer,
                    std::int64_t hello_deadline_us);

  // Reads what is there, at most a buffer full at a time, so that no client starves another.
  // False when the peer has gone, or its sealed stream is broken.
  bool receive();
  wire::ControlReader::Status next(wire::ControlMessage& message);
  // From what is sent and received next on, both ways are sealed.
  void seal(const wire::StreamKeys& keys);
  bool sealed() const { return opener_.has_value(); }
  // What came under the keys could not be opened, and nothing before: the password was another.
  bool wrong_password() const { return wrong_password_; }
  // False when more than cap bytes would wait to be sent: the peer does not read.
  bool send(const wire::ControlMessage& message, std::size_t cap);
  // False when the peer has gone.
  bool flush();
  // The peer has gone, or will say no more than what is still to be read.
  bool peer_left() const;
  // No more will be sent. Ends the connection towards the peer without cutting off what it has not
  // read yet; the deadline bounds the wait for its own end.
  void close_softly(std::int64_t deadline_us);
  bool wants_to_send() const { return sent_ < out_.size(); }
  std::size_t buffered_bytes() const { return out_.size(); }  // unsent, and some sent ones
  bool broke_off() const { return state == State::greeting && heard_; }

  int fd() const { return socket_.get(); }
  const os::SocketAddress& peer() const { return peer_; }
  // At which of this machine's addresses.
  os::SocketAddress heard_at() const;
  // Another port has let it in, and has this peer at that address. Its inputs do not come by UDP.
  void vouch(const os::SocketAddress& heard_at);
  bool vouched() const { return vouched_at_.has_value(); }

  State state = State::greeting;
  std::int64_t deadline_us;               // greeting, closing
  std::uint32_t client = 0;               // joined: whose seat it is
  wire::Role role = wire::Role::watcher;  // that the password gave, or this machine
  RequestAllowance requests;
  RateLimit device_queries{4, 20'000};
  bool awaits_devices = false;  // has asked
  bool try_charged = false;     // a password was tried, and is not known to be right
  bool unread = false;          // more waits to be sent than may: the server drops it

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
  bool heard_ = false;
  bool shut_when_sent_ = false;
};

}  // namespace server
