// Between a match and what is written about it: rod targets and descriptions, there and back.
#pragma once

#include "cabinet/rod_input.h"
#include "foosball/match.h"
#include "wire/journal.h"

namespace server {

// The one way of a target into the simulation: through the journal's grid, so that live play and
// replay feed it the same bits. Only a live rod follows its target; the others hold.
wire::JournalRod to_grid(const cabinet::RodInput& input);
wire::JournalRod to_grid(const foosball::RodTarget& target);
foosball::RodTarget from_grid(const wire::JournalRod& rod);

// A match is always made from its journal header, for the same reason.
wire::JournalHeader to_header(const foosball::MatchDesc& match);
foosball::MatchDesc from_header(const wire::JournalHeader& header);

wire::JournalCommand to_record(const foosball::Command& command);
foosball::Command from_record(const wire::JournalCommand& command);

}  // namespace server
