// Synthetic snapshots for tests and preview pictures: a plausible moment of play, with poses
// computed from slides and angles as on the real table.
#pragma once

#include "foosball/table.h"
#include "wire/control.h"
#include "wire/snapshot.h"

namespace client {

inline constexpr std::uint64_t kScriptedSession = 1;  // of the snapshots

// seconds: the moment. The ball rolls, bounces and spins; rods slide and swing.
wire::Snapshot scripted_play(double seconds,
                             foosball::Layout layout = foosball::Layout::tournament);

// A server's device report: a controller whose rods move, an absent one, a mouse.
wire::Devices scripted_devices(double seconds);

// Computes the men's poses from the rods' slides and angles.
void place_men(wire::Snapshot& state);

}  // namespace client
