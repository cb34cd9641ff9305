// What events of the match look and sound like.
#pragma once

#include <span>

#include "render/particles.h"
#include "sound/player.h"
#include "wire/snapshot.h"

namespace client {

// sounds: null when there are none.
void show_events(std::span<const wire::EventSnapshot> events, Particles& particles,
                 SoundPlayer* sounds);

}  // namespace client
