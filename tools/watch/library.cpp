#include "library.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <set>

#include "results/rating.h"
#include "results/store.h"

namespace watch {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostRows = 500;

struct Entry {
  std::string when, what, path;
};

std::string players_of(const results::Team& team) {
  std::string text;
  for (const results::Player& player : team.players)
    text += (text.empty() ? "" : " + ") + player.name;
  return text;
}

void add_results(const std::string& path, std::vector<Entry>& entries, Library& library) {
  std::error_code error;
  if (path.empty() || !fs::exists(path, error)) return;
  const auto store = results::Store::open(path, results::Access::read_only);
  const auto matches = store ? store->matches({}) : tl::unexpected(store.error());
  if (!matches) {
    library.list.message = matches.error();
    return;
  }
  for (const results::Standing& standing : results::standings(*matches)) {
    char rating[24], record[48];
    std::snprintf(rating, sizeof rating, "%.0f", standing.rating);
    std::snprintf(record, sizeof record, "%llu-%llu",
                  static_cast<unsigned long long>(standing.wins),
                  static_cast<unsigned long long>(standing.losses));
    library.list.hall_of_fame.push_back({standing.name, rating, record});
  }
  for (const results::MatchResult& match : *matches) {
    std::string when = match.finished_at.substr(0, 16);
    std::ranges::replace(when, 'T', ' ');
    entries.push_back({when,
                       players_of(match.teams[0]) + "  " + std::to_string(match.teams[0].goals) +
                           " : " + std::to_string(match.teams[1].goals) + "  " +
                           players_of(match.teams[1]),
                       fs::exists(match.recording, error) ? match.recording : ""});
  }
}

// Recordings that no result names.
void add_recordings(const std::string& folder, std::vector<Entry>& entries) {
  std::set<std::string> known;
  for (const Entry& entry : entries) known.insert(entry.path);
  std::error_code error;
  for (const fs::directory_entry& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() != ".sfr" || !file.is_regular_file(error) ||
        known.contains(file.path().string()))
      continue;
    const auto system = std::chrono::file_clock::to_sys(file.last_write_time(error));
    const std::time_t time =
        std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(system));
    std::tm utc{};
    ::gmtime_r(&time, &utc);
    char when[32];
    std::strftime(when, sizeof when, "%Y-%m-%d %H:%M", &utc);
    entries.push_back({when, file.path().filename().string(), file.path().string()});
  }
}

}  // namespace

Library read_library(const std::string& folder, const std::string& results) {
  Library library;
  std::vector<Entry> entries;
  add_results(results, entries, library);
  if (!folder.empty()) add_recordings(folder, entries);
  std::ranges::stable_sort(entries, std::ranges::greater(), &Entry::when);
  if (entries.size() > kMostRows) entries.resize(kMostRows);
  for (Entry& entry : entries) {
    library.list.rows.push_back({entry.when, entry.what, !entry.path.empty()});
    library.paths.push_back(std::move(entry.path));
  }
  return library;
}

}  // namespace watch
