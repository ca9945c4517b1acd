#include "contact/stored_energy.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::liggghts {

using coupling::Vec3;

namespace {

/// Pressure below a face: hardness times depth.
struct FaceField {
  HalfSpace outside;  ///< of the face, in the common frame
  double hardness;
  double operator()(const Vec3& x) const { return hardness * (outside.offset - outside.normal.dot(x)); }
};

/// Integral of a pressure over the part of a ball (about the origin) that all half-spaces hold, which must be inside of
/// it. The pressure is zero on its face, so with x0 there div(p (x - x0)) = 4 p, and the flux through each bound is
/// that bound's distance from x0 times the integral of p.
double integral(const FaceField& pressure, const std::vector<HalfSpace>& bounds, double reach) {
  thread_local std::vector<HalfSpace> planes;
  thread_local FlatPolygon polygon;
  planes.clear();
  for (const HalfSpace& bound : bounds) {
    const double length = bound.normal.norm();
    const HalfSpace plane{bound.normal / length, bound.offset / length};
    const bool known = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& other) {
      return (other.normal - plane.normal).norm() < 1e-9 && std::abs(other.offset - plane.offset) < 1e-9 * reach;
    });
    if (!known) planes.push_back(plane);
  }
  const Vec3 on_face = pressure.outside.offset * pressure.outside.normal;
  double sum = 0;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const HalfSpace& plane = planes[k];
    if (std::abs(plane.offset) > reach) continue;
    const Vec3 far = Vec3::Constant(reach);
    bool left = polygon.set(plane.normal, plane.offset, -far, far);
    for (std::size_t other = 0; left && other < planes.size(); ++other) {
      left = other == k || polygon.cut(planes[other]);
    }
    if (!left) continue;
    double flux = 0;
    for (std::size_t c = 2; c < polygon.size(); ++c) {
      const Vec3 corners =
          polygon.place(polygon.corner(0)) + polygon.place(polygon.corner(c - 1)) + polygon.place(polygon.corner(c));
      flux += polygon.area(c) * pressure(corners / 3);
    }
    sum += 0.25 * (plane.offset - plane.normal.dot(on_face)) * flux;
  }
  return sum;
}

PosedShape moved(const PosedShape& body, const Vec3& origin) {
  return {body.shape, body.axes, body.position - origin, body.hardness};
}

/// Over the places of the overlap where `body` has the smaller pressure. Where both are the same by a whole face,
/// `ties` says whether they count.
double energy_below(const PosedShape& body, const PosedShape& other, bool ties) {
  const PosedShape a = moved(body, body.position), b = moved(other, body.position);
  std::vector<HalfSpace> bounds;
  double sum = 0;
  for (const auto& face : a.shape->faces) {
    const FaceField pressure{a.to_global(face.outside), a.hardness};
    bounds.clear();
    for (const HalfSpace& bound : face.region) bounds.push_back(a.to_global(bound));
    bool none = false;
    for (const auto& partner : b.shape->faces) {
      const HalfSpace outside = b.to_global(partner.outside);
      // pressure <= that of the partner's face
      const Vec3 normal = b.hardness * outside.normal - a.hardness * pressure.outside.normal;
      const double offset = b.hardness * outside.offset - a.hardness * pressure.outside.offset;
      if (normal.norm() > 1e-9 * (a.hardness + b.hardness)) {
        bounds.push_back({normal, offset});
      } else {
        none = none ||
               (ties ? offset < -1e-12 * a.hardness * a.shape->reach : offset < 1e-12 * a.hardness * a.shape->reach);
      }
    }
    if (!none) sum += integral(pressure, bounds, a.shape->reach);
  }
  return sum;
}

}  // namespace

double stored_energy(const PosedShape& first, const PosedShape& second) {
  if ((first.position - second.position).norm() >= first.shape->reach + second.shape->reach) return 0;
  if (separation(first, second) >= 0) return 0;
  return energy_below(first, second, true) + energy_below(second, first, false);
}

double stored_energy_at_plane(const PosedShape& body, const Vec3& point, const Vec3& normal) {
  if (separation_from_plane(body, point, normal) >= 0) return 0;
  const PosedShape a = moved(body, body.position);
  std::vector<HalfSpace> bounds;
  double sum = 0;
  for (const auto& face : a.shape->faces) {
    bounds.assign(1, {normal, normal.dot(point - body.position)});
    for (const HalfSpace& bound : face.region) bounds.push_back(a.to_global(bound));
    sum += integral({a.to_global(face.outside), a.hardness}, bounds, a.shape->reach);
  }
  return sum;
}

}  // namespace embacle::liggghts
