#include "results_log.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <semaphore>
#include <span>
#include <utility>
#include <variant>

#include "os/capabilities.h"
#include "results/store.h"
#include "server/spsc_queue.h"

namespace server {

class ResultsLog::Keeper {
 public:
  explicit Keeper(const ResultsLogOptions& options) : options_(options) {}

  struct Entry {
    std::uint32_t number = 0;
    std::variant<results::MatchResult, results::Answers> what;
  };

  // Tick thread. A semaphore's release() never blocks.
  bool add(Entry&& entry) {
    const bool taken = incoming_.push(std::move(entry));
    if (!taken) lost_.fetch_add(1, std::memory_order_relaxed);
    wake_.release();
    return taken;
  }
  void close() {
    closing_.store(true, std::memory_order_release);
    wake_.release();
  }

  bool problem_changed(wire::Sentence& problem) {
    const std::unique_lock guard(mutex_, std::try_to_lock);
    if (!guard || problem_ == last_reported_) return false;
    last_reported_ = problem = problem_;
    return true;
  }

  // Any thread.
  void set_problem(const wire::Sentence& problem) {
    const std::lock_guard guard(mutex_);
    problem_ = problem;
  }
  std::string problem() const {
    const std::lock_guard guard(mutex_);
    const auto lost = lost_.load(std::memory_order_relaxed);
    const std::string& said = problem_.text();
    if (lost == 0) return said;
    return said + (said.empty() ? "" : "; ") + std::to_string(lost) + " results are lost";
  }
  bool report_changed(Report& report) {
    if (!reported_.load(std::memory_order_acquire)) return false;
    const std::unique_lock guard(mutex_, std::try_to_lock);
    if (!guard) return false;
    reported_.store(false, std::memory_order_relaxed);
    report = std::move(report_);
    report_ = {};
    return true;
  }
  std::uint64_t kept() const { return kept_.load(std::memory_order_relaxed); }
  std::uint64_t answers() const { return answers_.load(std::memory_order_relaxed); }

  // The results thread.
  void run() {
    keep();  // opens the file, so that an error is reported at once
    bool closing = false;
    while (!closing) {
      if (waiting_.empty()) {
        wake_.acquire();
      } else {
        (void)wake_.try_acquire_for(options_.retry_period);
      }
      closing = closing_.load(std::memory_order_acquire);
      keep();
    }
  }

 private:
  void keep();
  void report(std::uint32_t number);
  tl::expected<std::int64_t, std::string> keep(const Entry& entry);

  const ResultsLogOptions options_;
  SpscQueue<Entry, kWaiting> incoming_;
  std::counting_semaphore<> wake_{0};
  std::atomic<bool> closing_{false};
  std::atomic<std::uint64_t> kept_{0}, answers_{0}, lost_{0};
  std::atomic<bool> reported_{false};
  mutable std::mutex mutex_;
  Report report_;                           // not taken by the tick yet
  wire::Sentence problem_, last_reported_;  // last_reported_: to the tick
  // Used by the results thread only.
  std::optional<results::Store> store_;
  std::deque<Entry> waiting_;
  // The last matches by number: their id in the store, and the rods that have answered.
  struct Kept {
    std::int64_t id;
    std::uint32_t answered = 0;  // rods
  };
  std::map<std::uint32_t, Kept> matches_;
};

// An error concerns the file. An entry with invalid content is dropped here: the store would reject
// it again and again, and it would block the entries behind it.
tl::expected<std::int64_t, std::string> ResultsLog::Keeper::keep(const Entry& entry) {
  const auto lose = [this] {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return 0;
  };
  if (const auto* result = std::get_if<results::MatchResult>(&entry.what)) {
    if (!problem_with(*result).empty()) return lose();
    auto id = store_->add(*result);
    if (!id) return id;
    matches_[entry.number] = {*id};
    if (matches_.size() > kWaiting) matches_.erase(matches_.begin());
    kept_.fetch_add(1, std::memory_order_relaxed);
    report(entry.number);
    return id;
  }
  results::Answers answers = std::get<results::Answers>(entry.what);
  const auto match = matches_.find(entry.number);
  if (match == matches_.end() || !problem_with(answers).empty()) return lose();
  if ((match->second.answered & answers.rods) != 0) return lose();
  answers.match = match->second.id;
  auto id = store_->add(answers);
  if (!id) return id;
  match->second.answered |= answers.rods;
  answers_.fetch_add(1, std::memory_order_relaxed);
  return id;
}

// Data that cannot be read is not reported: play goes on without it.
void ResultsLog::Keeper::report(std::uint32_t number) {
  const auto matches = store_->matches({.player = {}, .newest = kRated});
  if (!matches || matches->empty()) return;
  Report report;
  report.number = number;
  report.match = matches->back();
  report.fame = results::standings(*matches);
  const auto before = results::standings(std::span(*matches).first(matches->size() - 1));
  for (std::size_t t = 0; t < report.rating.size(); ++t) {
    report.rating[t] = results::rating_of(report.match.teams[t], report.fame);
    report.change[t] = report.rating[t] - results::rating_of(report.match.teams[t], before);
  }
  std::erase_if(report.fame, [](const results::Standing& one) { return one.matches == 0; });
  if (report.fame.size() > kFame) report.fame.resize(kFame);
  const std::lock_guard guard(mutex_);
  report_ = std::move(report);
  reported_.store(true, std::memory_order_release);
}

// A store that has failed is closed and opened again the next time: the file may be another one
// then.
void ResultsLog::Keeper::keep() {
  if (!store_) {
    auto opened = results::Store::open(options_.path, results::Access::create);
    if (opened) {
      store_ = std::move(*opened);
      if (matches_.empty()) report(0);
    } else {
      set_problem(wire::make_sentence<wire::SentenceId::results_not_kept>(opened.error()));
    }
  }
  Entry entry;
  while (waiting_.size() < kWaiting && incoming_.pop(entry)) waiting_.push_back(std::move(entry));
  while (store_ && !waiting_.empty()) {
    const auto id = keep(waiting_.front());
    if (!id) {
      set_problem(wire::make_sentence<wire::SentenceId::results_not_kept>(id.error()));
      store_.reset();
      return;
    }
    waiting_.pop_front();
  }
  if (store_) set_problem(wire::Sentence());
}

ResultsLog::ResultsLog(const ResultsLogOptions& options)
    : path_(options.path),
      close_patience_(options.close_patience),
      keeper_(std::make_shared<Keeper>(options)) {
  std::promise<void> end;
  ended_ = end.get_future();
  thread_ = std::thread([keeper = keeper_, end = std::move(end)]() mutable {
    os::drop_capabilities(true);  // it reopens its file after a failure
    keeper->run();
    end.set_value();
  });
}

ResultsLog::~ResultsLog() {
  close();
}

bool ResultsLog::add(results::MatchResult result, std::uint32_t number) {
  return keeper_->add({number, std::move(result)});
}
bool ResultsLog::answer(const results::Answers& answers, std::uint32_t number) {
  return keeper_->add({number, answers});
}

void ResultsLog::close() {
  if (!thread_.joinable()) return;
  keeper_->close();
  if (ended_.wait_for(close_patience_) == std::future_status::ready) {
    thread_.join();
  } else {
    keeper_->set_problem(wire::make_sentence<wire::SentenceId::results_problem>(
        path_, "the file did not answer in time; some may be missing"));
    thread_.detach();
  }
}

bool ResultsLog::report_changed(Report& report) {
  return keeper_->report_changed(report);
}
bool ResultsLog::problem_changed(wire::Sentence& problem) {
  return keeper_->problem_changed(problem);
}
std::string ResultsLog::problem() const {
  return keeper_->problem();
}
std::uint64_t ResultsLog::kept() const {
  return keeper_->kept();
}
std::uint64_t ResultsLog::answers() const {
  return keeper_->answers();
}

}  // namespace server
