#include "core/motion.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::mps {

namespace {

Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Matrix of the turn by an angle about a unit vector (Rodrigues' formula).
std::array<Vec3d, 3> rotation_about(const Vec3d& e, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  std::array<Vec3d, 3> rows;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows[i][j] = (1 - c) * e[i] * e[j] + (i == j ? c : 0.0);
  }
  rows[0][1] -= s * e[2];
  rows[1][0] += s * e[2];
  rows[0][2] += s * e[1];
  rows[2][0] -= s * e[1];
  rows[1][2] -= s * e[0];
  rows[2][1] += s * e[0];
  return rows;
}

}  // namespace

Vec3d displacement(const Motion& motion, double time) {
  Vec3d result{};
  if (motion.table.empty()) {
    const double active = std::clamp(time, motion.start, motion.stop) - motion.start;
    for (int c = 0; c < 3; ++c) result[c] = motion.velocity[c] * active;
    return result;
  }
  const auto& table = motion.table;
  const auto next = std::upper_bound(table.begin(), table.end(), time,
                                     [](double value, const auto& row) { return value < row.first; });
  if (next == table.begin()) return table.front().second;
  if (next == table.end()) return table.back().second;
  const auto& before = *(next - 1);
  const double share = (time - before.first) / (next->first - before.first);
  for (int c = 0; c < 3; ++c) result[c] = before.second[c] + share * (next->second[c] - before.second[c]);
  return result;
}

Curve::Curve(const std::vector<std::pair<double, double>>& rows, Interpolation interpolation) {
  for (const auto& [time, value] : rows) {
    time_.push_back(time);
    value_.push_back(value);
  }
  if (interpolation == Interpolation::linear || rows.size() < 2) return;
  // Second derivatives m of the complete spline: h_k m_k/6 + (h_k + h_k+1) m_k+1/3 + h_k+1 m_k+2/6 = jump of the slope
  // of the chords, with chords of slope zero beyond both ends. Elimination without exchange: the matrix is dominant.
  const std::size_t n = rows.size();
  std::vector<double> diagonal(n), right(n), above(n);
  const auto width = [&](std::size_t k) { return time_[k + 1] - time_[k]; };
  const auto slope = [&](std::size_t k) { return (value_[k + 1] - value_[k]) / width(k); };
  for (std::size_t k = 0; k < n; ++k) {
    const double left = k > 0 ? width(k - 1) : 0, next = k + 1 < n ? width(k) : 0;
    diagonal[k] = (left + next) / 3;
    above[k] = next / 6;
    right[k] = (k + 1 < n ? slope(k) : 0) - (k > 0 ? slope(k - 1) : 0);
  }
  for (std::size_t k = 1; k < n; ++k) {
    const double share = above[k - 1] / diagonal[k - 1];
    diagonal[k] -= share * above[k - 1];
    right[k] -= share * right[k - 1];
  }
  second_.resize(n);
  for (std::size_t k = n; k-- > 0;) {
    second_[k] = (right[k] - (k + 1 < n ? above[k] * second_[k + 1] : 0)) / diagonal[k];
  }
}

std::size_t Curve::interval(double time) const {
  const auto next = std::upper_bound(time_.begin(), time_.end(), time);
  if (next == time_.begin() || next == time_.end()) return time_.size();
  return static_cast<std::size_t>(next - time_.begin()) - 1;
}

double Curve::value(double time) const {
  const std::size_t k = interval(time);
  if (k == time_.size()) return time < time_.front() ? value_.front() : value_.back();
  const double h = time_[k + 1] - time_[k], b = (time - time_[k]) / h, a = 1 - b;
  const double linear = value_[k] + b * (value_[k + 1] - value_[k]);
  if (second_.empty()) return linear;
  return linear + h * h / 6 * ((a * a * a - a) * second_[k] + (b * b * b - b) * second_[k + 1]);
}

double Curve::rate(double time) const {
  const std::size_t k = interval(time);
  if (k == time_.size()) return 0;
  const double h = time_[k + 1] - time_[k], b = (time - time_[k]) / h, a = 1 - b;
  const double linear = (value_[k + 1] - value_[k]) / h;
  if (second_.empty()) return linear;
  return linear + h / 6 * ((1 - 3 * a * a) * second_[k] + (3 * b * b - 1) * second_[k + 1]);
}

double Curve::acceleration(double time) const {
  const std::size_t k = interval(time);
  if (k == time_.size() || second_.empty()) return 0;
  const double b = (time - time_[k]) / (time_[k + 1] - time_[k]);
  return (1 - b) * second_[k] + b * second_[k + 1];
}

Vec3d Pose::turn(const Vec3d& v) const {
  if (!turned) return v;
  Vec3d result{};
  for (int c = 0; c < 3; ++c) result[c] = rotation[c][0] * v[0] + rotation[c][1] * v[1] + rotation[c][2] * v[2];
  return result;
}

Vec3d Pose::place(const Vec3d& zero) const {
  Vec3d result = zero;
  if (turned) {
    result = turn({zero[0] - pivot[0], zero[1] - pivot[1], zero[2] - pivot[2]});
    for (int c = 0; c < 3; ++c) result[c] += pivot[c];
  }
  for (int c = 0; c < 3; ++c) result[c] += moved[c];
  return result;
}

Vec3d Pose::zero(const Vec3d& place) const {
  Vec3d result{};
  for (int c = 0; c < 3; ++c) result[c] = place[c] - moved[c];
  if (!turned) return result;
  const Vec3d arm{result[0] - pivot[0], result[1] - pivot[1], result[2] - pivot[2]};
  for (int c = 0; c < 3; ++c) {
    result[c] = pivot[c] + rotation[0][c] * arm[0] + rotation[1][c] * arm[1] + rotation[2][c] * arm[2];
  }
  return result;
}

Vec3d Stride::velocity_of(const Vec3d& zero) const {
  if (!after.turned) return velocity;
  const Vec3d from = before.place(zero), to = after.place(zero);
  return {(to[0] - from[0]) / step, (to[1] - from[1]) / step, (to[2] - from[2]) / step};
}

Course::Course(const Motion& motion) : motion_(motion), moves_(motion.moves()) {
  if (!motion.table.empty() && motion.interpolation == Interpolation::cubic) {
    for (int c = 0; c < 3; ++c) {
      std::vector<std::pair<double, double>> rows;
      for (const auto& [time, moved] : motion.table) rows.emplace_back(time, moved[c]);
      spline_[c] = Curve(rows, motion.interpolation);
    }
  }
  angle_ = Curve(motion.angle_table, motion.interpolation);
}

Vec3d Course::moved(double time) const {
  if (!moves_) return {};
  if (spline_[0].empty()) return displacement(motion_, time);
  return {spline_[0].value(time), spline_[1].value(time), spline_[2].value(time)};
}

double Course::angle(double time) const {
  if (!angle_.empty()) return angle_.value(time);
  return motion_.angular_velocity * (std::clamp(time, motion_.start, motion_.stop) - motion_.start);
}

Pose Course::pose(double time) const {
  Pose pose;
  pose.moved = moved(time);
  if (!turns()) return pose;
  pose.turned = true;
  pose.pivot = motion_.pivot;
  pose.rotation = rotation_about(motion_.axis, angle(time));
  return pose;
}

Stride Course::stride(double from, double to, double step) const {
  Stride stride{pose(from), pose(to), step, {}};
  if (!moves_) return stride;
  for (int c = 0; c < 3; ++c) stride.velocity[c] = (stride.after.moved[c] - stride.before.moved[c]) / step;
  return stride;
}

Vec3d Course::acceleration(double time, const double* x) const {
  Vec3d result{};
  if (!spline_[0].empty()) {
    for (int c = 0; c < 3; ++c) result[c] = spline_[c].acceleration(time);
  }
  if (!turns()) return result;
  const bool active = time >= motion_.start && time < motion_.stop;
  const double rate = !angle_.empty() ? angle_.rate(time) : active ? motion_.angular_velocity : 0.0;
  const double change = angle_.empty() ? 0.0 : angle_.acceleration(time);
  const Vec3d at = moved(time);
  Vec3d arm{};
  for (int c = 0; c < 3; ++c) arm[c] = x[c] - motion_.pivot[c] - at[c];
  const Vec3d across = cross(motion_.axis, arm);
  const Vec3d inward = cross(motion_.axis, across);
  for (int c = 0; c < 3; ++c) result[c] += change * across[c] + rate * rate * inward[c];
  return result;
}

}  // namespace embacle::mps
