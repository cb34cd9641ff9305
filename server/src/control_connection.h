// One client's TCP connection on the control port: bytes in, messages cut, bytes out up to a cap.
// Who may say what is decided by ControlServer.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <string>
#include <vector>

#include "os/file_descriptor.h"
#include "wire/control.h"
#include "wish_rules.h"

namespace server {

class ControlConnection {
 public:
  enum class State : std::uint8_t {
    greeting,  // Hello is due
    joined,
    closing,  // has been told why; what it still sends is thrown away
    dead,
  };

  ControlConnection(os::FileDescriptor socket, const sockaddr_in& peer,
                    std::int64_t hello_deadline_us);

  // Reads what is there, at most a buffer full at a time, so that no client starves another.
  // False when the peer has gone.
  bool receive();
  wire::ControlReader::Status next(wire::ControlMessage& message);
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
  const sockaddr_in& peer() const { return peer_; }

  State state = State::greeting;
  std::int64_t deadline_us;  // greeting, closing
  std::uint32_t client = 0;  // joined
  std::uint8_t team = wire::kWatchOnly;
  std::string name;
  WishAllowance wishes;

 private:
  void forget_sent();

  os::FileDescriptor socket_;
  sockaddr_in peer_;
  wire::ControlReader reader_;
  std::vector<std::byte> out_;
  std::size_t sent_ = 0;
  bool heard_ = false;
  bool shut_when_sent_ = false;
};

}  // namespace server
