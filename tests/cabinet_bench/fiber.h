// A coroutine with a separate stack. Many simulated people run on one thread, in a deterministic
// order.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <exception>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace cabinet_bench {

class Fiber {
 public:
  // work begins with the first resume().
  explicit Fiber(std::function<void()> work) : work_(std::move(work)), stack_(kStackBytes) {
    if (::getcontext(&own_) != 0) throw std::runtime_error("no context for a fiber");
    own_.uc_stack.ss_sp = stack_.data();
    own_.uc_stack.ss_size = stack_.size();
    own_.uc_link = &caller_;
    ::makecontext(&own_, &Fiber::begin, 0);
  }
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  bool done() const { return done_; }
  // Runs until it yields or is done; rethrows what the work has thrown. Precondition: not done().
  void resume() {
    Fiber* const before = std::exchange(running(), this);
    ::swapcontext(&caller_, &own_);
    running() = before;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  // Yields to the caller of resume(); call from within work.
  void give_way() { ::swapcontext(&own_, &caller_); }

 private:
  static constexpr std::size_t kStackBytes = 256 * 1024;

  static Fiber*& running() {
    static thread_local Fiber* fiber = nullptr;
    return fiber;
  }
  static void begin() {
    Fiber& fiber = *running();
    try {
      fiber.work_();
    } catch (...) {
      fiber.failure_ = std::current_exception();
    }
    fiber.done_ = true;
  }

  std::function<void()> work_;
  std::vector<std::byte> stack_;
  ucontext_t own_{}, caller_{};
  bool done_ = false;
  std::exception_ptr failure_;
};

}  // namespace cabinet_bench
