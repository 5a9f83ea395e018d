// The part of ros2_control's interfaces (Humble to Jazzy) that the adapter of docs/adapters.md uses, declared alone.
#pragma once
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "grouser.hpp"

#define RCLCPP_ERROR(logger, ...) (void)(logger), (void)std::snprintf(nullptr, 0, __VA_ARGS__)

namespace rclcpp {
class Time {
 public:
  std::int64_t nanoseconds() const;
};
class Duration {};
class Logger {};
class Parameter {
 public:
  std::string as_string() const;
};
}  // namespace rclcpp

namespace rclcpp_lifecycle {
class State {};
class LifecycleNode {
 public:
  rclcpp::Parameter get_parameter(const std::string &name) const;
  rclcpp::Logger get_logger() const;
};
}  // namespace rclcpp_lifecycle

namespace hardware_interface {
class LoanedStateInterface {
 public:
  double get_value() const;
};
class LoanedCommandInterface {
 public:
  void set_value(double value);
};
}  // namespace hardware_interface

namespace controller_interface {
enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };
class ChainableControllerInterface {
 public:
  virtual ~ChainableControllerInterface() = default;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &previous) = 0;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const;

 protected:
  virtual return_type update_and_write_commands(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;
  std::vector<double> reference_interfaces_;
};
}  // namespace controller_interface

using controller_interface::CallbackReturn;

struct WheelInterfaces {
  hardware_interface::LoanedStateInterface &position;
  hardware_interface::LoanedCommandInterface &velocity;
  double radius_m;
};

class SlipLimiter : public controller_interface::ChainableControllerInterface {
 public:
  CallbackReturn on_configure(const rclcpp_lifecycle::State &previous) override;

 protected:
  controller_interface::return_type update_and_write_commands(const rclcpp::Time &time,
                                                              const rclcpp::Duration &period) override;

 private:
  std::vector<WheelInterfaces> wheels_;
  std::unique_ptr<grouser::Robot> robot_;
};
