#include "states.h"

#include "random.h"

namespace vp::bench {

std::vector<State> random_states(const BenchModel& model, int count, std::uint64_t seed) {
  test::Random random(seed);
  std::vector<State> states(static_cast<std::size_t>(count));
  for (State& s : states) {
    if (model.free_base) {
      const Vec3 p = random.in_cube(1.0);
      const Quaternion turn = to_quaternion(random.rotation());
      s.q = {p.x, p.y, p.z, turn.x, turn.y, turn.z, turn.w};
    }
    const std::size_t joints = model.links.size() - (model.free_base ? 1 : 0);
    for (std::size_t i = 0; i < joints; ++i) s.q.push_back(random.uniform(-kPi, kPi));
    for (int i = 0; i < model.velocities(); ++i) {
      s.v.push_back(random.uniform(-1, 1));
      s.tau.push_back(random.uniform(-1, 1));
      s.a.push_back(random.uniform(-1, 1));
    }
  }
  return states;
}

SE3 base_pose(const State& s) {
  return {from_quaternion(Quaternion{s.q[3], s.q[4], s.q[5], s.q[6]}), {s.q[0], s.q[1], s.q[2]}};
}

namespace {

Vec3 three(std::span<const double> x, std::size_t i) {
  return {x[i], x[i + 1], x[i + 2]};
}
void put(std::span<double> x, std::size_t i, const Vec3& a) {
  x[i] = a.x, x[i + 1] = a.y, x[i + 2] = a.z;
}

}  // namespace

BaseMap::BaseMap(BaseConvention convention, const State& state)
    : as(convention), R(base_pose(state).rotation()), w(three(state.v, 0)), v(three(state.v, 3)) {}

void BaseMap::to(std::span<double> x) const {
  const Vec3 angular = three(x, 0), linear = three(x, 3);
  put(x, as.linear_first ? 3 : 0, as.angular_in_world ? R * angular : angular);
  put(x, as.linear_first ? 0 : 3, as.linear_in_world ? R * linear : linear);
}

void BaseMap::from(std::span<double> x) const {
  const Vec3 angular = three(x, as.linear_first ? 3 : 0),
             linear = three(x, as.linear_first ? 0 : 3);
  put(x, 0, as.angular_in_world ? transposed_times(R, angular) : angular);
  put(x, 3, as.linear_in_world ? transposed_times(R, linear) : linear);
}

void BaseMap::acceleration_to(std::span<double> x) const {
  if (as.linear_in_world) put(x, 3, three(x, 3) + cross(w, v));
  to(x);
}

void BaseMap::acceleration_from(std::span<double> x) const {
  from(x);
  if (as.linear_in_world) put(x, 3, three(x, 3) - cross(w, v));
}

void BaseMap::mass_from(std::span<double> M, int n) const {
  const auto size = static_cast<std::size_t>(n);
  for (std::size_t row = 0; row < size; ++row) from(M.subspan(row * size, 6));
  for (std::size_t column = 0; column < size; ++column) {
    double x[6];
    for (std::size_t i = 0; i < 6; ++i) x[i] = M[i * size + column];
    from(x);
    for (std::size_t i = 0; i < 6; ++i) M[i * size + column] = x[i];
  }
}

}  // namespace vp::bench
