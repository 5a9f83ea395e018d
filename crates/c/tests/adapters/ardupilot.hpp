// The part of ArduPilot's interfaces that the adapter of docs/adapters.md uses, declared alone.
#pragma once
#include <stdint.h>
#include <string.h>

#define GROUSER_BARE
#include "grouser.h"

struct Vector3f {
  float x, y, z;
};

class AP_WheelEncoder {
 public:
  uint8_t num_sensors() const;
  float get_delta_angle(uint8_t instance) const;
  uint32_t get_last_reading_ms(uint8_t instance) const;
};

class AP_InertialSensor {
 public:
  const Vector3f &get_accel() const;
  const Vector3f &get_gyro() const;
};

namespace AP {
AP_WheelEncoder *wheelencoder();
AP_InertialSensor &ins();
}  // namespace AP

namespace AP_HAL {
uint64_t micros64();
}

class AP_Grouser {
 public:
  void update();

 private:
  GrouserOnBoard *_on_board;
  float _requested_speed;
};
