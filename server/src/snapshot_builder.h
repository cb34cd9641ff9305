// From the match's view to the snapshot on the wire: the one place where they meet.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/match.h"
#include "wire/journal.h"
#include "wire/snapshot.h"

namespace server {

// All that the match's view says: poses and velocities of ball and men, rods, score, screen. The
// fields of the datagram itself, the rods' status and source and the events are left alone.
void build_snapshot(const foosball::MatchView& view, wire::Snapshot& snapshot);

// Who drives the rods of a replay: a rod that the recording moves is live, the others are held.
void put_replay_drivers(const wire::JournalTick& tick, wire::Snapshot& snapshot);

}  // namespace server
