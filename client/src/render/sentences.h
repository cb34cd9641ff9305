// Translates sentences that other programs and libraries produce in English (the server's notices
// and refusals, errors of a recording), where they are known. Logs stay English.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace client {

// The sentence in the language in use; an unknown one is returned unchanged. It may contain text of
// other people, which stays unchanged.
std::string tr_sentence(const std::string& english);

// The pattern with the words at its placeholders %1 .. %9.
std::string filled(std::string_view form, const std::vector<std::string>& words);
// A player's name from the results: a person's name is unchanged, "computer 4:gambler" and the like
// are translated.
std::string tr_player(const std::string& name);

}  // namespace client
