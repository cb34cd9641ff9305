// The game's sentences in the person's language: GNU gettext, domain "space-foosball".
#pragma once

#include <string>

namespace client {

// "" as the system's, else "en", "ko", "de". directory: of the catalogues. Takes effect for every
// tr() from now on. Call on the main thread, before or between frames.
void use_language(const std::string& code, const std::string& directory);
// The sentence in that language, or unchanged. The pointer is valid until the language changes.
const char* tr(const char* english);
// The catalogue file of the language in use, or empty for English.
std::string catalogue_file();

// For xgettext only: marks a sentence that tr() translates elsewhere.
#define N_(english) english

}  // namespace client
