/* What six wheels take, bytes: the peak use of the stack of new, and of push and tick, on a painted stack of their own;
 * and the memory that new keeps. */
#include <malloc.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grouser.h"

enum { STACK_BYTES = 1 << 20, PAINT = 0xA5, WHEELS = 6 };

static GrouserOnBoard *on_board;

static void *create(void *unused) {
  GrouserWheel wheels[WHEELS];
  memset(wheels, 0, sizeof wheels);
  for (int i = 0; i < WHEELS; ++i) {
    wheels[i] = (GrouserWheel){.size = sizeof wheels[i], .role = i < 5 ? GROUSER_POWERED : GROUSER_FREE, .x_m = 0.1 * i,
                               .y_m = i % 2 ? 0.2 : -0.2, .radius_m = 0.1, .load_n = 40, .gear = 1, .ticks_per_turn = 1000,
                               .counter_bits = 16};
  }
  GrouserSettings settings = {.size = sizeof settings};
  grouser_default_settings(&settings);
  settings.warm_up_s = 0;
  if (grouser_new(wheels, WHEELS, &settings, &on_board, NULL, 0) != GROUSER_OK) exit(1);
  return unused;
}

static void *cycle(void *unused) {
  for (int step = 0; step < 500; ++step) {
    int64_t now = step * INT64_C(10000000);
    for (uint32_t i = 0; i < WHEELS; ++i) {
      GrouserSample count = {.size = sizeof count, .kind = GROUSER_WHEEL_COUNT, .time_ns = now, .wheel = i};
      count.raw = (uint64_t)(i < 5 ? 5 * step : 4 * step);
      if (grouser_push(on_board, now, &count) != GROUSER_OK) exit(1);
    }
    GrouserSample inertial = {.size = sizeof inertial, .kind = GROUSER_INERTIAL, .time_ns = now};
    inertial.values[2] = 9.81;
    grouser_push(on_board, now, &inertial);
    grouser_tick(on_board, now, 0.3, 0);
  }
  return unused;
}

static void *nothing(void *unused) { return unused; }

static long peak(void *(*job)(void *)) {
  unsigned char *stack = aligned_alloc(4096, STACK_BYTES);
  memset(stack, PAINT, STACK_BYTES);
  pthread_attr_t attributes;
  pthread_t thread;
  pthread_attr_init(&attributes);
  if (pthread_attr_setstack(&attributes, stack, STACK_BYTES) || pthread_create(&thread, &attributes, job, NULL)) exit(1);
  pthread_join(thread, NULL);
  long unused = 0;
  while (unused < STACK_BYTES && stack[unused] == PAINT) ++unused;
  free(stack);
  return STACK_BYTES - unused;
}

int main(void) {
  long thread = peak(nothing);
  size_t before = mallinfo2().uordblks;
  long new_ = peak(create);
  size_t memory = mallinfo2().uordblks - before;
  long run = peak(cycle);
  printf("%ld %ld %zu\n", new_ - thread, run - thread, memory);
  grouser_free(on_board);
  return 0;
}
