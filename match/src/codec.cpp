#include "match/codec.h"

#include <charconv>
#include <vector>

namespace match {
namespace {

struct Pointers {
  std::vector<std::uint64_t*> all;
  void sum(const char*, std::uint64_t& count) { all.push_back(&count); }
  void max(const char*, std::uint64_t& count) { all.push_back(&count); }
};

std::vector<std::uint64_t*> counts_of(foosball::Statistics& statistics) {
  Pointers pointers;
  foosball::Statistics::visit(pointers, statistics);
  return std::move(pointers.all);
}

// FNV-1a, 64 bits. It detects truncated or damaged lines, not forged ones.
std::uint64_t check_of(std::string_view text) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}
  bool done() const { return rest_.empty(); }
  template <class Number>
  std::optional<Number> number(char end) {
    Number value{};
    const auto [after, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    const auto used = static_cast<std::size_t>(after - rest_.data());
    if (error != std::errc{} || used >= rest_.size() || rest_[used] != end) return std::nullopt;
    rest_.remove_prefix(used + 1);
    return value;
  }

 private:
  std::string_view rest_;
};

}  // namespace

std::string encode_result(const GameResult& result) {
  std::string line = std::to_string(result.winner) + ' ' + std::to_string(result.score[0]) + ' ' +
                     std::to_string(result.score[1]) + ' ' + std::to_string(result.state_hash) +
                     ' ';
  foosball::Statistics statistics = result.statistics;
  const auto counts = counts_of(statistics);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (*counts[i] != 0) line += std::to_string(i) + ':' + std::to_string(*counts[i]) + ' ';
  }
  return line + '#' + std::to_string(check_of(line));
}

std::optional<GameResult> decode_result(std::string_view line) {
  const std::size_t mark = line.rfind('#');
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string_view body = line.substr(0, mark);
  if (line.substr(mark + 1) != std::to_string(check_of(body))) return std::nullopt;
  GameResult result;
  Words words(body);
  const auto winner = words.number<int>(' '), home = words.number<int>(' '),
             away = words.number<int>(' ');
  const auto hash = words.number<std::uint64_t>(' ');
  if (!winner || !home || !away || !hash || *winner < -1 || *winner > 1) return std::nullopt;
  result.winner = *winner;
  result.score = {*home, *away};
  result.state_hash = *hash;
  const auto counts = counts_of(result.statistics);
  while (!words.done()) {
    const auto index = words.number<std::size_t>(':');
    const auto count = words.number<std::uint64_t>(' ');
    if (!index || !count || *index >= counts.size()) return std::nullopt;
    *counts[*index] = *count;
  }
  return result;
}

}  // namespace match
