// How many of each thing the messages may name. The decoders refuse what lies beyond, so a receiver
// may index its own tables with what it was sent. They mirror foosball's and cabinet's
// enumerations, which wire does not know; the server, which knows both, asserts that they agree.
#pragma once

#include "wire/enums.h"

namespace wire {

inline constexpr unsigned kTeamCount = 2;
inline constexpr unsigned kLayoutCount = 2;  // foosball::Layout
inline constexpr unsigned kScreenCount = number(Screen::end) + 1;
inline constexpr unsigned kCharacterCount = 3;  // foosball::CharacterSpec
inline constexpr unsigned kEventKindCount = number(EventKind::match_won) + 1;
inline constexpr unsigned kCommandKindCount = number(WishKind::restart) + 1;
inline constexpr unsigned kMenOnRod = 5;
inline constexpr unsigned kRodStatusCount = number(RodStatus::held) + 1;
inline constexpr unsigned kRodSourceCount = number(RodSource::replay) + 1;

}  // namespace wire
