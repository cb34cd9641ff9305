#include "wire/sentence.h"

#include <utility>

namespace wire {

Sentence Sentence::untranslated(std::string text) {
  Sentence sentence;
  sentence.text_ = std::move(text);
  return sentence;
}

Sentence Sentence::filled(std::string_view form, std::initializer_list<std::string> words) {
  Sentence sentence;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] != '%') {
      sentence.text_ += form[i];
      continue;
    }
    sentence.text_ += words.begin()[form[++i] - '1'];
  }
  return sentence;
}

}  // namespace wire
