// A cart with two powered wheels and a free one: the powered rims run at 0.25 m/s, the cart at 0.2 m/s.
// Prints slip and sigma of the powered wheels. Exit codes: 0 done, 1 an error, which is printed.
#include <array>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <vector>

#include "grouser.h"

namespace {

GrouserWheel wheel(std::uint32_t role, double x_m, double y_m) {
  GrouserWheel wheel{};
  wheel.size = sizeof wheel;
  wheel.role = role;
  wheel.x_m = x_m;
  wheel.y_m = y_m;
  wheel.radius_m = 0.1;
  wheel.load_n = 40.0;
  wheel.gear = 1.0;
  wheel.ticks_per_turn = 1000;
  wheel.counter_bits = 16;
  return wheel;
}

struct Free {
  void operator()(GrouserOnBoard *on_board) const { grouser_free(on_board); }
};
using OnBoard = std::unique_ptr<GrouserOnBoard, Free>;

OnBoard make(const std::vector<GrouserWheel> &wheels) {
  GrouserSettings settings{};
  settings.size = sizeof settings;
  grouser_default_settings(&settings);
  settings.warm_up_s = 0.0;
  std::array<char, 256> message{};
  GrouserOnBoard *on_board = nullptr;
  if (grouser_new(wheels.data(), wheels.size(), &settings, &on_board, message.data(), message.size()) != GROUSER_OK)
    throw std::runtime_error(message.data());
  return OnBoard(on_board);
}

void run() {
  const std::vector<GrouserWheel> wheels{wheel(GROUSER_POWERED, 0.3, 0.2), wheel(GROUSER_POWERED, 0.3, -0.2),
                                         wheel(GROUSER_FREE, -0.4, 0.0)};
  const OnBoard on_board = make(wheels);
  const double tick_m = 0.1 * 6.283185307179586 / 1000.0;
  const std::array<double, 3> speeds{0.25, 0.25, 0.2};
  for (int step = 0; step < 1000; ++step) {
    const std::int64_t now_ns = step * 10'000'000LL;
    for (std::uint32_t index = 0; index < wheels.size(); ++index) {
      GrouserSample sample{};
      sample.size = sizeof sample;
      sample.kind = GROUSER_WHEEL_COUNT;
      sample.time_ns = now_ns;
      sample.wheel = index;
      sample.raw = static_cast<std::uint16_t>(speeds[index] * 0.01 * step / tick_m);
      grouser_push(on_board.get(), now_ns, &sample);
    }
    GrouserSample yaw_rate{};
    yaw_rate.size = sizeof yaw_rate;
    yaw_rate.kind = GROUSER_YAW_RATE;
    yaw_rate.time_ns = now_ns;
    grouser_push(on_board.get(), now_ns, &yaw_rate);
    grouser_tick(on_board.get(), now_ns, 0.2, 0.0);
  }
  for (std::uint32_t index = 0; index < 2; ++index) {
    GrouserWheelEstimate estimate{};
    estimate.size = sizeof estimate;
    if (grouser_wheel(on_board.get(), index, &estimate) == GROUSER_OK && (estimate.known & GROUSER_KNOWS_SLIP) != 0)
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
