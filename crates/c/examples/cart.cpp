// A cart with two powered wheels and a free one: the powered rims run at 0.25 m/s, the cart at 0.2 m/s.
// Prints slip and sigma of the powered wheels. Exit codes: 0 done, 1 an error, which is printed.
#include <array>
#include <cstdio>

#include "grouser.hpp"

namespace {

constexpr double RADIUS_M = 0.1;
constexpr double TICKS_PER_TURN = 1000.0;

GrouserWheel wheel(std::uint32_t role, double x_m, double y_m) {
  auto wheel = grouser::sized<GrouserWheel>();
  wheel.role = role;
  wheel.x_m = x_m;
  wheel.y_m = y_m;
  wheel.radius_m = RADIUS_M;
  wheel.load_n = 40.0;
  wheel.gear = 1.0;
  wheel.ticks_per_turn = TICKS_PER_TURN;
  wheel.counter_bits = 16;
  return wheel;
}

void run() {
  auto settings = grouser::default_settings();
  settings.warm_up_s = 0.0;
  grouser::Robot robot(
      {wheel(GROUSER_POWERED, 0.3, 0.2), wheel(GROUSER_POWERED, 0.3, -0.2), wheel(GROUSER_FREE, -0.4, 0.0)}, settings);
  const double tick_m = RADIUS_M * 6.283185307179586 / TICKS_PER_TURN;
  const std::array<double, 3> speeds{0.25, 0.25, 0.2};
  for (int step = 0; step < 1000; ++step) {
    const std::int64_t now_ns = step * 10'000'000LL;
    for (std::uint32_t index = 0; index < speeds.size(); ++index) {
      const auto ticks = static_cast<std::uint16_t>(speeds[index] * 0.01 * step / tick_m);
      robot.wheel_count_reading(now_ns, now_ns, index, ticks);
    }
    auto yaw_rate = grouser::sized<GrouserSample>();
    yaw_rate.kind = GROUSER_YAW_RATE;
    yaw_rate.time_ns = now_ns;
    robot.push(now_ns, yaw_rate);
    robot.tick(now_ns, 0.2);
  }
  for (std::uint32_t index = 0; index < 2; ++index) {
    const auto estimate = robot.wheel(index);
    if ((estimate.known & GROUSER_KNOWS_SLIP) != 0)
      std::printf("%.3f %.3f %u\n", estimate.slip, estimate.slip_sigma, estimate.health);
  }
}

}  // namespace

int main() {
  try {
    run();
  } catch (const std::exception &error) {
    std::fprintf(stderr, "cart: %s\n", error.what());
    return 1;
  }
}
