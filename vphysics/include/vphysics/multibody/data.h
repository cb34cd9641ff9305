// What changes while a model moves: the memory in which an algorithm works, and what it leaves
// there.
//
// All of it is taken when the data is made; no call takes more. One data is used by one thread at a
// time. DataT<PackT<double, 8>> holds eight states at once: the same calls then work on all of
// them, and every number of q, v and tau is a pack.
#pragma once

#include <memory>

#include "vphysics/lie/pack.h"
#include "vphysics/multibody/model.h"

namespace vp {

namespace detail {
template <class T>
struct Work;
}

// How a data's results are rounded.
enum class Arithmetic {
  // With the widest registers and the fused multiply-add that the machine has: the same bits in
  // every run on one machine and build, the last bits may differ on another.
  fastest,
  // The same bits on every machine and compiler, as lockstep, rollback and replays need. World
  // always computes so.
  reproducible
};

template <class T>
class DataT {
 public:
  explicit DataT(const ModelT<base_t<T>>& model, Arithmetic arithmetic = Arithmetic::fastest);
  ~DataT();
  DataT(DataT&&) noexcept;
  DataT& operator=(DataT&&) noexcept;

  detail::Work<T>& work() { return *work_; }
  const detail::Work<T>& work() const { return *work_; }

 private:
  std::unique_ptr<detail::Work<T>> work_;
};

using Data = DataT<double>;

}  // namespace vp
