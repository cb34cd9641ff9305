// Between a character and what is recorded and sent of it (wire/characters.h).
#pragma once

#include <optional>

#include "foosball/character.h"
#include "wire/characters.h"

namespace characters {

wire::Characters to_record(const foosball::Characters& characters);

// Nothing where a number is out of its range, or a name is missing: bytes from outside never make a
// character that cannot be played.
std::optional<foosball::Characters> from_record(const wire::Characters& record);

}  // namespace characters
