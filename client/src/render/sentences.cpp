#include "render/sentences.h"

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "render/translate.h"

namespace client {
namespace {

// %1 .. %9 stand for what changes, in their order; a translation may have them in another.
constexpr std::array kKnown{
    // notices of the server
    N_("%1 was lost: rods %2 are kept for %3 s"),
    N_("the computer plays rods %1 for %2"),
    N_("free to the team for 10 s, then the computer's: rods %1 for %2"),
    N_("%1 would put %2 out of the match: %3 of %4 votes"),
    N_("%1 is back: the vote to put them out of the match goes on"),
    N_("%1 asks for a pause: %2 of %3 votes. Ask for it too to agree"),
    N_("%1 asks for a restart: %2 of %3 votes. Ask for it too to agree"),
    N_("%1 asks for the game to go on: %2 of %3 votes. Ask for it too to agree"),
    N_("watchers have no vote"),
    N_("who you would put out has left"),
    N_("the host cannot be put out"),
    N_("one player alone puts nobody out: ask the host"),
    N_("you began a vote a moment ago: wait a minute"),
    N_("results in %1: %2; play goes on"),
    N_("the physics server cannot keep up: end other programs on its machine"),
    // why it refuses, or is not there
    N_("the host put you out of this match: join to watch, or play in the next"),
    N_("the players put you out of this match: join to watch, or play in the next"),
    N_("somebody at your machine was put out of this match: join to watch, or play in the next"),
    N_("the server is full: try again when somebody has left"),
    N_("no snapshot for %1 ms"),
    N_("it does not answer"),
    N_("it closed the connection"),
    // recordings
    N_("%1 is no recorded match (%2): choose a file that --record wrote"),
    N_("%1 is no recorded match: choose a file that --record wrote"),
    N_("%1: cannot be opened (%2); check its name and permissions."),
    N_("%1 holds the beginning of a match, but no tick of it: there is nothing to replay"),
};

using Words = std::vector<std::string_view>;

// What stands at %1, %2 ... if the sentence is of this form. The shortest that fit.
std::optional<Words> words_in(std::string_view sentence, std::string_view form) {
  Words words;
  std::size_t at = form.find('%');
  if (sentence.substr(0, at) != form.substr(0, at)) return std::nullopt;
  if (at == std::string_view::npos) return words;
  sentence.remove_prefix(at);
  form.remove_prefix(at);
  while (!form.empty()) {
    form.remove_prefix(2);  // "%1"
    const std::string_view after = form.substr(0, form.find('%'));
    const bool last = after.size() == form.size();
    if (last && sentence.size() < after.size()) return std::nullopt;
    const std::size_t end = last ? sentence.size() - after.size() : sentence.find(after);
    if (end == std::string_view::npos || sentence.substr(end, after.size()) != after)
      return std::nullopt;
    words.push_back(sentence.substr(0, end));
    sentence.remove_prefix(end + after.size());
    form.remove_prefix(after.size());
  }
  return words;
}

// "1, 2 and 4" has a word in it; other words are somebody's own.
std::string plain_list(std::string_view word) {
  std::string text(word);
  const std::size_t at = text.find(" and ");
  if (at == std::string::npos) return text;
  if (text.find_first_not_of("0123456789, ") == at + 1) text.replace(at, 5, ", ");
  return text;
}

std::string filled(std::string_view form, const Words& words) {
  std::string text;
  for (std::size_t i = 0; i < form.size(); ++i) {
    const std::size_t which = i + 1 < form.size() ? static_cast<std::size_t>(form[i + 1] - '1') : 9;
    if (form[i] == '%' && which < words.size()) {
      text += plain_list(words[which]);
      ++i;
    } else {
      text += form[i];
    }
  }
  return text;
}

}  // namespace

std::string tr_sentence(const std::string& english) {
  for (const char* form : kKnown) {
    if (const auto words = words_in(english, form)) return filled(tr(form), *words);
  }
  return english;
}

}  // namespace client
