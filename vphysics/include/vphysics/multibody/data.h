// The mutable state of a model's algorithms: their working memory and their results.
//
// The constructor allocates all memory; the algorithms allocate none. One data is used by one
// thread at a time. DataT<PackT<double, 8>> contains eight states: the same calls then process all
// of them, and each number of q, v and tau is a pack.
#pragma once

#include <memory>

#include "vphysics/lie/pack.h"
#include "vphysics/multibody/model.h"

namespace vp {

namespace detail {
template <class T>
struct Work;
}

// How results are rounded.
enum class Arithmetic {
  // Uses the widest registers and the fused multiply-add of the machine. Results are identical in
  // every run on one machine and build; the last bits may differ on another.
  fastest,
  // The same bits on every machine and compiler, as lockstep, rollback and replays need. World
  // always uses it.
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
