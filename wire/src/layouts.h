// The list of each message's fields, and the hash that identifies it on the wire.
#pragma once

#include "layout.h"

namespace wire {

struct NamedLayout {
  const char* name;
  const char* meaning;
  Layout layout;
};

Layout snapshot_layout();
Layout input_layout();
Layout characters_layout();
// One for each kind of payload, and one for the ticks within a record of ticks.
std::vector<NamedLayout> journal_layouts();

// One for each message between a phone and the server.
std::vector<NamedLayout> phone_layouts();

// Hash over all of journal_layouts(); computed once.
std::uint32_t journal_layout_hash();

}  // namespace wire
