void AP_Grouser::update() {
  const int64_t now_ns = int64_t(AP_HAL::micros64()) * 1000;
  const AP_WheelEncoder &encoders = *AP::wheelencoder();
  for (uint8_t i = 0; i < encoders.num_sensors(); i++) {
    GrouserSample angle = {};
    angle.size = sizeof(angle);
    angle.kind = GROUSER_WHEEL_ANGLE;
    angle.time_ns = int64_t(encoders.get_last_reading_ms(i)) * 1000000;
    angle.wheel = i;
    angle.values[0] = double(encoders.get_delta_angle(i));
    grouser_push(_on_board, now_ns, &angle);
  }
  const Vector3f &accel = AP::ins().get_accel();
  const Vector3f &gyro = AP::ins().get_gyro();
  // forward, right, down becomes forward, left, up
  const double values[] = {accel.x, -accel.y, -accel.z, gyro.x, -gyro.y, -gyro.z};
  GrouserSample inertial = {};
  inertial.size = sizeof(inertial);
  inertial.kind = GROUSER_INERTIAL;
  inertial.time_ns = now_ns;
  memcpy(inertial.values, values, sizeof(values));
  grouser_push(_on_board, now_ns, &inertial);
  grouser_tick(_on_board, now_ns, double(_requested_speed), 0.0);
}
