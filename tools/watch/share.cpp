#include "share.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>

namespace watch {
namespace {

namespace fs = std::filesystem;

// Replaces characters that some file system rejects: a team may have any name.
std::string harmless(std::string name) {
  for (char& c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!letter && c != '-' && c != '_' && c != ' ' && byte < 0x80) c = '_';
  }
  return name.empty() ? "team" : name.substr(0, 60);
}

}  // namespace

std::string telling_name(const server::RecordingSummary& recording) {
  std::tm local{};
  ::localtime_r(&recording.began, &local);
  char when[40];
  std::strftime(when, sizeof when, "%Y-%m-%d %H.%M", &local);
  const wire::JournalStanding& standing = recording.standing;
  return std::string("Space Foosball ") + when + " " + harmless(recording.characters[0]) + " " +
         std::to_string(standing.score[0]) + "-" + std::to_string(standing.score[1]) + " " +
         harmless(recording.characters[1]) + ".sfr";
}

tl::expected<std::string, std::string> share(const std::string& recording,
                                             const std::string& folder) {
  const server::RecordingSummary summary = server::summarise_recording(recording);
  if (summary.state == server::RecordingSummary::State::bad) return tl::unexpected(summary.problem);
  std::error_code error;
  fs::create_directories(folder, error);
  const std::string stem = fs::path(telling_name(summary)).stem().string();
  for (int i = 1; i < 1000 && !error; ++i) {
    std::string name = stem;
    if (i > 1) name.append(" (").append(std::to_string(i)).append(")");
    const fs::path to = fs::path(folder) / name.append(".sfr");
    if (fs::exists(fs::symlink_status(to, error))) continue;
    error.clear();
    if (fs::copy_file(recording, to, error)) {
      // A shared recording should not be deleted here. In a read-only folder marking fails, which
      // is ignored.
      (void)server::keep_recording(recording, true);
      return to.string();
    }
    std::error_code ignored;
    fs::remove(to, ignored);  // removes a partial copy
  }
  return tl::unexpected("The recording cannot be copied to " + folder + " (" +
                        (error ? error.message() : "too many of that name") +
                        "): make room there, or choose another folder with --share-to.");
}

std::string shared_folder() {
  const char* home = std::getenv("HOME");
  if (home == nullptr || home[0] != '/') return ".";
  const fs::path documents = fs::path(home) / "Documents";
  std::error_code error;
  return ((fs::is_directory(documents, error) ? documents : fs::path(home)) / "Space Foosball")
      .string();
}

}  // namespace watch
