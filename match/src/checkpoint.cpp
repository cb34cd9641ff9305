#include "match/checkpoint.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "match/codec.h"

namespace match {
namespace {

std::string head_of(const std::vector<SeriesDesc>& series, const std::string& plan) {
  std::string head = "space-foosball-match checkpoint 1; game " +
                     std::to_string(game_fingerprint()) + "; " + std::to_string(series.size()) +
                     " series";
  std::uint64_t digest = 0;
  const auto add = [&](const std::string& text) {
    for (const char c : text) digest = mix_seed(digest ^ static_cast<unsigned char>(c));
  };
  for (const SeriesDesc& desc : series) add(desc.text() + ";");
  add(plan);
  return head + " " + std::to_string(digest);
}

std::optional<Checkpoint::Line> parse(const std::string& line) {
  const char* end = line.data() + line.size();
  Checkpoint::Line parsed;
  const auto series = std::from_chars(line.data(), end, parsed.id.series);
  if (series.ec != std::errc{} || series.ptr == end || *series.ptr != ' ') return std::nullopt;
  const auto game = std::from_chars(series.ptr + 1, end, parsed.id.game);
  if (game.ec != std::errc{} || game.ptr == end || *game.ptr != ' ') return std::nullopt;
  const auto result = decode_result({game.ptr + 1, static_cast<std::size_t>(end - game.ptr - 1)});
  if (!result) return std::nullopt;
  parsed.result = *result;
  return parsed;
}

}  // namespace

tl::expected<Checkpoint::Opened, std::string> Checkpoint::open(
    const std::string& path, const std::vector<SeriesDesc>& series, const std::string& plan) {
  const std::string head = head_of(series, plan);
  std::ifstream before(path);
  std::stringstream text;
  if (before) text << before.rdbuf();
  os::FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file) {
    return tl::unexpected("cannot open the checkpoint " + path + ": " + std::strerror(errno) +
                          "; choose a file in a folder that can be written");
  }
  Opened opened;
  opened.checkpoint.reset(new Checkpoint(path, std::move(file)));
  std::string line;
  const bool old = static_cast<bool>(std::getline(text, line));
  if (old && line != head) {
    return tl::unexpected(path +
                          " is the checkpoint of other matches or of another version of the "
                          "game: give the same options, or another file");
  }
  while (old && std::getline(text, line)) {
    auto parsed = parse(line);
    if (parsed) {
      opened.lines.push_back(*parsed);
    } else {
      ++opened.unreadable;
    }
  }
  // After a line that was cut off, a new one must begin.
  const std::string all = text.str();
  const bool cut = !all.empty() && all.back() != '\n';
  if (auto wrote =
          opened.checkpoint->write((old ? "" : head + "\n") + std::string(cut ? "\n" : ""));
      !wrote) {
    return tl::unexpected(wrote.error());
  }
  return opened;
}

tl::expected<void, std::string> Checkpoint::append(JobId id, const GameResult& result) {
  return write(std::to_string(id.series) + ' ' + std::to_string(id.game) + ' ' +
               encode_result(result) + '\n');
}

tl::expected<void, std::string> Checkpoint::write(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const ssize_t wrote = ::write(file_.get(), text.data() + at, text.size() - at);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      return tl::unexpected("cannot write the checkpoint " + path_ + ": " + std::strerror(errno));
    }
    at += static_cast<std::size_t>(wrote);
  }
  if (::fdatasync(file_.get()) != 0 && errno != EINVAL) {
    return tl::unexpected("cannot write the checkpoint " + path_ + ": " + std::strerror(errno));
  }
  return {};
}

std::uint64_t game_fingerprint() {
  std::uint64_t fingerprint = 0;
  for (const char* player : {"classic:0.9", "5"}) {
    GameDesc game;
    game.players = {player, player};
    game.max_ticks = 5000;
    fingerprint = mix_seed(fingerprint ^ play_game(game).result.state_hash);
  }
  return fingerprint;
}

}  // namespace match
