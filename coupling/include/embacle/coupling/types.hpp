// The vocabulary of the coupling: state, load, box, and the errors that end a run.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace embacle::coupling {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// Identifies a body for its whole life; assigned by the solid side, never reused.
using BodyTag = std::int64_t;

/// Exit statuses of every program of the project.
enum class ExitStatus : int {
  done = 0,
  internal = 1,  ///< a bug in the program
  input = 2,     ///< the user's input is wrong
  unstable = 3,  ///< the simulation broke: says step, place and quantity
  system = 4,    ///< the machine failed: disk full, file not writable, another program of the run is gone
  early = 5,     ///< ended before its time as it was told, by the wall-clock limit or SIGUSR1
};

/// An error with the status the program must end with. The message is complete and addressed to the user.
class RunError : public std::runtime_error {
 public:
  RunError(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  [[nodiscard]] ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

/// The user's input is wrong (status 2).
class InputError : public RunError {
 public:
  explicit InputError(const std::string& message) : RunError(ExitStatus::input, message) {}
};

/// The simulation became unstable (status 3).
class InstabilityError : public RunError {
 public:
  explicit InstabilityError(const std::string& message) : RunError(ExitStatus::unstable, message) {}
};

/// The machine failed (status 4).
class SystemError : public RunError {
 public:
  explicit SystemError(const std::string& message) : RunError(ExitStatus::system, message) {}
};

/// Axis-aligned box [m]; unbounded sides are +-infinity.
struct Box {
  Vec3 lower = Vec3::Zero();
  Vec3 upper = Vec3::Zero();

  [[nodiscard]] bool contains(const Vec3& point) const {
    return (point.array() >= lower.array()).all() && (point.array() < upper.array()).all();
  }
  /// Distance [m] from a point to the box, zero inside.
  [[nodiscard]] double distance(const Vec3& point) const {
    const Vec3 outside = (lower - point).cwiseMax(point - upper).cwiseMax(0.0);
    return outside.norm();
  }
};

/// Rigid-body state at one instant, in the global frame.
struct State {
  Vec3 position = Vec3::Zero();                     ///< centre of mass [m]
  Quaternion orientation = Quaternion::Identity();  ///< body frame to global frame
  Vec3 velocity = Vec3::Zero();                     ///< of the centre of mass [m/s]
  Vec3 angular_velocity = Vec3::Zero();             ///< global frame [rad/s]
  Vec3 contact_force = Vec3::Zero();   ///< mean force over the last window other than water and gravity [N]
  Vec3 contact_torque = Vec3::Zero();  ///< mean torque likewise, about the centre of mass [N m]
};

/// Force and torque of the water on a body, about its centre of mass, in the global frame.
struct Load {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N m]

  Load& operator+=(const Load& other) {
    force += other.force;
    torque += other.torque;
    return *this;
  }
};

}  // namespace embacle::coupling
