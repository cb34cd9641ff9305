// Converts the match's view to the wire snapshot. It is the only place that does.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/match.h"
#include "wire/journal.h"
#include "wire/snapshot.h"

namespace server {

// Fills everything that the match's view contains: poses and velocities of ball and men, rods,
// score, screen. Does not write the datagram's own fields, the rods' status and source, or the
// events.
void build_snapshot(const foosball::MatchView& view, wire::Snapshot& snapshot);

// Sets status and source of the rods of a replay: a rod that the recording moves is live, the
// others are held.
void put_replay_drivers(const wire::JournalTick& tick, wire::Snapshot& snapshot);

}  // namespace server
