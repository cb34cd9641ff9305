// Work on another thread. The window polls for its result each frame, or drops it if it is no
// longer needed. The work owns its data.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace watch {

template <class Outcome>
class Background {
 public:
  void start(std::function<Outcome()> work) {
    state_ = std::make_shared<State>();
    std::thread([state = state_, work = std::move(work)] {
      Outcome outcome = work();
      state->outcome.emplace(std::move(outcome));
      state->done.store(true, std::memory_order_release);
      state->done.notify_all();
    }).detach();
  }
  bool running() const { return state_ != nullptr; }
  void forget() { state_.reset(); }
  // Returns the result once, when it is ready.
  std::optional<Outcome> take() {
    if (!state_ || !state_->done.load(std::memory_order_acquire)) return std::nullopt;
    std::optional<Outcome> outcome = std::move(state_->outcome);
    state_.reset();
    return outcome;
  }
  // Precondition: running().
  void wait() const { state_->done.wait(false, std::memory_order_acquire); }

 private:
  struct State {
    std::optional<Outcome> outcome;
    std::atomic<bool> done{false};
  };
  std::shared_ptr<State> state_;
};

}  // namespace watch
