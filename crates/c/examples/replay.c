/* Replays the log of the five-wheeled robot and prints the slip of every wheel.
 *   replay examples/five-wheel/robot.toml examples/five-wheel/log.csv
 * Exit codes: 0 done, 1 a library of another version, 2 a file that cannot be used. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "grouser.h"

static int fail(const char *text) { fprintf(stderr, "replay: %s\n", text); return 2; }

int main(int argc, char **argv) {
  static char text[1 << 16], line[512], message[256];
  if (grouser_abi() != GROUSER_ABI) return 1;
  FILE *robot = argc == 3 ? fopen(argv[1], "rb") : NULL, *log = argc == 3 ? fopen(argv[2], "r") : NULL;
  if (!robot || !log) return fail("two readable files are needed: robot.toml log.csv");
  size_t length = fread(text, 1, sizeof text, robot);

  GrouserSettings settings = {.size = sizeof settings};
  grouser_default_settings(&settings);
  settings.warm_up_s = 0; /* there is no inertial unit whose attitude would have to be found */
  const GrouserFilterSetting in_order = {"horizon", 0}; /* a log is in the order of time */
  settings.filter = &in_order;
  settings.filter_count = 1;
  GrouserOnBoard *on_board = NULL;
  if (grouser_new_from_toml(text, length, &settings, &on_board, message, sizeof message) != GROUSER_OK)
    return fail(message);
  size_t wheels = 0;
  grouser_wheel_count(on_board, &wheels);

  unsigned refused = 0;
  if (!fgets(line, sizeof line, log)) return fail("the log is empty");
  while (fgets(line, sizeof line, log)) { /* time_ms, one counter per wheel, yaw rate */
    char *next = line;
    int64_t now = strtoll(next, &next, 10) * 1000000;
    uint64_t counts[8];
    for (uint32_t i = 0; i < wheels; ++i) counts[i] = (uint64_t)strtoll(next + 1, &next, 10);
    GrouserSample yaw = {.size = sizeof yaw, .kind = GROUSER_YAW_RATE, .time_ns = now};
    yaw.values[0] = strtod(next + 1, &next);
    refused += grouser_push(on_board, now, &yaw) != GROUSER_OK;
    for (uint32_t i = 0; i < wheels; ++i) {
      GrouserSample count = {.size = sizeof count, .kind = GROUSER_WHEEL_COUNT, .time_ns = now, .wheel = i};
      count.raw = counts[i];
      refused += grouser_push(on_board, now, &count) != GROUSER_OK;
    }
    printf("%" PRId64, now);
    for (uint32_t i = 0; i < wheels; ++i) {
      GrouserWheelEstimate wheel = {.size = sizeof wheel};
      if (grouser_wheel(on_board, i, &wheel) == GROUSER_OK && wheel.known & GROUSER_KNOWS_SLIP)
        printf(",%.17g,%.17g,%" PRIu32, wheel.slip, wheel.slip_sigma, wheel.health);
      else
        printf(",,,%" PRIu32, wheel.health);
    }
    printf("\n");
  }
  grouser_free(on_board);
  fclose(robot);
  fclose(log);
  return refused ? fail("samples were refused") : 0;
}
