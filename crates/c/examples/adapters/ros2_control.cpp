CallbackReturn SlipLimiter::on_configure(const rclcpp_lifecycle::State &) {
  try {
    std::ifstream file(get_node()->get_parameter("robot_file").as_string());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    robot_ = std::make_unique<grouser::Robot>(grouser::Robot::from_toml(text));
  } catch (const grouser::Error &error) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

controller_interface::return_type SlipLimiter::update_and_write_commands(
    const rclcpp::Time &time, const rclcpp::Duration &) {
  const std::int64_t now_ns = time.nanoseconds();
  for (std::uint32_t i = 0; i < wheels_.size(); ++i)
    robot_->wheel_angle(now_ns, now_ns, i, wheels_[i].position.get_value());
  robot_->tick(now_ns, reference_interfaces_[0]);
  for (std::uint32_t i = 0; i < wheels_.size(); ++i)
    wheels_[i].velocity.set_value(robot_->command(i).rim_speed_m_per_s / wheels_[i].radius_m);
  return controller_interface::return_type::OK;
}
