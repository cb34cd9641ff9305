// Sentences that other programs and libraries say in English (the server's notices and refusals,
// what is wrong with a recording), in the person's language where they are known. Logs stay
// English.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace client {

// The sentence in the language in use; one that is not known as it is. A stranger's words may be
// part of it: they are kept as they are.
std::string tr_sentence(const std::string& english);

// The form with the words at its places %1 .. %9.
std::string filled(std::string_view form, const std::vector<std::string>& words);
// Who played, as results have it: a person's name as it is, "computer 4:gambler" and the like in
// the language in use.
std::string tr_player(const std::string& name);

}  // namespace client
