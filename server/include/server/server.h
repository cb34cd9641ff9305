// The physics server without its clock. Inputs: sources and clients. Outputs: one step of the
// match, journal and snapshots. The loop (server/loop.h) calls tick() 1000 times a second; a test
// calls it in lockstep. The number of ticks never depends on a clock.
//
// Threads: all functions are called on one thread, the tick thread. The control port, the sending
// of snapshots and the journal have their own threads inside. tick() never waits for them, for a
// socket or for the disk.
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
  bool cabinet = false;         // the server stands in a cabinet, whose players can change sides
  bool computer_fills = false;  // ... and its unassigned rods while people play the other ones
  // At the start; clients may choose another. The ladder and the challenge define their own.
  foosball::PlayerSpec computer_player{};
  NetworkOptions network;
  AccessOptions access;
  ControlLimits limits;
  PhoneOptions phones;
  bool haptics = true;        // haptics for cabinets and phones; clients have their own switch
  std::uint64_t session = 0;  // random, different at every start
  std::function<std::uint64_t()> random;  // for the clients' tokens; called from any thread
  std::string record;                     // a file, or empty
  bool overwrite = false;                 // of an existing recording
  // Automatic recording, at most this many bytes. Play goes on if the file fails, and the file is
  // removed at the end if nobody has played. 0: the recording was requested.
  std::uint64_t record_by_default_bytes = 0;
  // A results file (results/store.h) to which every match that is won or drawn is added, or empty.
  // Not used for a replay.
  std::string results;
  // The current date, as 2026-11-22T23:59:59Z, for results and for the challenge of the day; called
  // from any thread. None: neither exists.
  std::function<std::string()> date;
  // The day of the challenge, such as 20261122, overriding the date. 0: the day of the date, which
  // changes at midnight.
  std::uint32_t challenge_date = 0;
  bool questionnaire = true;         // with results: ask the players after each match
  bool await_client = false;         // the first tick waits until the first client has joined
  int send_priority = 0;             // real-time, of the snapshot sender thread; 0: not real-time
  std::unique_ptr<Playback> replay;  // plays this instead of the inputs of sources and clients
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
  ~Server();  // calls finish() if it was not called

  // Precondition: before the first tick. It allocates, and it would reassign rods.
  void add_device(std::unique_ptr<cabinet::Device> device);

  // The motors of the cabinet's rods. tick() sends them the pulses for rods that a device has.
  // Precondition: before the first tick.
  void set_cabinet_haptics(std::unique_ptr<cabinet::HapticSink> sink);

  // Steps the match by one millisecond. now_us: a monotonic clock, for devices and time stamps.
  void tick(std::int64_t now_us);

  // Waits until the kernel has every snapshot of the ticks so far. For tests, not for the loop.
  void wait_sent();

  // Shows a notice to all clients; replaces the notice of the same topic.
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
    devices = 100,  // + the device's index, as for the next one
    saturation = 150
  };
  void warn(Topic topic, const wire::Sentence& text);
  void clear(Topic topic, const std::string& text);

  // Sends Bye to the clients, then closes the journal and the results. Waits for them: up to 0.2 s
  // for the clients, and up to 4 s for the disk in each case.
  void finish(const wire::Sentence& reason);

  std::uint16_t port() const;
  std::string phones() const;  // where they join, http://HOST:PORT/TOKEN; empty: closed
  const foosball::Match& match() const;
  bool replay_over() const;             // nothing left to play
  const Playback* replay() const;       // or null
  int clients() const;                  // joined now, or with a reserved seat, as of the last tick
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
