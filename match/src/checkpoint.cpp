#include "match/checkpoint.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "foosball/computer_player.h"
#include "match/codec.h"
#include "server/match_record.h"
#include "wire/journal.h"

namespace match {
namespace {

constexpr const char* kKind = "space-foosball-match checkpoint ";
constexpr const char* kVersion = "2; ";

// Identifies the series.
std::string subject_of(const std::vector<SeriesDesc>& series, const std::string& plan) {
  std::uint64_t digest = 0;
  for (const SeriesDesc& desc : series) digest = mix_seed(digest ^ desc.digest());
  for (const char c : plan) digest = mix_seed(digest ^ static_cast<unsigned char>(c));
  return kKind + std::string(kVersion) + std::to_string(series.size()) + " series, " +
         std::to_string(digest);
}

// The reason why the first line of a file is not the expected header.
std::string refusal(const std::string& path, const std::string& line, const std::string& subject) {
  if (!line.starts_with(kKind)) return path + " is no checkpoint: give another file";
  if (!line.starts_with(kKind + std::string(kVersion)) || line.starts_with(subject + ";")) {
    return path +
           " was begun by another version of the game, whose players, rules, tuning or physics "
           "differ: finish it with that version, or give another file";
  }
  return path + " is the checkpoint of other matches: give the same options, or another file";
}

std::optional<Checkpoint::Line> parse(const std::string& line) {
  const char* end = line.data() + line.size();
  Checkpoint::Line parsed;
  const auto series = std::from_chars(line.data(), end, parsed.id.series);
  if (series.ec != std::errc{} || series.ptr == end || *series.ptr != ' ') return std::nullopt;
  const auto game = std::from_chars(series.ptr + 1, end, parsed.id.game);
  if (game.ec != std::errc{} || game.ptr == end || *game.ptr != ' ') return std::nullopt;
  const auto digest = std::from_chars(game.ptr + 1, end, parsed.series);
  if (digest.ec != std::errc{} || digest.ptr == end || *digest.ptr != ' ') return std::nullopt;
  const auto result =
      decode_result({digest.ptr + 1, static_cast<std::size_t>(end - digest.ptr - 1)});
  if (!result) return std::nullopt;
  parsed.result = *result;
  return parsed;
}

}  // namespace

tl::expected<Checkpoint::Opened, std::string> Checkpoint::open(
    const std::string& path, const std::vector<SeriesDesc>& series, const std::string& plan) {
  const std::string subject = subject_of(series, plan);
  const std::string head = subject + "; game " + std::to_string(game_fingerprint(series));
  // Opening a pipe would block, and a device may have no end.
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    return tl::unexpected("the checkpoint " + path +
                          " is a folder, a pipe or a device: give another file");
  }
  os::FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file) {
    return tl::unexpected("cannot open the checkpoint " + path + ": " + std::strerror(errno) +
                          "; choose a file in a folder that can be written");
  }
  // Two runs would play each other's games again. Some file systems have no locks: then the run
  // continues without one.
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return tl::unexpected("another run has the checkpoint " + path +
                          ": wait for it, or give another file");
  }
  std::ifstream before(path);
  std::stringstream text;
  if (before) text << before.rdbuf();
  const std::string all = text.str();
  const bool whole_head = all.find('\n') != std::string::npos;
  Opened opened;
  opened.checkpoint.reset(new Checkpoint(path, std::move(file)));
  std::string line;
  std::getline(text, line);
  // Writes a truncated header again.
  const bool begins = !whole_head && head.starts_with(all);
  if (!begins && line != head) return tl::unexpected(refusal(path, line, subject));
  while (std::getline(text, line)) {
    auto parsed = parse(line);
    if (parsed) {
      opened.lines.push_back(*parsed);
    } else {
      ++opened.unreadable;
    }
  }
  // Completes a truncated last line, so that the next result starts on a new line.
  const std::string missing = begins               ? head.substr(all.size()) + "\n"
                              : all.back() != '\n' ? "\n"
                                                   : "";
  if (auto wrote = opened.checkpoint->write(missing); !wrote) return tl::unexpected(wrote.error());
  return opened;
}

tl::expected<void, std::string> Checkpoint::append(JobId id, std::uint64_t series,
                                                   const GameResult& result) {
  return write(std::to_string(id.series) + ' ' + std::to_string(id.game) + ' ' +
               std::to_string(series) + ' ' + encode_result(result) + '\n');
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

namespace {

// Digest of the default rules and tuning, encoded as in a recording's header.
std::uint64_t digest_of_defaults() {
  wire::JournalEncoder encoder;
  std::vector<std::byte> bytes;
  encoder.add(server::to_header(foosball::MatchDesc{}), bytes);
  encoder.flush(bytes);
  std::uint64_t digest = 0;
  for (const std::byte byte : bytes) digest = mix_seed(digest ^ static_cast<std::uint64_t>(byte));
  return digest;
}

}  // namespace

std::uint64_t game_fingerprint(const std::vector<SeriesDesc>& series) {
  // The series' text contains the values of judgment; the sample play uses the level without them.
  std::set<std::string> players;
  std::set<foosball::Layout> layouts;
  for (const SeriesDesc& desc : series) {
    for (const std::string& player : desc.players)
      players.insert(player.substr(0, player.find('@')));
    layouts.insert(desc.layout);
  }
  std::uint64_t fingerprint = mix_seed(foosball::players_digest() ^ digest_of_defaults());
  for (const foosball::Layout layout : layouts) {
    for (const std::string& player : players) {
      GameDesc game;
      game.players = {player, player};
      game.layout = layout;
      game.max_ticks = 5000;
      fingerprint = mix_seed(fingerprint ^ play_game(game).result.state_hash);
    }
  }
  return fingerprint;
}

}  // namespace match
