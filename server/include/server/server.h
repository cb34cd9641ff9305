// The physics server without its clock: sources and clients in, one step of the match, journal and
// snapshots out. tick() is called by the loop (server/loop.h) 1000 times a second, or by a test in
// lockstep: the number of ticks never depends on a clock.
//
// Threads: all is called on one thread, the tick's. The control port, the sending of snapshots and
// the journal have threads of their own inside; tick() never waits for them, for a socket or for
// the disk.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "cabinet/device.h"
#include "cabinet/haptics.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"
#include "server/counters.h"
#include "server/log.h"
#include "server/network.h"
#include "server/playback.h"
#include "wire/sentence.h"

namespace server {

struct ServerOptions {
  foosball::MatchDesc match;
  std::array<bool, foosball::kTeams> computer{};  // plays the team while no client has it
  bool cabinet = false;                           // stands here, whose players can change sides
  bool computer_fills = false;  // ... and its rods that nobody has while people have the others
  // At the start; clients may choose another. The ladder and the challenge have their own.
  foosball::PlayerSpec computer_player{};
  NetworkOptions network;
  AccessOptions access;
  ControlLimits limits;
  PhoneOptions phones;
  bool haptics =
      true;  // hands of cabinets and phones feel hits; clients have a switch of their own
  std::uint64_t session = 0;              // random, other at every start
  std::function<std::uint64_t()> random;  // for the clients' tokens; any thread
  std::string record;                     // a file, or empty
  bool overwrite = false;                 // the recording that is there already
  // Recorded without being asked: play goes on whatever becomes of the file, which is removed in
  // the end if nobody has played; it has at most so many bytes. 0: asked for.
  std::uint64_t record_by_default_bytes = 0;
  // A file of results (results/store.h) to which every match that was won or drawn is added, or
  // empty. Not of a replay.
  std::string results;
  // What date it is, as 2026-11-22T23:59:59Z, for results and for the challenge of the day; any
  // thread. None: then there are neither.
  std::function<std::string()> date;
  // The day of the challenge, such as 20261122, whatever date it is; 0: it is that of the date,
  // from midnight on that of the next.
  std::uint32_t challenge_date = 0;
  bool questionnaire = true;  // with results: asks who has played, after each match
  bool await_client = false;  // the first tick is when the first client has joined
  int send_priority = 0;      // real-time, of the thread that sends snapshots; 0: an ordinary one
  std::unique_ptr<Playback> replay;  // plays this instead of what sources and clients say
  Log log = [](LogLevel, const std::string&) {};
};

struct StartError {
  enum class Kind { bad_option, port_taken, failed };
  Kind kind;
  std::string sentence;  // what is wrong and what to do
};

class Server {
 public:
  static tl::expected<std::unique_ptr<Server>, StartError> create(ServerOptions options);
  ~Server();  // as finish(), if that was not called

  // Precondition: before the first tick. It takes memory, and rods would change hands.
  void add_device(std::unique_ptr<cabinet::Device> device);

  // The motors of the cabinet's rods: gets the pulses of those that a device has, from tick().
  // Precondition: before the first tick.
  void set_cabinet_haptics(std::unique_ptr<cabinet::HapticSink> sink);

  // One millisecond of the match. now_us: a monotonic clock, the one for devices and time stamps.
  void tick(std::int64_t now_us);

  // Until the kernel has every snapshot of the ticks so far. Not for the loop: for tests.
  void wait_sent();

  // Something all clients should read; replaces the notice of the same topic.
  enum class Topic : std::uint32_t {
    overload = 1,
    journal = 2,
    replay = 3,
    results = 4,
    sending = 5,
    stand_in = 6,
    offer = 7,
    not_counted = 8,
    waiting = 9,
    leavers = 10,
    devices = 100,  // + the device's index, as the next
    saturation = 150
  };
  void warn(Topic topic, const wire::Sentence& text);
  void clear(Topic topic, const std::string& text);

  // Says Bye to the clients and closes the journal and the results, waiting for them: up to 0.2 s,
  // and for the disk, up to 4 s each.
  void finish(const wire::Sentence& reason);

  std::uint16_t port() const;
  std::string phones() const;  // where they join, http://HOST:PORT/TOKEN; empty: nowhere
  const foosball::Match& match() const;
  bool replay_over() const;             // nothing more to play
  const Playback* replay() const;       // or null
  int clients() const;                  // joined now, or expected back, as the last tick saw it
  std::uint64_t clients_ever() const;   // joined so far
  std::uint64_t ticks() const;          // of the match
  std::string journal_problem() const;  // empty: none
  std::string results_problem() const;  // empty: none
  Counters counters() const;
  std::vector<DeviceCounters> devices() const;
  const SendStats& sending() const;  // precondition: finish() was called

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace server
