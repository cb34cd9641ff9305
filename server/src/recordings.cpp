#include "server/recordings.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <variant>

#include "os/file_descriptor.h"
#include "os/user_folder.h"

namespace server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNameLength = 17;  // of 2026-11-23_070542
constexpr std::size_t kHead = wire::kMaxJournalHeader + 8;
// A complete recording has its last standing within the first size. A truncated one has it about
// one second of play and one keyframe before its end.
constexpr std::array<std::size_t, 2> kTails{512, 256 * 1024};

std::string keep_mark(const std::string& path) {
  return path + ".keep";
}

// The time in a file name of new_recording(), without folder.
std::optional<std::time_t> moment_of(const std::string& name) {
  std::tm parts{};
  int read = 0;
  if (std::sscanf(name.c_str(), "%4d-%2d-%2d_%2d%2d%2d%n", &parts.tm_year, &parts.tm_mon,
                  &parts.tm_mday, &parts.tm_hour, &parts.tm_min, &parts.tm_sec, &read) != 6 ||
      read != static_cast<int>(kNameLength)) {
    return std::nullopt;
  }
  parts.tm_year -= 1900;
  parts.tm_mon -= 1;
  parts.tm_isdst = -1;
  const std::time_t moment = std::mktime(&parts);
  return moment == -1 ? std::nullopt : std::optional(moment);
}

// True if new_recording() made the name: such a file may be deleted.
bool is_ours(const std::string& name) {
  const std::string rest = name.size() > kNameLength ? name.substr(kNameLength) : "";
  const bool numbered =
      rest.size() > 5 && rest[0] == '-' &&
      std::all_of(rest.begin() + 1, rest.end() - 4, [](char c) { return c >= '0' && c <= '9'; }) &&
      rest.ends_with(".sfr");
  return moment_of(name) && (rest == ".sfr" || numbered);
}

// A server that writes a recording holds a lock on it.
bool is_locked(int file) {
  if (::flock(file, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  ::flock(file, LOCK_UN);
  return false;
}

std::vector<std::byte> read_at(int file, std::uint64_t from, std::size_t size) {
  std::vector<std::byte> bytes(size);
  std::size_t got = 0;
  while (got < size) {
    const ssize_t read =
        ::pread(file, bytes.data() + got, size - got, static_cast<off_t>(from + got));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) break;
    got += static_cast<std::size_t>(read);
  }
  bytes.resize(got);
  return bytes;
}

// Empty, or the error in the beginning of the file.
std::string read_head(int file, RecordingSummary& into, wire::JournalHeader& header) {
  const auto head = read_at(file, 0, kHead);
  if (head.empty()) return " is empty: nothing was recorded; it can be removed.";
  if (const auto format = wire::other_journal_format(head)) {
    return " was recorded by another release (" + wire::to_text(*format) + "; this one plays " +
           wire::to_text(wire::journal_format()) + "): watch it with the release that recorded it.";
  }
  wire::JournalReader reader(head);
  const auto entry = reader.next();
  if (!entry) {
    if (reader.other_version() != 0)
      return " was recorded by another release: watch it with the release that recorded it.";
    return " is not a recorded match, or its beginning is damaged; choose another one.";
  }
  header = std::get<wire::JournalHeader>(*entry);
  into.layout = header.layout;
  into.mode = header.mode;
  return {};
}

void read_tail(int file, RecordingSummary& into) {
  for (const std::size_t size : kTails) {
    const std::uint64_t from = into.bytes > size ? into.bytes - size : 0;
    const auto tail = wire::read_journal_tail(read_at(file, from, size));
    if (tail.end) into.state = RecordingSummary::State::whole;
    if (tail.end) into.ticks = tail.end->ticks;
    if (!tail.standing) continue;
    into.standing = *tail.standing;
    if (!tail.end) into.ticks = tail.standing->tick;
    return;
  }
}

struct Droppable {
  std::string path;
  std::uint64_t bytes;
};

// Oldest first: names sort by time.
std::vector<Droppable> droppable(const std::string& folder) {
  std::vector<Droppable> found;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string path = at->path().string();
    struct stat about {};
    if (!is_ours(at->path().filename().string()) || ::lstat(path.c_str(), &about) != 0 ||
        !S_ISREG(about.st_mode) || ::access(keep_mark(path).c_str(), F_OK) == 0) {
      continue;
    }
    found.push_back({path, static_cast<std::uint64_t>(about.st_size)});
  }
  std::ranges::sort(found, {}, &Droppable::path);
  return found;
}

// Deletes recordings until one more fits.
void drop_oldest(const std::string& folder, const RecordingLimits& limits) {
  std::vector<Droppable> all = droppable(folder);
  std::size_t count = all.size();
  std::uint64_t bytes = 0;
  for (const Droppable& one : all) bytes += one.bytes;
  for (const Droppable& one : all) {
    if (count < limits.count && bytes + limits.bytes_of_one <= limits.bytes) return;
    const os::FileDescriptor file(::open(one.path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file && is_locked(file.get())) continue;
    if (::unlink(one.path.c_str()) != 0) continue;
    --count;
    bytes -= one.bytes;
  }
}

}  // namespace

tl::expected<std::string, std::string> new_recording(const std::string& folder,
                                                     const RecordingLimits& limits,
                                                     std::time_t now) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder, error)) {
    return tl::unexpected("the folder " + folder + " for recordings cannot be made (" +
                          error.message() + "): this match is not recorded");
  }
  drop_oldest(folder, limits);
  std::tm parts{};
  ::localtime_r(&now, &parts);
  char name[32];
  std::strftime(name, sizeof name, "%Y-%m-%d_%H%M%S", &parts);
  for (int i = 1; i < 100; ++i) {
    std::string path = (fs::path(folder) / name).string();
    if (i > 1) path.append("-").append(std::to_string(i));
    path.append(".sfr");
    if (!fs::exists(fs::symlink_status(path, error))) return path;
  }
  return tl::unexpected("the folder " + folder + " has too many recordings of this second");
}

RecordingSummary summarise_recording(const std::string& path) {
  RecordingSummary summary;
  summary.path = path;
  summary.kept = ::access(keep_mark(path).c_str(), F_OK) == 0;
  const auto bad = [&](const std::string& why) {
    summary.problem = path + why;
    return summary;
  };
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0)
    return bad(std::string(" cannot be read (") + std::strerror(errno) + ").");
  summary.began = moment_of(fs::path(path).filename().string()).value_or(about.st_mtime);
  if (!S_ISREG(about.st_mode)) return bad(" is not a file: choose a recording.");
  const os::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!file) {
    return bad(std::string(" cannot be read (") + std::strerror(errno) +
               "): check its permissions.");
  }
  summary.bytes = static_cast<std::uint64_t>(about.st_size);
  wire::JournalHeader header;
  if (const std::string why = read_head(file.get(), summary, header); !why.empty()) return bad(why);
  summary.state = is_locked(file.get()) ? RecordingSummary::State::being_made
                                        : RecordingSummary::State::cut_short;
  read_tail(file.get(), summary);
  for (std::size_t team = 0; team < summary.characters.size(); ++team) {
    const std::size_t chosen = summary.standing.character[team];
    if (chosen < header.characters.size())
      summary.characters[team] = header.characters[chosen].name;
  }
  return summary;
}

bool is_being_recorded(const std::string& path) {
  const os::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  return file && is_locked(file.get());
}

tl::expected<std::vector<RecordingSummary>, std::string> list_recordings(
    const std::string& folder) {
  std::vector<RecordingSummary> all;
  std::error_code error;
  fs::directory_iterator at(folder, error);
  if (error == std::errc::no_such_file_or_directory) return all;
  for (const fs::directory_iterator end; !error && at != end; at.increment(error)) {
    if (at->path().extension() == ".sfr") all.push_back(summarise_recording(at->path().string()));
  }
  if (error) {
    return tl::unexpected("The folder " + folder + " cannot be read (" + error.message() +
                          "): check its permissions.");
  }
  std::ranges::sort(all, [](const RecordingSummary& a, const RecordingSummary& b) {
    return a.began != b.began ? a.began > b.began : a.path > b.path;
  });
  return all;
}

tl::expected<void, std::string> keep_recording(const std::string& path, bool keep) {
  const std::string mark = keep_mark(path);
  bool good = false;
  if (keep) {
    good = static_cast<bool>(
        os::FileDescriptor(::open(mark.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)));
  } else {
    good = ::unlink(mark.c_str()) == 0 || errno == ENOENT;
  }
  if (good) return {};
  return tl::unexpected(mark + " cannot be " + (keep ? "written" : "removed") + " (" +
                        std::strerror(errno) + "): check the folder.");
}

std::string recordings_folder() {
  const std::string data = os::data_folder();
  return data.empty() ? "" : data + "/space-foosball/recordings";
}

}  // namespace server
