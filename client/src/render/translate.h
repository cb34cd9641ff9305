// The game's sentences in the person's language: GNU gettext, domain "space-foosball".
#pragma once

#include <string>

namespace client {

// "" as the system says, else "en", "ko", "de". directory: where the catalogues are. Takes effect
// for every tr() from now on. Main thread, before or between frames.
void use_language(const std::string& code, const std::string& directory);
// The sentence in that language, or as it is. The pointer stays good until the language changes.
const char* tr(const char* english);
// Of the language in use: its catalogue's file, or empty for English.
std::string catalogue_file();

// For xgettext alone: a sentence that tr() is called on elsewhere.
#define N_(english) english

}  // namespace client
