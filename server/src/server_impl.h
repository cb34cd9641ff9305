// The server's parts and state. The code is split over server.cpp (inputs, outputs, public
// interface), server_seats.cpp (assignment of rods) and server_results.cpp (results, questionnaire,
// report).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "broadcaster.h"
#include "control_server.h"
#include "device_watch.h"
#include "event_repeater.h"
#include "haptic_desk.h"
#include "input_port.h"
#include "lineup.h"
#include "match_scribe.h"
#include "phone_port.h"
#include "recorder.h"
#include "results_log.h"
#include "rod_desk.h"
#include "server/game_choice.h"
#include "server/server.h"
#include "socket.h"

namespace server {

struct Server::Impl {
  Impl(ServerOptions&& given, foosball::Match&& made, PortPair&& opened, os::FileDescriptor&& wake,
       std::unique_ptr<Recorder>&& journal, std::unique_ptr<PhonePort>&& for_phones);

  void take_control_events();
  void admit(ControlEvent& event);
  void change_rods(ControlEvent& event);
  void change_name(const ControlEvent& event);
  void take_back(ControlEvent& event);
  void listen_to(ControlEvent& event);
  void dismiss(std::uint32_t client, bool put_out);
  void watch_absences();
  void wait_for_players(bool in_match);
  void remember_name(std::uint32_t client);
  void take_request(const ControlEvent& event);
  bool plays(std::uint32_t client) const;
  bool pause_is_abandoned() const;
  void take_phone_inputs(std::int64_t now_us);
  bool gather(std::int64_t now_us);
  void gather_live(std::int64_t now_us);
  void add_commands();
  void broadcast(std::int64_t now_us, std::int64_t tick_ns);
  void put_drivers(wire::Snapshot& out) const;
  void watch_journal();
  void keep_result();
  void keep_answers(const ControlEvent& event);
  void watch_results();
  void send_report();
  void begin_lineup();
  void count_players();
  MatchScribe::Players players() const;
  void tell_who_is_not_rated_as_the_team(const results::MatchResult& result);
  void watch_sending();
  void watch_tuning();
  void take_game(const wire::Game& asked);
  void watch_game();
  void show_devices(std::int64_t now_us);
  // An empty text clears the notice; then `over` goes to the log.
  void notify(Topic topic, const wire::Sentence& text, const std::string& over = {},
              std::uint32_t index = 0);
  ControlOptions control_options() const;

  using Name = std::array<char, wire::kMaxName + 1>;
  struct Client {
    std::uint32_t id;
    std::uint8_t team;
    RodSet rods;
    Name name;
    std::array<Name, foosball::kRods> players{};  // by rod; empty: same as name
    const Name& at(int rod) const { return players[rod][0] != 0 ? players[rod] : name; }
  };
  static wire::SealKey random_key(const std::function<std::uint64_t()>& random);

  ServerOptions options;
  const wire::SealKey group_key;  // of the multicast group
  const bool everywhere;          // listens at every address of this machine
  foosball::Match match;
  std::uint16_t port;
  os::FileDescriptor udp;
  InputPort input;
  Broadcaster broadcaster;
  RodDesk desk;
  std::unique_ptr<cabinet::HapticSink> cabinet_haptics;  // or none
  HapticDesk haptics;
  DeviceWatch device_watch;
  DeviceTable device_table;
  EventRepeater events;
  std::unique_ptr<Recorder> recorder;  // or none
  MatchScribe scribe;
  Lineup lineup;
  bool not_counted_reported = false, leavers_reported = false;  // active notices
  std::unique_ptr<ResultsLog> results;                          // or none
  std::uint32_t matches = 0;                                    // passed to it
  std::vector<Client> clients;
  std::uint64_t clients_ever = 0;
  std::int64_t tick_us = 0;                     // the clock at the current tick
  std::array<Name, foosball::kRods> had_rod{};  // last player of the rod, lost or left
  bool playing = false;                         // people have played since the last logo screen
  bool stand_ins_reported = false, offer_reported = false;  // active notices
  bool waiting = false;              // paused, since no player sends anything
  bool pause_outlasts_wait = false;  // somebody requested a pause meanwhile
  bool paused_by_watcher = false;    // by a host who only watches
  std::uint64_t ticks = 0;
  std::uint64_t sent_seen = 0, errors_seen = 0;
  bool sending_fails = false;
  std::optional<foosball::Tuning> sent_tuning;
  Opponent opponent;  // as last chosen
  std::optional<wire::Game> sent_game;
  bool replay_over = false, journal_failure_reported = false, finished = false;
  bool was_played = false;  // by people, not only by computers as a demonstration

  wire::JournalTick next;  // the inputs of the current tick
  wire::Snapshot snapshot;
  std::array<std::byte, wire::kMaxDatagram> datagram;
  std::unique_ptr<PhonePort> phones;  // or none; it passes connections to control
  ControlServer control;              // last: its thread ends first
};

}  // namespace server
