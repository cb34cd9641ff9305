// Snapshots made up for tests and for looking at pictures: a plausible moment of play, with poses
// that follow from slides and angles as on the real table.
#pragma once

#include "foosball/table.h"
#include "wire/control.h"
#include "wire/snapshot.h"

namespace client {

// seconds: the moment; the ball runs, bounces and spins, rods slide and swing.
wire::Snapshot scripted_play(double seconds,
                             foosball::Layout layout = foosball::Layout::tournament);

// What a server says of its devices: a controller whose rods move, one that is away, a mouse.
wire::Devices scripted_devices(double seconds);

// Men's poses from the rods' slides and angles.
void place_men(wire::Snapshot& state);

}  // namespace client
