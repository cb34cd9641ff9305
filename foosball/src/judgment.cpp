#include "foosball/judgment.h"

#include <algorithm>
#include <charconv>
#include <locale>
#include <sstream>
#include <utility>

namespace foosball {
namespace {

std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

auto invalid(std::string sentence) {
  return tl::unexpected(vp::Error{vp::Errc::invalid_argument, std::move(sentence)});
}

std::string quoted(std::string_view text) {
  std::string result = "\"";
  return result.append(text.substr(0, 40)).append("\"");
}

// Independent of the program's locale. libc++ has no std::from_chars for double.
bool read_number(std::string_view text, double& value) {
  std::istringstream stream{std::string(text)};
  stream.imbue(std::locale::classic());
  return (stream >> std::noskipws >> value) &&
         stream.peek() == std::istringstream::traits_type::eof();
}

}  // namespace

vp::Expected<Judgment> with_changes(const Judgment& base, std::string_view changes) {
  Judgment judgment = base;
  std::array<bool, kJudgmentValues> given{};
  while (!changes.empty()) {
    const std::string_view one = changes.substr(0, changes.find(','));
    changes.remove_prefix(std::min(changes.size(), one.size() + 1));
    const std::size_t equals = one.find('=');
    const int index = judgment_index(one.substr(0, equals));
    if (equals == std::string_view::npos || index < 0) {
      return invalid(quoted(one) +
                     " is no value of a computer player's judgment: write NAME=NUMBER,...; "
                     "space-foosball-match --list-judgment 5 shows the names");
    }
    const JudgmentField& field = kJudgmentFields[static_cast<std::size_t>(index)];
    double value = 0.0;
    if (!read_number(one.substr(equals + 1), value) || !in_range(field, value)) {
      return invalid(quoted(one) + ": " + field.name + " must be a number from " +
                     number(field.min) + " to " + number(field.max));
    }
    if (given[static_cast<std::size_t>(index)]) {
      return invalid(std::string(field.name) + " is given twice: give it once");
    }
    given[static_cast<std::size_t>(index)] = true;
    judgment.*field.value = value;
  }
  return judgment;
}

std::string changes_of(const Judgment& base, const Judgment& judgment) {
  std::string text;
  for (const JudgmentField& field : kJudgmentFields) {
    const double value = judgment.*field.value;
    if (value == base.*field.value) continue;
    if (!text.empty()) text += ',';
    text.append(field.name).append("=").append(number(value));
  }
  return text;
}

}  // namespace foosball
