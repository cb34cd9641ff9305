#include "result_writer.h"

#include <ctime>
#include <fstream>
#include <utility>

#include "os/time_of_day.h"
#include "results/text.h"
#include "server/match_statistics.h"

namespace app {
namespace {

// Uses the names that the server gives its computer players, so that they share a rating.
results::MatchResult result_of(const match::GameDesc& game, const match::GameResult& played) {
  const foosball::Rules rules;
  results::MatchResult result;
  result.layout = game.layout == foosball::Layout::paper ? "paper" : "tournament";
  result.goals_to_win = static_cast<std::uint32_t>(rules.goals_to_win);
  result.max_goals = static_cast<std::uint32_t>(rules.max_goals);
  result.seed = game.seed;
  result.play_seconds = static_cast<double>(played.statistics.play_ticks) * foosball::kTick;
  const auto statistics = server::statistics_of_teams({}, played.statistics);
  for (std::size_t t = 0; t < result.teams.size(); ++t) {
    result.teams[t] = {{{"computer " + game.players[t], "computer"}},
                       static_cast<std::uint32_t>(played.score[t]),
                       statistics[t]};
  }
  result.shot_speeds = server::shot_speeds({}, played.statistics);
  return result;
}

}  // namespace

tl::expected<ResultWriter, std::string> ResultWriter::open(const std::string& path) {
  auto store = results::Store::open(path, results::Access::create);
  if (!store) return tl::unexpected(store.error());
  return ResultWriter(path, std::move(*store));
}

void ResultWriter::add(const match::GameDesc& game, const match::GameResult& result,
                       std::string recording) {
  const std::time_t now = std::time(nullptr);
  results::MatchResult& next = waiting_.emplace_back(result_of(game, result));
  next.finished_at = os::utc_text(now);
  next.recording = std::move(recording);
  if (waiting_.size() >= kBatch || now >= flushed_s_ + kEvery_s) flush();
}

void ResultWriter::flush() {
  flushed_s_ = std::time(nullptr);
  if (waiting_.empty()) return;
  if (const auto added = store_.add(waiting_); added) {
    kept_ += waiting_.size();
  } else {
    if (problem_.empty()) problem_ = added.error();
    put_aside();
  }
  waiting_.clear();
}

void ResultWriter::put_aside() {
  std::string rows = results::matches_csv(waiting_);
  if (aside_ > 0) rows.erase(0, rows.find('\n') + 1);  // the file already has the header
  std::ofstream file(path_ + ".unsaved.csv", std::ios::binary | std::ios::app);
  file << rows;
  file.close();
  (file ? aside_ : lost_) += waiting_.size();
}

std::string ResultWriter::finish() {
  flush();
  if (problem_.empty()) return {};
  std::string text = problem_;
  if (aside_ > 0)
    text += "; " + std::to_string(aside_) + " matches are in " + path_ + ".unsaved.csv instead";
  if (lost_ > 0)
    text += "; " + std::to_string(lost_) + " matches could be written nowhere, but are counted";
  return text;
}

}  // namespace app
