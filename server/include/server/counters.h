// What the server counts. Bytes from outside are never asserted, only accepted or counted here.
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
  std::uint64_t refused = 0;       // for version, layout, a taken team or a full house
  std::uint64_t bad_messages = 0;  // unreadable, cut short, or out of place
  std::uint64_t timed_out = 0;     // no Hello in time
  std::uint64_t gave_up = 0;       // had gone before their Hello was answered
  std::uint64_t slow_dropped = 0;  // did not read what was sent to them
  std::uint64_t crowded_out = 0;   // had to leave the door for newer ones
  std::uint64_t wrong_passwords = 0;
  std::uint64_t lost = 0;              // players whose seat was kept
  std::uint64_t resumed = 0;           // of these, who came back to it
  std::uint64_t requests = 0;          // handed on to the match
  std::uint64_t requests_dropped = 0;  // not allowed, or too many
  std::uint64_t answers = 0;           // to the questionnaire, handed on to the results
  std::uint64_t answers_refused = 0;   // from who was not asked, or had answered
  std::uint64_t kicked = 0;            // players put out of a match
};

// Datagrams on the input port.
struct InputCounters {
  std::uint64_t accepted = 0;
  std::uint64_t bad = 0;      // no input datagram: length, seal, checksum, range
  std::uint64_t foreign = 0;  // from no player's address, or under another's key
  std::uint64_t stale = 0;    // no newer than one accepted: late, or sent twice, or replayed
};

// Connections and messages on the port for phones.
struct PhoneCounters {
  std::uint64_t accepted = 0;  // connections
  std::uint64_t pages = 0;     // served
  std::uint64_t joined = 0;    // phones that said hello, each connection anew
  std::uint64_t refused = 0;   // without the token, or no room
  std::uint64_t bad_messages = 0;
  std::uint64_t timed_out = 0;     // no hello in time
  std::uint64_t crowded_out = 0;   // had to leave the door for newer ones
  std::uint64_t slow_dropped = 0;  // did not read what was sent to them
  std::uint64_t inputs = 0;        // handed to the tick
  std::uint64_t inputs_dropped = 0;
  std::uint64_t pulses = 0;  // sent to phones
  std::uint64_t pulses_dropped = 0;
};

struct Counters {
  std::uint64_t ticks = 0;
  std::uint64_t snapshots_sent = 0;  // datagrams, over all listeners
  std::uint64_t snapshot_bytes = 0;
  std::uint64_t send_errors = 0;
  int last_send_error = 0;                 // errno
  std::uint64_t events_dropped = 0;        // found no place in the snapshots
  std::uint64_t match_events_dropped = 0;  // found none in their tick
  std::uint64_t journal_bytes = 0;
  std::uint64_t journal_dropped = 0;  // entries that the journal lacks, at least
  std::uint64_t results_kept = 0;     // matches in the file of results
  std::uint64_t answers_kept = 0;     // players' sheets of the questionnaire there
  InputCounters input;
  ControlCounters control;
  PhoneCounters phones;
  std::uint64_t haptic_pulses = 0;  // of hits, as far as bounded; to whoever has the rod
};

struct DeviceCounters {
  std::string name;
  cabinet::SourceCounters counters;
};

// Of the thread that sends, one value a tick that had listeners [ns].
struct SendStats {
  Histogram cost;     // of handing a snapshot to the kernel for every listener
  Histogram to_wire;  // from the tick's beginning until that is done
};

}  // namespace server
