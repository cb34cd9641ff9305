// Conversions between a match and its journal: rod targets and descriptions, in both directions.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/match.h"
#include "wire/journal.h"

namespace server {

// Every rod target enters the simulation through the journal's grid, so that live play and a replay
// use the same bits. Only a live rod follows its target; the others hold their position.
wire::JournalRod to_grid(const cabinet::RodInput& input);
wire::JournalRod to_grid(const foosball::RodTarget& target);
foosball::RodTarget from_grid(const wire::JournalRod& rod);

// For the same reason, a match is always made from its journal header.
wire::JournalHeader to_header(const foosball::MatchDesc& match);
foosball::MatchDesc from_header(const wire::JournalHeader& header);

wire::JournalCommand to_record(const foosball::Command& command);
foosball::Command from_record(const wire::JournalCommand& command);

}  // namespace server
