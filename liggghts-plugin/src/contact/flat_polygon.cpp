#include "contact/flat_polygon.hpp"

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

bool FlatPolygon::set(const Vec3& normal, double offset, const Vec3& lower, const Vec3& upper,
                      std::vector<HalfPlane>& cuts) {
  lay(normal, offset);
  middle_ = {0.5 * (lower[first_] + upper[first_]), 0.5 * (lower[second_] + upper[second_])};
  half_ = {upper[first_] - middle_.s, upper[second_] - middle_.t};
  const double height = level_ - slope_[0] * middle_.s - slope_[1] * middle_.t;
  const double reach = std::abs(slope_[0]) * half_.s + std::abs(slope_[1]) * half_.t;
  count_ = 0;
  if (height - reach > upper[main_] || height + reach < lower[main_]) return false;
  count_ = 4;
  corners_[0] = {lower[first_], lower[second_]};
  corners_[1] = {upper[first_], lower[second_]};
  corners_[2] = {upper[first_], upper[second_]};
  corners_[3] = {lower[first_], upper[second_]};
  if (height + reach > upper[main_]) cuts.push_back({-slope_[0], -slope_[1], upper[main_] - level_});
  if (height - reach < lower[main_]) cuts.push_back({slope_[0], slope_[1], level_ - lower[main_]});
  return true;
}

bool FlatPolygon::set(const Vec3& normal, double offset, const Vec3& lower, const Vec3& upper) {
  std::vector<HalfPlane> cuts;
  return set(normal, offset, lower, upper, cuts) && cut(cuts);
}

void FlatPolygon::set(const Vec3& normal, double offset, const coupling::Triangle& triangle) {
  lay(normal, offset);
  count_ = 3;
  for (int c = 0; c < 3; ++c) corners_[c] = {triangle[c][first_], triangle[c][second_]};
}

bool FlatPolygon::gather(std::span<const HalfSpace> half_spaces, std::vector<HalfPlane>& cuts) const {
  for (const HalfSpace& half_space : half_spaces) {
    const HalfPlane here = trace(half_space);
    const double beyond = here.a * middle_.s + here.b * middle_.t - here.c;
    const double reach = std::abs(here.a) * half_.s + std::abs(here.b) * half_.t;
    if (beyond > reach) return false;
    if (beyond > -reach) cuts.push_back(here);
  }
  return true;
}

bool FlatPolygon::cut(const HalfPlane& half_plane) {
  if (count_ == 0) return false;
  // A cut adds one corner; where rounding has bent the outline, at most one for each that it takes.
  if (spare_.size() < 2 * count_) spare_.resize(4 * count_);
  const auto beyond = [half_plane](const Corner& corner) {
    return half_plane.a * corner.s + half_plane.b * corner.t - half_plane.c;
  };
  Corner before = corners_[count_ - 1];
  double above_before = beyond(before);
  std::size_t kept = 0;
  bool whole = true;
  for (std::size_t k = 0; k < count_; ++k) {
    const Corner here = corners_[k];
    const double above = beyond(here);
    if ((above > 0) != (above_before > 0)) {
      const double share = above_before / (above_before - above);
      spare_[kept++] = {before.s + share * (here.s - before.s), before.t + share * (here.t - before.t)};
    }
    if (above > 0) {
      whole = false;
    } else {
      spare_[kept++] = here;
    }
    before = here;
    above_before = above;
  }
  if (whole) return true;
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
