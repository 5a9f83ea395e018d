// The part of Zephyr's kernel that the adapter of docs/adapters.md uses, declared alone.
#pragma once
#include <cstdint>

struct k_msgq;
struct k_timeout_t {
  std::int64_t ticks;
};

std::int64_t k_uptime_ticks();
std::uint64_t k_ms_to_ticks_ceil64(std::uint64_t ms);
k_timeout_t K_TIMEOUT_ABS_TICKS(std::uint64_t ticks);
int k_msgq_get(k_msgq *queue, void *data, k_timeout_t timeout);

// of the firmware
std::int64_t now_ns();
double requested_speed();
