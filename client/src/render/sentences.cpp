#include "render/sentences.h"

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "render/translate.h"
#include "wire/sentence.h"

namespace client {
namespace {

// Sentences of the client and of recordings, as patterns with %1 .. %9 in order; wire/sentence.h
// has the server's.
constexpr std::array kOwn{
    // reasons for a missing server
    N_("no snapshot for %1 ms"),
    N_("it does not answer"),
    N_("it closed the connection"),
    N_("it ended the session"),
    N_("it sends invalid messages"),
    N_("it does not read what is sent to it"),
    N_("its characters cannot be played: use the same release of both"),
    N_("wrong password: give --password-file with the right one"),
    N_("There is no route to the server's UDP port %1: check this machine's network."),
    // recordings
    N_("%1 is not a recorded match (%2): choose a file that --record wrote"),
    N_("%1 is not a recorded match: choose a file that --record wrote"),
    N_("%1: cannot be opened (%2); check its name and permissions."),
    N_("%1 contains the beginning of a match, but no tick of it: there is nothing to replay"),
};

using Words = std::vector<std::string_view>;

// The words at %1, %2 ... if the sentence matches this pattern. The shortest match.
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

// Replaces the English "and" of "1, 2 and 4" by a comma; other text stays unchanged.
std::string plain_list(std::string_view word) {
  std::string text(word);
  const std::size_t at = text.find(" and ");
  if (at == std::string::npos) return text;
  if (text.find_first_not_of("0123456789, ") == at + 1) text.replace(at, 5, ", ");
  return text;
}

// The pattern with most text of its own that matches: text of other people may match a shorter one.
struct Known {
  const char* form = nullptr;
  Words words;
};
Known known(std::string_view sentence) {
  Known best;
  std::size_t max = 0;
  const auto look = [&](const char* form) {
    auto words = words_in(sentence, form);
    if (!words) return;
    std::size_t own = sentence.size() + 1;
    for (const std::string_view word : *words) own -= word.size();
    if (own > max) best = {form, std::move(*words)}, max = own;
  };
  for (const char* form : wire::kSentences) look(form);
  for (const char* form : kOwn) look(form);
  return best;
}

// A word may be a sentence, or several joined by "; ". Sentences nest no deeper than this.
constexpr int kDeepest = 3;
std::optional<std::string> translated(std::string_view sentence, int depth);

std::string translated_word(std::string_view word, int depth) {
  std::string text;
  for (std::string_view rest = word; !rest.empty();) {
    const std::size_t end = rest.find("; ");
    const auto part = translated(rest.substr(0, end), depth + 1);
    // Its own text contains "; ", or it is no sentence.
    if (!part) return translated(word, depth + 1).value_or(plain_list(word));
    text += (text.empty() ? "" : "; ") + *part;
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 2);
  }
  return text;
}

std::optional<std::string> translated(std::string_view sentence, int depth) {
  if (depth > kDeepest) return std::nullopt;
  const Known found = known(sentence);
  if (found.form == nullptr) return std::nullopt;
  std::vector<std::string> words;
  for (const std::string_view word : found.words) words.push_back(translated_word(word, depth));
  return filled(tr(found.form), words);
}

}  // namespace

std::string filled(std::string_view form, const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < form.size(); ++i) {
    const std::size_t which = i + 1 < form.size() ? static_cast<std::size_t>(form[i + 1] - '1') : 9;
    if (form[i] == '%' && which < words.size()) {
      text += words[which];
      ++i;
    } else {
      text += form[i];
    }
  }
  return text;
}

std::string tr_sentence(const std::string& english) {
  return translated(english, 0).value_or(english);
}

std::string tr_player(const std::string& name) {
  for (const char* nobody : {N_("computer"), N_("cabinet"), N_("nobody")}) {
    if (name == nobody) return tr(nobody);
  }
  constexpr std::string_view kComputer = "computer ";
  if (!name.starts_with(kComputer)) return name;
  const std::size_t colon = name.find(':');
  std::string text =
      std::string(tr("computer")) + " " +
      name.substr(kComputer.size(), colon == std::string::npos ? colon : colon - kComputer.size());
  if (colon == std::string::npos) return text;
  const std::string style = name.substr(colon + 1);
  for (const char* known : {N_("wall"), N_("shooter"), N_("passer"), N_("gambler")}) {
    if (style == known) return text + ", " + tr(known);
  }
  return name;
}

}  // namespace client
