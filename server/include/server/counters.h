// The server's counters. Bytes from outside are accepted or counted here, never asserted.
#pragma once

#include <cstdint>
#include <string>

#include "cabinet/rod_input.h"
#include "server/histogram.h"

namespace server {

// Connections and messages on the control port.
struct ControlCounters {
  std::uint64_t accepted = 0;  // connections
  std::uint64_t joined = 0;
  std::uint64_t left = 0;
  std::uint64_t refused = 0;       // wrong version or layout, team taken, or server full
  std::uint64_t bad_messages = 0;  // unreadable, truncated, or out of sequence
  std::uint64_t timed_out = 0;     // no Hello in time
  std::uint64_t gave_up = 0;       // disconnected before their Hello was answered
  std::uint64_t slow_dropped = 0;  // did not read what the server sent
  std::uint64_t crowded_out = 0;   // dropped before joining to make room for newer connections
  std::uint64_t wrong_passwords = 0;
  std::uint64_t lost = 0;              // players whose seat was reserved
  std::uint64_t resumed = 0;           // of these, players who returned to their seat
  std::uint64_t requests = 0;          // passed on to the match
  std::uint64_t requests_dropped = 0;  // not allowed, or too many
  std::uint64_t answers = 0;           // to the questionnaire, passed on to the results
  std::uint64_t answers_refused = 0;   // from players who were not asked or had already answered
  std::uint64_t kicked = 0;            // players removed from a match
};

// Datagrams on the input port.
struct InputCounters {
  std::uint64_t accepted = 0;
  std::uint64_t bad = 0;      // not an input datagram: length, seal, checksum, range
  std::uint64_t foreign = 0;  // not from a player's address, or sealed with another key
  std::uint64_t stale = 0;    // not newer than the last accepted one: late, duplicated or replayed
};

// Connections and messages on the port for phones.
struct PhoneCounters {
  std::uint64_t accepted = 0;  // connections
  std::uint64_t pages = 0;     // served
  std::uint64_t joined = 0;    // phones that sent a hello; each connection counts
  std::uint64_t refused = 0;   // without the token, or no capacity left
  std::uint64_t bad_messages = 0;
  std::uint64_t timed_out = 0;     // no hello in time
  std::uint64_t crowded_out = 0;   // dropped before joining to make room for newer connections
  std::uint64_t slow_dropped = 0;  // did not read what the server sent
  std::uint64_t inputs = 0;        // passed on to the tick
  std::uint64_t inputs_dropped = 0;
  std::uint64_t pulses = 0;  // sent to phones
  std::uint64_t pulses_dropped = 0;
};

struct Counters {
  std::uint64_t ticks = 0;
  std::uint64_t snapshots_sent = 0;  // datagrams to all listeners
  std::uint64_t snapshot_bytes = 0;
  std::uint64_t send_errors = 0;
  int last_send_error = 0;                 // errno
  std::uint64_t events_dropped = 0;        // did not fit into the snapshots
  std::uint64_t match_events_dropped = 0;  // did not fit into their tick
  std::uint64_t journal_bytes = 0;
  std::uint64_t journal_dropped = 0;  // entries missing from the journal: a lower bound
  std::uint64_t results_kept = 0;     // matches stored in the results file
  std::uint64_t answers_kept = 0;     // questionnaires of players stored there
  InputCounters input;
  ControlCounters control;
  PhoneCounters phones;
  std::uint64_t haptic_pulses = 0;  // for hits, after limiting; to whoever controls the rod
};

struct DeviceCounters {
  std::string name;
  cabinet::SourceCounters counters;
};

// Statistics of the sender thread: one value [ns] for each tick with listeners.
struct SendStats {
  Histogram cost;     // handing a snapshot to the kernel for every listener
  Histogram to_wire;  // from the start of the tick to the end of that
};

}  // namespace server
