#include "contact/flat_polygon.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::liggghts {

using coupling::Vec3;

void FlatPolygon::lay(const Vec3& normal, double offset) {
  normal.cwiseAbs().maxCoeff(&main_);
  first_ = (main_ + 1) % 3;
  second_ = (main_ + 2) % 3;
  const double inverse = 1 / normal[main_];
  slope_ = {normal[first_] * inverse, normal[second_] * inverse};
  level_ = offset * inverse;
  stretch_ = std::abs(inverse);
}

bool FlatPolygon::set(const Vec3& normal, double offset, const Vec3& lower, const Vec3& upper) {
  lay(normal, offset);
  count_ = 4;
  corners_[0] = {lower[first_], lower[second_]};
  corners_[1] = {upper[first_], lower[second_]};
  corners_[2] = {upper[first_], upper[second_]};
  corners_[3] = {lower[first_], upper[second_]};
  const double middle =
      level_ - 0.5 * (slope_[0] * (lower[first_] + upper[first_]) + slope_[1] * (lower[second_] + upper[second_]));
  const double reach = 0.5 * (std::abs(slope_[0]) * (upper[first_] - lower[first_]) +
                              std::abs(slope_[1]) * (upper[second_] - lower[second_]));
  if (middle - reach > upper[main_] || middle + reach < lower[main_]) {
    count_ = 0;
    return false;
  }
  return (middle + reach <= upper[main_] || cut({Vec3::Unit(main_), upper[main_]})) &&
         (middle - reach >= lower[main_] || cut({-Vec3::Unit(main_), -lower[main_]}));
}

void FlatPolygon::set(const Vec3& normal, double offset, const coupling::Triangle& triangle) {
  lay(normal, offset);
  count_ = 3;
  for (int c = 0; c < 3; ++c) corners_[c] = {triangle[c][first_], triangle[c][second_]};
}

bool FlatPolygon::cut(const HalfSpace& half_space) {
  const double steep = half_space.normal[main_];
  const double a = half_space.normal[first_] - steep * slope_[0];
  const double b = half_space.normal[second_] - steep * slope_[1];
  const double c = half_space.offset - steep * level_;
  if (above_.size() < 2 * count_) {
    above_.resize(4 * count_);
    spare_.resize(4 * count_);
    corners_.resize(std::max(corners_.size(), 4 * count_));
  }
  std::size_t outside = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    above_[k] = a * corners_[k].s + b * corners_[k].t - c;
    outside += above_[k] > 0 ? 1 : 0;
  }
  if (outside == 0) return count_ > 0;
  if (outside == count_) {
    count_ = 0;
    return false;
  }
  std::size_t kept = 0, before = count_ - 1;
  for (std::size_t k = 0; k < count_; before = k++) {
    if ((above_[k] > 0) != (above_[before] > 0)) {
      const double share = above_[before] / (above_[before] - above_[k]);
      spare_[kept++] = {corners_[before].s + share * (corners_[k].s - corners_[before].s),
                        corners_[before].t + share * (corners_[k].t - corners_[before].t)};
    }
    if (above_[k] <= 0) spare_[kept++] = corners_[k];
  }
  corners_.swap(spare_);
  count_ = kept < 3 ? 0 : kept;
  return count_ > 0;
}

double FlatPolygon::area(std::size_t c) const {
  const Corner &o = corners_[0], &p = corners_[c - 1], &q = corners_[c];
  return 0.5 * stretch_ * std::abs((p.s - o.s) * (q.t - o.t) - (p.t - o.t) * (q.s - o.s));
}

double FlatPolygon::area() const {
  double sum = 0;
  for (std::size_t c = 2; c < count_; ++c) sum += area(c);
  return sum;
}

}  // namespace embacle::liggghts
