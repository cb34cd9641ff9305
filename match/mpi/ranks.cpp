#include "ranks.h"

#include <mpi.h>

#include <array>
#include <charconv>
#include <deque>
#include <optional>
#include <sstream>
#include <vector>

#include "match/checkpoint.h"
#include "match/codec.h"
#include "os/clock.h"

namespace ranks {
namespace {

using match::JobId;

enum Tag { kIdle, kResult, kFailed, kJob, kStop };

// An idle rank sends this identity of the games that it would play, and of its program.
std::string identity_of(const std::vector<match::SeriesDesc>& series) {
  std::uint64_t digest = match::game_fingerprint(series);
  for (const match::SeriesDesc& desc : series) digest = match::mix_seed(digest ^ desc.digest());
  return std::to_string(digest);
}

// The answer of a rank: "series game nanoseconds result", or a sentence with kFailed.
struct Answer {
  JobId id;
  std::int64_t cost_ns = 0;
  match::GameResult result;
};

std::string encode(const Answer& answer) {
  std::string text = std::to_string(answer.id.series);
  text += ' ';
  text += std::to_string(answer.id.game);
  text += ' ';
  text += std::to_string(answer.cost_ns);
  text += ' ';
  return text + match::encode_result(answer.result);
}

std::optional<Answer> decode(const std::string& text) {
  Answer answer;
  const char* at = text.data();
  const char* end = at + text.size();
  const auto number = [&](auto& value) {
    const auto [after, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || after == end || *after != ' ') return false;
    at = after + 1;
    return true;
  };
  if (!number(answer.id.series) || !number(answer.id.game) || !number(answer.cost_ns)) {
    return std::nullopt;
  }
  const auto result = match::decode_result({at, static_cast<std::size_t>(end - at)});
  if (!result) return std::nullopt;
  answer.result = *result;
  return answer;
}

void send(int rank, Tag tag, const std::string& text = {}) {
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, rank, tag, MPI_COMM_WORLD);
}

struct Message {
  int rank, tag;
  std::string text;
};

// Waits without occupying a core: the playing ranks need it.
std::optional<Message> receive(std::int64_t patience_ns) {
  const std::int64_t until = os::monotonic_ns() + patience_ns;
  MPI_Status status;
  int there = 0;
  while (true) {
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there != 0) break;
    if (os::monotonic_ns() >= until) return std::nullopt;
    os::sleep_until_ns(os::monotonic_ns() + 500'000);
  }
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  Message message{status.MPI_SOURCE, status.MPI_TAG,
                  std::string(static_cast<std::size_t>(size), 0)};
  MPI_Recv(message.text.data(), size, MPI_CHAR, message.rank, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

// A game as text: "series game layout seed", and one line per player.
std::string encode(JobId id, const match::SeriesDesc& desc) {
  std::string text = std::to_string(id.series);
  for (const std::uint64_t number :
       {id.game, static_cast<std::uint64_t>(desc.layout == foosball::Layout::paper), desc.seed}) {
    text += ' ';
    text += std::to_string(number);
  }
  return text + '\n' + desc.players[0] + '\n' + desc.players[1];
}

struct Job {
  JobId id;
  match::GameDesc game;
};

// text: by encode() in another rank of this program.
Job decode(const std::string& text, const std::vector<match::SeriesDesc>& series) {
  Job job;
  std::uint64_t paper = 0, seed = 0;
  std::istringstream in(text);
  in >> job.id.series >> job.id.game >> paper >> seed;
  in.ignore();
  match::SeriesDesc desc = series.at(job.id.series < series.size() ? job.id.series : 0);
  desc.layout = paper != 0 ? foosball::Layout::paper : foosball::Layout::tournament;
  desc.seed = seed;
  std::getline(in, desc.players[0]);
  std::getline(in, desc.players[1]);
  job.game = match::Series(desc).game(job.id.game);
  return job;
}

// Assigns the games of one call.
class Round {
 public:
  Round(match::Schedule& schedule, const match::ExecutorOptions& options,
        const std::string& identity, std::deque<JobId>& under_way, std::vector<int>& waiting)
      : schedule_(schedule),
        options_(options),
        identity_(identity),
        under_way_(under_way),
        waiting_(waiting) {}

  tl::expected<match::Effort, std::string> run() {
    const std::int64_t begun = os::monotonic_ns();
    std::erase_if(under_way_, [&](JobId id) { return schedule_.series()[id.series].decided(); });
    std::vector<int> idle;
    idle.swap(waiting_);
    for (const int rank : idle) {
      if (over()) {
        waiting_.push_back(rank);
      } else {
        hand_out(rank);
      }
    }
    while (!over()) {
      if (const auto message = receive(100'000'000)) take(*message);
    }
    effort_.seconds = static_cast<double>(os::monotonic_ns() - begun) * 1e-9;
    if (!problem_.empty()) return tl::unexpected(problem_);
    return effort_;
  }

 private:
  bool stopped() const {
    return !problem_.empty() || (options_.stop != nullptr && options_.stop->load());
  }
  bool over() const { return schedule_.finished() || stopped(); }

  void take(const Message& message) {
    if (message.tag == kFailed) problem_ = message.text;
    if (message.tag == kIdle && message.text != identity_) {
      problem_ = "rank " + std::to_string(message.rank) +
                 " plays other matches, or another version of the game: give all ranks the same "
                 "program and the same options";
    }
    if (message.tag == kResult) take_result(message.text);
    if (message.tag != kFailed && !over())
      hand_out(message.rank);
    else
      waiting_.push_back(message.rank);
  }

  void take_result(const std::string& text) {
    auto answer = decode(text);
    if (!answer) {
      problem_ = "a rank sent a result that cannot be read";
      return;
    }
    std::erase(under_way_, answer->id);
    ++effort_.games;
    effort_.ticks += answer->result.statistics.ticks;
    effort_.core_seconds += static_cast<double>(answer->cost_ns) * 1e-9;
    if (auto kept = match::keep(schedule_, options_, answer->id, answer->result); !kept) {
      problem_ = kept.error();
    }
    if (options_.progress) options_.progress(schedule_, effort_);
  }

  // Assigns a new game. If there is none, the one that has been in progress for longest, whose rank
  // may be lost.
  void hand_out(int rank) {
    auto id = schedule_.next();
    if (!id && !under_way_.empty()) {
      id = under_way_.front();
      under_way_.pop_front();
    }
    if (!id) {
      waiting_.push_back(rank);
      return;
    }
    under_way_.push_back(*id);
    send(rank, kJob, encode(*id, schedule_.series()[id->series].desc()));
  }

  match::Schedule& schedule_;
  const match::ExecutorOptions& options_;
  const std::string& identity_;
  std::deque<JobId>& under_way_;
  std::vector<int>& waiting_;
  match::Effort effort_;
  std::string problem_;
};

}  // namespace

Coordinator::Coordinator(const std::vector<match::SeriesDesc>& series)
    : identity_(identity_of(series)) {
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  players_ = ranks - 1;
}

Coordinator::~Coordinator() {
  constexpr std::int64_t kPatience = 120'000'000'000;
  for (const int rank : waiting_) send(rank, kStop);
  for (int left = players_ - static_cast<int>(waiting_.size()); left > 0; --left) {
    const auto message = receive(kPatience);
    if (!message) return;
    send(message->rank, kStop);
  }
}

tl::expected<match::Effort, std::string> Coordinator::play_all(
    match::Schedule& schedule, const match::ExecutorOptions& options) {
  return Round(schedule, options, identity_, under_way_, waiting_).run();
}

int play(const std::vector<match::SeriesDesc>& series, const std::string& record_folder) {
  send(0, kIdle, identity_of(series));
  while (true) {
    const auto message = receive(INT64_MAX / 2);
    if (!message || message->tag != kJob) return 0;
    const auto [id, game] = decode(message->text, series);
    const std::int64_t before = os::thread_ns();
    auto result = match::play_job(game, id, record_folder);
    if (!result) {
      send(0, kFailed, result.error());
      continue;
    }
    send(0, kResult, encode({id, os::thread_ns() - before, *result}));
  }
}

}  // namespace ranks
