// The port for phones: a thread of its own that serves one page over HTTP and then speaks with it
// over a WebSocket (wire/phone_message.h). Each phone that has said hello is a client of the
// control port, by a pair of sockets inside this process: so it has a seat and a name in the
// roster, is voted on and put out, is missed and comes back as any other. Its inputs go to the tick
// through a queue that never waits, its pulses come back through another.
//
// Whoever knows the token in the URL may play, and nobody else is told more than a sentence. It is
// new at each start of the server, and goes to players' screens as a QR code. The line is not
// sealed (docs/phones.md says what that means).
//
// Boost.Beast on one io_context: see docs/decisions/0060-phones.md.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "phone_guest.h"
#include "server/counters.h"
#include "server/log.h"
#include "server/network.h"
#include "socket.h"
#include "vouched_connection.h"

namespace server {

// To the phones: a man of a rod that this client plays has hit the ball.
struct PhonePulseEvent {
  std::uint32_t client = 0;
  int rod = 0;                // on the table
  std::uint8_t strength = 0;  // 255: the most
  std::uint16_t ms = 0;
};

struct PhonePortOptions {
  std::string listen = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any free one
  PhoneLimits limits;
  foosball::Layout layout{};
  std::function<std::uint64_t()> random;  // the token; called by open()
  Log log;                                // called on the port's thread
};

class PhonePort {
 public:
  // Listens, and answers nobody before start().
  static tl::expected<std::unique_ptr<PhonePort>, SocketError> open(PhonePortOptions options);
  ~PhonePort();

  // http://HOST:PORT/TOKEN, at most wire::kMaxUrl bytes; HOST is the address of this machine that
  // others reach, as far as its routes tell.
  const std::string& url() const;
  std::uint16_t port() const;

  // adopt: takes a connection in, on the port's thread; false: try again later. It must be good
  // until stop() has returned.
  void start(std::function<bool(VouchedConnection&&)> adopt);
  // Lets what the phones are still to be told go out, 0.2 s at most, and ends the thread.
  void stop();

  // Tick thread: neither waits, nor takes memory.
  bool next_input(PhoneInputEvent& event);
  void pulse(const PhonePulseEvent& event);  // dropped and counted where 256 are waiting

  PhoneCounters counters() const;  // any thread

 private:
  struct Impl;
  explicit PhonePort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace server
