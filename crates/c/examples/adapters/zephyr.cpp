#define GROUSER_BARE
#include "grouser.hpp"

void loop(grouser::Robot &robot, k_msgq *readings) {
  GrouserSample sample;
  for (;;) {
    const auto until = k_uptime_ticks() + k_ms_to_ticks_ceil64(10);
    while (k_msgq_get(readings, &sample, K_TIMEOUT_ABS_TICKS(until)) == 0)
      robot.push(now_ns(), sample);
    robot.tick(now_ns(), requested_speed());
  }
}
