// The port for phones: a thread that serves one page over HTTP and then exchanges messages with it
// over a WebSocket (wire/phone_message.h). Each phone that has sent a hello is a client of the
// control port, through a socket pair inside this process. It therefore has a seat and a name in
// the roster, can be voted on and removed, and can disconnect and resume, like any other client.
// Its inputs go to the tick through a queue that never blocks; its pulses return through another.
//
// Anyone who knows the token in the URL may play; others only get a sentence. The token is new at
// each start of the server, and players' screens show it as a QR code. The line is not sealed
// (docs/phones.md explains the consequences).
//
// Uses Boost.Beast on one io_context: see docs/decisions/0060-phones.md.
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

// To the phones: a man of one of this client's rods has hit the ball.
struct PhonePulseEvent {
  std::uint32_t client = 0;
  int rod = 0;                // index on the table
  std::uint8_t strength = 0;  // 255: max
  std::uint16_t ms = 0;
};

struct PhonePortOptions {
  std::string listen = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any free one
  PhoneLimits limits;
  foosball::Layout layout{};
  std::function<std::uint64_t()> random;  // for the token; called by open()
  Log log;                                // called on the port's thread
};

class PhonePort {
 public:
  // Listens, but does not answer before start().
  static tl::expected<std::unique_ptr<PhonePort>, SocketError> open(PhonePortOptions options);
  ~PhonePort();

  // http://HOST:PORT/TOKEN, at most wire::kMaxUrl bytes. HOST is the address of this machine that
  // others can reach, according to its routes.
  const std::string& url() const;
  std::uint16_t port() const;

  // adopt: takes over a connection, on the port's thread; false: retry later. It must be valid
  // until stop() has returned.
  void start(std::function<bool(VouchedConnection&&)> adopt);
  // Sends pending messages to the phones, for at most 0.2 s, and ends the thread.
  void stop();

  // Tick thread: these calls never block and never allocate.
  bool next_input(PhoneInputEvent& event);
  void pulse(const PhonePulseEvent& event);  // dropped and counted if 256 are pending

  PhoneCounters counters() const;  // any thread

 private:
  struct Impl;
  explicit PhonePort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace server
