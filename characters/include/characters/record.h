// Conversion between a character and its recorded and transmitted form (wire/characters.h).
#pragma once

#include <optional>

#include "foosball/character.h"
#include "wire/characters.h"

namespace characters {

wire::Characters to_record(const foosball::Characters& characters);

// Returns none if a number is out of range or a name is missing: external bytes never produce an
// unplayable character.
std::optional<foosball::Characters> from_record(const wire::Characters& record);

}  // namespace characters
