/*
 * Grouser on the robot: samples in, slips and wheel commands out.
 *
 *   GrouserOnBoard *robot = NULL;
 *   char text[200];
 *   if (grouser_new(wheels, 5, NULL, &robot, text, sizeof text) != GROUSER_OK) ...
 *   grouser_push(robot, now_ns, &sample);      every sample, as it arrives
 *   grouser_tick(robot, now_ns, 0.3, 0.0);     at 20 to 200 Hz
 *   grouser_wheel(robot, 0, &wheel);           slip, sigma, health
 *   grouser_command(robot, 0, &command);       what the motor driver is to do
 *   grouser_free(robot);
 *
 * Every struct begins with its own size, which the caller sets: GrouserSample sample = {sizeof sample, ...}.
 * Every function but grouser_abi and grouser_free returns GROUSER_OK or one of the codes below. Where it
 * is not GROUSER_OK, nothing has been written through `out`, except that grouser_new sets it to NULL.
 * Only grouser_new allocates. No function reads a clock: time is an argument, in nanoseconds with any zero.
 * Two threads may use two objects at once, but not one object. No function may be called from an
 * interrupt that can interrupt another one with the same object.
 * SI units and radians; x forwards, y to the left, angles from x towards y.
 */
#ifndef GROUSER_H
#define GROUSER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. It grows with every change of a struct, a constant or a function. */
#define GROUSER_ABI 2u

/* Done. */
#define GROUSER_OK 0
/* A pointer is NULL or not aligned for its type. */
#define GROUSER_ERROR_POINTER 1
/* A struct's size is not that of this version of the library, or an array has a wrong number of elements. */
#define GROUSER_ERROR_SIZE 2
/* A number is NaN, infinite or no value of its enumeration. */
#define GROUSER_ERROR_VALUE 3
/* The robot or a setting cannot be used; the message names field, value, limit and unit. */
#define GROUSER_ERROR_DESCRIPTION 4
/* The filter refused the sample, or one that waited to be put in order before it; the body's counters
   have the reason. */
#define GROUSER_SAMPLE_REFUSED 5
/* The robot has no such wheel. */
#define GROUSER_ERROR_WHEEL 6
/* An error of the library. The object cannot be used any more, but for grouser_free. */
#define GROUSER_ERROR_INTERNAL 7

/* A motor turns the wheel. */
#define GROUSER_POWERED 0u
/* The wheel rolls freely. */
#define GROUSER_FREE 1u

/* The encoder sits on the motor's shaft. */
#define GROUSER_ENCODER_ON_MOTOR 1u
/* The encoder counts down when the wheel drives forwards. */
#define GROUSER_ENCODER_REVERSED 2u

/* A contradiction between sensors and description at the start is reported. */
#define GROUSER_START_REPORT 0u
/* The sensors are not checked at the start. */
#define GROUSER_START_OFF 1u
/* The robot does not drive before the check, nor after a contradiction. */
#define GROUSER_START_REFUSE 2u

/* A tick counter: wheel, raw. */
#define GROUSER_WHEEL_COUNT 1u
/* An edge of an encoder: wheel, raw 1 forwards, 0 backwards. */
#define GROUSER_WHEEL_EDGE 2u
/* Angle of the sensor's shaft, unwrapped: wheel, rad. */
#define GROUSER_WHEEL_ANGLE 3u
/* Rate of the sensor's shaft: wheel, rad/s. */
#define GROUSER_WHEEL_RATE 4u
/* Yaw rate, rad/s, left positive. */
#define GROUSER_YAW_RATE 5u
/* Displacement since the last sample of this kind: forwards m, left m, turn rad if GROUSER_HAS_TURN. */
#define GROUSER_DISPLACEMENT 6u
/* Pose in a fixed frame: x m, y m, yaw rad. */
#define GROUSER_POSE 7u
/* Speed over ground: forwards m/s, left m/s if GROUSER_HAS_LEFT. */
#define GROUSER_SPEED 8u
/* Specific force, m/s^2, and angular rate, rad/s; both forwards, left, up. */
#define GROUSER_INERTIAL 9u
/* Angle of a joint of the suspension: wheel is the joint's index; rad, nose down positive. */
#define GROUSER_JOINT_ANGLE 10u
/* A motor's current over its greatest: wheel, 1. */
#define GROUSER_MOTOR_CURRENT 11u
/* Torque on a wheel: wheel, N m, positive when it drives forwards. */
#define GROUSER_WHEEL_TORQUE 12u
/* Specific force on the level: forwards, left, m/s^2. */
#define GROUSER_ACCELERATION 13u
/* Place in a fixed frame without a heading, such as a fix or a tag: x m, y m. */
#define GROUSER_POSITION 14u
/* Angle by which a wheel is steered beside its heading: wheel, rad, left positive. */
#define GROUSER_STEERING_ANGLE 15u
/* Depth of a wheel's lowest point below the ground in front of it: wheel, m. */
#define GROUSER_SINKAGE 16u
/* Angle from a wheel's lowest point to where the ground in front meets its rim: wheel, rad. */
#define GROUSER_ENTRY_ANGLE 17u

/* The sample's turn is measured. */
#define GROUSER_HAS_TURN 1u
/* The sample's speed to the left is measured. */
#define GROUSER_HAS_LEFT 2u

/* Not enough has been measured yet. */
#define GROUSER_HEALTH_UNINITIALISED 0u
/* The slip and its sigma hold. */
#define GROUSER_HEALTH_OK 1u
/* There is an estimate, with the reservation in reason. */
#define GROUSER_HEALTH_DEGRADED 2u
/* There is no estimate, for the reason in reason. */
#define GROUSER_HEALTH_INVALID 3u

/* No reason. */
#define GROUSER_REASON_NONE 0u
/* The wheel is too slow for its slip to mean anything. */
#define GROUSER_REASON_LOW_SPEED 1u
/* The sensors' resolution alone makes sigma exceed its limit. */
#define GROUSER_REASON_QUANTISED 2u
/* The reference has fallen silent. */
#define GROUSER_REASON_REFERENCE_LOST 3u
/* Only differences between the wheels are known. */
#define GROUSER_REASON_RELATIVE 5u
/* The wheel's sensor may be wrong. */
#define GROUSER_REASON_SUSPECT 7u
/* The wheel's sensor has fallen silent. */
#define GROUSER_REASON_DROPOUT 101u
/* Nothing measures the robot's speed. */
#define GROUSER_REASON_NO_REFERENCE 102u
/* The wheel's sensor contradicts the others. */
#define GROUSER_REASON_INCONSISTENT 103u
/* A reason that this interface has no number for. */
#define GROUSER_REASON_OTHER 255u

/* How the wheel moves is not known yet. */
#define GROUSER_MOTION_UNKNOWN 0u
/* Slip in [0, 1]. */
#define GROUSER_MOTION_DRIVING 1u
/* Slip in [-1, 0). */
#define GROUSER_MOTION_BRAKING 2u
/* Both speeds are below their noise. */
#define GROUSER_MOTION_STANDSTILL 3u
/* The wheel travels against its own rotation. */
#define GROUSER_MOTION_ROLL_BACK 4u
/* The wheel spins without load. */
#define GROUSER_MOTION_LIFT_OFF 5u
/* The motor pushes and nothing turns. */
#define GROUSER_MOTION_STALL 6u

/* The robot drives as requested. */
#define GROUSER_MODE_FORWARD 0u
/* It crosses a slope at an angle. */
#define GROUSER_MODE_TRAVERSE 1u
/* It drives back the way it came. */
#define GROUSER_MODE_BACK_OUT 2u
/* It drives round soft ground. */
#define GROUSER_MODE_DETOUR 3u
/* The drive has ended: the safe stop. */
#define GROUSER_MODE_STOPPED 4u

/* slip and slip_sigma are known. */
#define GROUSER_KNOWS_SLIP 1u
/* forward_speed_m_per_s and its sigma are known. */
#define GROUSER_KNOWS_FORWARD_SPEED 2u
/* rim_speed_m_per_s and its sigma are known. */
#define GROUSER_KNOWS_RIM_SPEED 4u
/* side_slip_angle_rad and its sigma are known. */
#define GROUSER_KNOWS_SIDE_SLIP 8u
/* last_good_age_s is known. */
#define GROUSER_KNOWS_LAST_GOOD_AGE 16u
/* reference_age_s is known: a trusted reference has measured the robot's speed. */
#define GROUSER_KNOWS_REFERENCE_AGE 32u

/* A wheel of the robot, x forwards and y to the left of the robot's origin. */
typedef struct GrouserWheel {
  uint32_t size; /* sizeof(GrouserWheel). */
  uint32_t role; /* GROUSER_POWERED or GROUSER_FREE. */
  double x_m; /* Centre, forwards, m. */
  double y_m; /* Centre, to the left, m. */
  double heading_rad; /* Direction in which it drives, from x towards y, rad. */
  double radius_m; /* Effective rolling radius, m. */
  double load_n; /* Load on the level, N; 0: not known. */
  double gear; /* Turns of the motor per turn of the wheel; 0: 1. */
  double ticks_per_turn; /* Ticks per turn of the encoder's shaft; 0: it has angles or rates without ticks. */
  double rate_step_rad_per_s; /* Step of its rate readings, rad/s of its shaft; 0: continuous. */
  double max_torque_n_m; /* Greatest torque of its motor on the wheel, N m; 0: not known. */
  double max_steering_angle_rad; /* How far it steers either way, rad; 0: not at all. */
  uint32_t counter_bits; /* Width of its counter, 8 to 64 bits; 0: 64. */
  uint32_t encoder_flags; /* GROUSER_ENCODER_*, added. */
} GrouserWheel;

/* One setting of the filter by name. */
typedef struct GrouserFilterSetting {
  /* A key of [filter] in a robot file, in the file's unit, or a field of the filter's settings, in SI
     units. */
  const char *key;
  double value; /* Its value. */
} GrouserFilterSetting;

/* How the software works. */
typedef struct GrouserSettings {
  uint32_t size; /* sizeof(GrouserSettings). */
  uint32_t start_policy; /* GROUSER_START_*. */
  /* For this long after the first sample the filter waits while the attitude is found, s. */
  double warm_up_s;
  double gravity_m_per_s2; /* Gravity, m/s^2; 0: that of the robot file, without one the Earth's. */
  double heading_rad; /* Heading at the start, rad. */
  const GrouserFilterSetting *filter; /* Settings of the filter; may be NULL where there are none. */
  size_t filter_count; /* How many. */
} GrouserSettings;

/* One reading of one sensor. */
typedef struct GrouserSample {
  uint32_t size; /* sizeof(GrouserSample). */
  uint32_t kind; /* Which sensor: GROUSER_WHEEL_COUNT and so on. */
  int64_t time_ns; /* When it was taken, ns on the sensor's clock. */
  uint32_t wheel; /* Index of the wheel, where it belongs to one. */
  uint32_t flags; /* GROUSER_HAS_*, added. */
  uint64_t raw; /* A counter's reading; bits above its width are ignored. */
  double values[6]; /* The numbers, as kind has them. */
} GrouserSample;

/* What is known of a wheel. What is not known is 0 and has no bit in known. */
typedef struct GrouserWheelEstimate {
  uint32_t size; /* sizeof(GrouserWheelEstimate). */
  uint32_t known; /* GROUSER_KNOWS_*, added. */
  uint32_t health; /* GROUSER_HEALTH_*. */
  uint32_t reason; /* GROUSER_REASON_*. */
  uint32_t motion; /* GROUSER_MOTION_*. */
  uint32_t reserved; /* 0. */
  double slip; /* Slip, in [-1, 1]. */
  double slip_sigma; /* Standard deviation of its error. */
  double forward_speed_m_per_s; /* Speed of the centre along the wheel's heading, m/s. */
  double forward_speed_sigma_m_per_s; /* Standard deviation, m/s. */
  double rim_speed_m_per_s; /* Speed of the rim, m/s. */
  double rim_speed_sigma_m_per_s; /* Standard deviation, m/s. */
  double side_slip_angle_rad; /* From its heading to the way of its centre, left positive, rad. */
  double side_slip_angle_sigma_rad; /* Standard deviation, rad. */
  double last_good_age_s; /* Seconds since its health was last OK. */
} GrouserWheelEstimate;

/* What is known of the robot as a whole. */
typedef struct GrouserBodyEstimate {
  uint32_t size; /* sizeof(GrouserBodyEstimate). */
  uint32_t known; /* GROUSER_KNOWS_REFERENCE_AGE or 0. */
  uint32_t mode; /* GROUSER_MODE_*. */
  uint32_t start_fault; /* 1 where the sensors contradict the robot's description, else 0. */
  int64_t time_ns; /* The time up to which samples have been used, ns. */
  double time_slip_s; /* The delay of that behind the newest sample, s. */
  double forward_m_per_s; /* Speed forwards, m/s. */
  double forward_sigma_m_per_s; /* Standard deviation, m/s. */
  double left_m_per_s; /* Speed to the left, m/s. */
  double left_sigma_m_per_s; /* Standard deviation, m/s. */
  double yaw_rate_rad_per_s; /* Yaw rate, left positive, rad/s. */
  double yaw_rate_sigma_rad_per_s; /* Standard deviation, rad/s. */
  double common_slip; /* Slip that the powered wheels have in common. */
  double common_slip_sigma; /* Standard deviation. */
  double x_m; /* Place by odometry with slip compensated, x, m. */
  double y_m; /* y, m. */
  double yaw_rad; /* Heading by odometry, not wrapped, rad. */
  double place_covariance[9]; /* Covariance of x, y and yaw, row by row. */
  double distance_m; /* Travel forwards, m. */
  double distance_of_wheels_m; /* The same by the wheels without compensation of slip, m. */
  double roll_rad; /* Roll, rad. */
  double pitch_rad; /* Pitch, nose up positive, rad. */
  double reference_age_s; /* Seconds since a trusted reference last measured the robot's speed. */
  uint64_t rejected_bad_value; /* Samples refused: NaN, infinite or implausible. */
  uint64_t rejected_not_later; /* Samples refused: not later than the last one. */
  uint64_t rejected_jump; /* Samples refused: faster than the robot can move. */
  uint64_t rejected_unknown; /* Samples refused: of a wheel or an encoder that the robot does not have. */
  uint64_t dropped; /* Samples missing, by the usual period of each sensor. */
  uint64_t clock_steps; /* Steps of the clock that the filter has followed. */
} GrouserBodyEstimate;

/* What a wheel's motor driver and steering are to do. */
typedef struct GrouserCommand {
  uint32_t size; /* sizeof(GrouserCommand). */
  uint32_t reserved; /* 0. */
  double rim_speed_m_per_s; /* Speed of the rim, m/s. */
  double traction; /* Greatest torque over load and radius of the wheel, 1. */
  double steering_angle_rad; /* Steering angle beside the wheel's heading, rad. */
} GrouserCommand;

/* The software of one robot. */
typedef struct GrouserOnBoard GrouserOnBoard;

/* The version of the interface that the library was built with. Compare it with GROUSER_ABI. */
uint32_t grouser_abi(void);

/* Writes the settings that apply where `settings` is NULL; out->size is set by the caller. */
int32_t grouser_default_settings(GrouserSettings *out);

/*
 * Makes the software of a robot of `wheel_count` (1 to 8) wheels. An error's text, which names field,
 * value, limits and unit, is written into `message` as far as it fits, with a NUL at its end;
 * `message` may be NULL. The wheels and settings are copied.
 */
int32_t grouser_new(const GrouserWheel *wheels, size_t wheel_count, const GrouserSettings *settings,
                    GrouserOnBoard **out, char *message, size_t message_size);

/*
 * The same by the text of a robot file (docs/estimate.md), UTF-8, with the file's [filter]. Motors and
 * links of the file are not used. Not in the library for bare metal.
 */
int32_t grouser_new_from_toml(const char *text, size_t text_size, const GrouserSettings *settings,
                              GrouserOnBoard **out, char *message, size_t message_size);

/* Frees the object. NULL is allowed. */
void grouser_free(GrouserOnBoard *on_board);

/* Writes the number of wheels. */
int32_t grouser_wheel_count(GrouserOnBoard *on_board, size_t *out);

/*
 * Takes one sample that arrives at `now_ns` by the computer's clock; sample->time_ns is when it was
 * taken, by the sensor's clock. GROUSER_SAMPLE_REFUSED: counted in GrouserBodyEstimate, and the
 * estimate goes on.
 */
int32_t grouser_push(GrouserOnBoard *on_board, int64_t now_ns, const GrouserSample *sample);

/* A wheel is steered by `angle_rad` to the left of its heading from now on. */
int32_t grouser_set_steering_angle(GrouserOnBoard *on_board, uint32_t wheel, double angle_rad);

/*
 * Runs the control loop for a requested speed and heading, at a steady rate of 20 to 200 Hz.
 * GROUSER_ERROR_VALUE: one of both is not finite, and the robot stands.
 */
int32_t grouser_tick(GrouserOnBoard *on_board, int64_t now_ns, double speed_m_per_s, double heading_rad);

/* Copies out what is known of a wheel after the last push or tick. A silent sensor is noticed by the tick. */
int32_t grouser_wheel(GrouserOnBoard *on_board, uint32_t wheel, GrouserWheelEstimate *out);

/* Copies out what is known of the robot. */
int32_t grouser_body(GrouserOnBoard *on_board, GrouserBodyEstimate *out);

/* Copies out a wheel's command of the last tick. */
int32_t grouser_command(GrouserOnBoard *on_board, uint32_t wheel, GrouserCommand *out);

#ifdef __cplusplus
}
#endif

#endif
