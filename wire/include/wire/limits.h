// How many of each thing the messages may name. The decoders refuse what lies beyond, so a receiver
// may index its own tables with what it was sent. They mirror foosball's and cabinet's
// enumerations, which wire does not know; the server, which knows both, asserts that they agree.
#pragma once

namespace wire {

inline constexpr unsigned kTeamCount = 2;
inline constexpr unsigned kLayoutCount = 2;       // foosball::Layout
inline constexpr unsigned kScreenCount = 5;       // foosball::Screen
inline constexpr unsigned kCharacterCount = 3;    // foosball::CharacterSpec
inline constexpr unsigned kEventKindCount = 9;    // foosball::EventKind
inline constexpr unsigned kCommandKindCount = 4;  // foosball::Command::Kind
inline constexpr unsigned kMenOnRod = 5;
inline constexpr unsigned kRodStatusCount = 3;  // cabinet::RodStatus
inline constexpr unsigned kRodSourceCount = 5;  // RodSnapshot::source

}  // namespace wire
