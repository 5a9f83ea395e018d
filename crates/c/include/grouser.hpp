// Grouser on the robot, for C++17: the functions of grouser.h with ownership, and errors instead of codes.
//
//   grouser::Robot robot(wheels);                     // throws grouser::Error
//   robot.wheel_angle(now_ns, stamp_ns, 0, 1.25);     // every reading, as it arrives
//   robot.tick(now_ns, 0.3);                          // at 20 to 200 Hz
//   auto left = robot.wheel(0);
//   if (left.health == GROUSER_HEALTH_OK) use(left.slip, left.slip_sigma);
//
// What a reading's call returns is false where the filter refused the reading; the estimate goes on. SI units and
// radians; x forwards, y to the left. Only the constructor allocates; it throws, as do calls that a program must not
// make (a wheel that is not there, a number that is none).
#ifndef GROUSER_HPP
#define GROUSER_HPP

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grouser.h"

namespace grouser {

/// A code other than GROUSER_OK, with the library's text where it has one.
class Error : public std::runtime_error {
 public:
  Error(std::int32_t code, const std::string &text) : std::runtime_error(text), code_(code) {}
  /// One of GROUSER_ERROR_*.
  std::int32_t code() const noexcept { return code_; }

 private:
  std::int32_t code_;
};

/// A struct of grouser.h with its size set and all else 0.
template <typename Struct>
Struct sized() {
  Struct made{};
  made.size = sizeof made;
  return made;
}

/// The settings that apply where none are given.
inline GrouserSettings default_settings() {
  auto settings = sized<GrouserSettings>();
  grouser_default_settings(&settings);
  return settings;
}

/// The software of one robot; it belongs to one thread at a time.
class Robot {
 public:
  explicit Robot(const std::vector<GrouserWheel> &wheels, const GrouserSettings &settings = default_settings()) {
    std::array<char, 256> text{};
    GrouserOnBoard *made = nullptr;
    const auto code = grouser_new(wheels.data(), wheels.size(), &settings, &made, text.data(), text.size());
    own(code, made, text.data());
  }

#ifndef GROUSER_BARE
  /// By the text of a robot file; not in the library for bare metal, where GROUSER_BARE is to be defined.
  static Robot from_toml(std::string_view file, const GrouserSettings &settings = default_settings()) {
    std::array<char, 256> text{};
    GrouserOnBoard *made = nullptr;
    const auto code = grouser_new_from_toml(file.data(), file.size(), &settings, &made, text.data(), text.size());
    return Robot(code, made, text.data());
  }
#endif

  std::size_t wheel_count() const {
    std::size_t count = 0;
    check(grouser_wheel_count(on_board_.get(), &count));
    return count;
  }

  /// A tick counter.
  bool wheel_count_reading(std::int64_t now_ns, std::int64_t stamp_ns, std::uint32_t wheel, std::uint64_t ticks) {
    auto sample = of_wheel(GROUSER_WHEEL_COUNT, stamp_ns, wheel);
    sample.raw = ticks;
    return push(now_ns, sample);
  }
  /// The angle of the sensor's shaft, unwrapped, rad.
  bool wheel_angle(std::int64_t now_ns, std::int64_t stamp_ns, std::uint32_t wheel, double angle_rad) {
    auto sample = of_wheel(GROUSER_WHEEL_ANGLE, stamp_ns, wheel);
    sample.values[0] = angle_rad;
    return push(now_ns, sample);
  }
  /// The rate of the sensor's shaft, rad/s.
  bool wheel_rate(std::int64_t now_ns, std::int64_t stamp_ns, std::uint32_t wheel, double rate_rad_per_s) {
    auto sample = of_wheel(GROUSER_WHEEL_RATE, stamp_ns, wheel);
    sample.values[0] = rate_rad_per_s;
    return push(now_ns, sample);
  }
  /// Torque on a wheel, N m, positive where it drives forwards.
  bool wheel_torque(std::int64_t now_ns, std::int64_t stamp_ns, std::uint32_t wheel, double torque_n_m) {
    auto sample = of_wheel(GROUSER_WHEEL_TORQUE, stamp_ns, wheel);
    sample.values[0] = torque_n_m;
    return push(now_ns, sample);
  }
  /// Specific force, m/s^2, and angular rate, rad/s, both forwards, left, up.
  bool inertial(std::int64_t now_ns, std::int64_t stamp_ns, const std::array<double, 3> &force,
                const std::array<double, 3> &rate) {
    return push(now_ns, of(GROUSER_INERTIAL, stamp_ns, {force[0], force[1], force[2], rate[0], rate[1], rate[2]}));
  }
  /// Pose in a fixed frame: m, m, rad.
  bool pose(std::int64_t now_ns, std::int64_t stamp_ns, double x_m, double y_m, double yaw_rad) {
    return push(now_ns, of(GROUSER_POSE, stamp_ns, {x_m, y_m, yaw_rad, 0.0, 0.0, 0.0}));
  }
  /// Place in a fixed frame without a heading, such as a fix or a tag: m, m.
  bool position(std::int64_t now_ns, std::int64_t stamp_ns, double x_m, double y_m) {
    return push(now_ns, of(GROUSER_POSITION, stamp_ns, {x_m, y_m, 0.0, 0.0, 0.0, 0.0}));
  }
  /// Speed over ground forwards, m/s, of a sensor that does not measure the wheels.
  bool speed(std::int64_t now_ns, std::int64_t stamp_ns, double forward_m_per_s) {
    return push(now_ns, of(GROUSER_SPEED, stamp_ns, {forward_m_per_s, 0.0, 0.0, 0.0, 0.0, 0.0}));
  }
  /// Any other reading.
  bool push(std::int64_t now_ns, const GrouserSample &sample) {
    const auto code = grouser_push(on_board_.get(), now_ns, &sample);
    if (code == GROUSER_SAMPLE_REFUSED) return false;
    check(code);
    return true;
  }

  /// A wheel is steered to the left of its heading from now on.
  void steer(std::uint32_t wheel, double angle_rad) {
    check(grouser_set_steering_angle(on_board_.get(), wheel, angle_rad));
  }
  /// Runs the control loop for a requested speed and heading.
  void tick(std::int64_t now_ns, double speed_m_per_s, double heading_rad = 0.0) {
    check(grouser_tick(on_board_.get(), now_ns, speed_m_per_s, heading_rad));
  }

  /// What is known of a wheel.
  GrouserWheelEstimate wheel(std::uint32_t wheel) const {
    auto out = sized<GrouserWheelEstimate>();
    check(grouser_wheel(on_board_.get(), wheel, &out));
    return out;
  }
  /// What is known of the robot.
  GrouserBodyEstimate body() const {
    auto out = sized<GrouserBodyEstimate>();
    check(grouser_body(on_board_.get(), &out));
    return out;
  }
  /// What a wheel's motor driver is to do.
  GrouserCommand command(std::uint32_t wheel) const {
    auto out = sized<GrouserCommand>();
    check(grouser_command(on_board_.get(), wheel, &out));
    return out;
  }

 private:
  Robot(std::int32_t code, GrouserOnBoard *made, const char *text) { own(code, made, text); }

  void own(std::int32_t code, GrouserOnBoard *made, const char *text) {
    on_board_.reset(made);
    if (code != GROUSER_OK) throw Error(code, *text != '\0' ? text : "the robot cannot be made");
  }
  static void check(std::int32_t code) {
    if (code != GROUSER_OK) throw Error(code, "grouser refuses the call with code " + std::to_string(code));
  }
  static GrouserSample of(std::uint32_t kind, std::int64_t stamp_ns, const std::array<double, 6> &values) {
    auto sample = sized<GrouserSample>();
    sample.kind = kind;
    sample.time_ns = stamp_ns;
    for (std::size_t i = 0; i < values.size(); ++i) sample.values[i] = values[i];
    return sample;
  }
  static GrouserSample of_wheel(std::uint32_t kind, std::int64_t stamp_ns, std::uint32_t wheel) {
    auto sample = of(kind, stamp_ns, {});
    sample.wheel = wheel;
    return sample;
  }
  struct Free {
    void operator()(GrouserOnBoard *on_board) const noexcept { grouser_free(on_board); }
  };
  std::unique_ptr<GrouserOnBoard, Free> on_board_;
};

}  // namespace grouser

#endif
