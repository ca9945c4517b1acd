#include "core/solid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "embacle/coupling/layers.hpp"
#include "embacle/coupling/shape.hpp"

namespace embacle::mps {

namespace {

coupling::Vec3 vector(const double* x) { return {x[0], x[1], x[2]}; }

std::vector<coupling::Triangle> triangles_of(const Surface& surface) {
  std::vector<coupling::Triangle> result;
  for (const Triangle& triangle : surface.triangles) {
    const auto& [a, b, c] = triangle.corner;
    result.push_back({vector(a.data()), vector(b.data()), vector(c.data())});
  }
  return result;
}

}  // namespace

Solid::Solid(const Form& form, int dimension)
    : form_(form),
      dimension_(dimension),
      u_(form.axis == Axis::x ? 1 : 0),
      v_(form.axis == Axis::z ? 1 : 2),
      w_(static_cast<int>(form.axis)) {
  if (form.kind == Form::Kind::cylinder) {
    low_ = form.centre[w_] - 0.5 * form.length;
    high_ = form.centre[w_] + 0.5 * form.length;
  } else if (form.kind == Form::Kind::prism) {
    low_ = form.from;
    high_ = form.to;
  } else if (form.kind == Form::Kind::stl) {
    mesh_.emplace(triangles_of(*form.surface));
  }
}

double Solid::planar_distance(double u, double v, double& nu, double& nv) const {
  if (form_.kind == Form::Kind::cylinder) {
    const double du = u - form_.centre[u_], dv = v - form_.centre[v_];
    const double r = std::hypot(du, dv);
    nu = r > 0 ? du / r : 1;
    nv = r > 0 ? dv / r : 0;
    return r - form_.radius;
  }
  const auto& corners = form_.polygon;
  double best = 1e300, foot_u = 0, foot_v = 0, edge_u = 0, edge_v = 0, area = 0;
  bool inside = false;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3d& a = corners[k];
    const Vec3d& b = corners[(k + 1) % corners.size()];
    const double eu = b[0] - a[0], ev = b[1] - a[1];
    const double share = std::clamp(((u - a[0]) * eu + (v - a[1]) * ev) / (eu * eu + ev * ev), 0.0, 1.0);
    const double fu = a[0] + share * eu, fv = a[1] + share * ev;
    const double square = (u - fu) * (u - fu) + (v - fv) * (v - fv);
    if (square < best) {
      best = square;
      foot_u = fu;
      foot_v = fv;
      edge_u = eu;
      edge_v = ev;
    }
    if ((a[1] > v) != (b[1] > v) && u < a[0] + (v - a[1]) / ev * eu) inside = !inside;
    area += a[0] * b[1] - b[0] * a[1];
  }
  const double distance = std::sqrt(best);
  const double sign = inside ? -1 : 1;
  const double length = std::hypot(edge_u, edge_v);
  if (distance > 1e-9 * length) {
    nu = sign * (u - foot_u) / distance;
    nv = sign * (v - foot_v) / distance;
  } else {  // on the edge itself
    const double turn = area > 0 ? 1 : -1;
    nu = turn * edge_v / length;
    nv = -turn * edge_u / length;
  }
  return sign * distance;
}

double Solid::distance(const double* x, Vec3d* normal) const {
  if (mesh_) {
    coupling::Vec3 there;
    const double below = mesh_->distance(vector(x), &there);
    if (normal != nullptr) *normal = {there.x(), there.y(), there.z()};
    return below;
  }
  Vec3d n{};
  double result = 0;
  if (form_.kind == Form::Kind::sphere) {
    double square = 0;
    for (int c = 0; c < dimension_; ++c) square += (x[c] - form_.centre[c]) * (x[c] - form_.centre[c]);
    const double r = std::sqrt(square);
    for (int c = 0; c < dimension_; ++c) n[c] = r > 0 ? (x[c] - form_.centre[c]) / r : (c == 0 ? 1.0 : 0.0);
    result = r - form_.radius;
  } else {
    double nu = 0, nv = 0;
    const double across = planar_distance(x[u_], x[v_], nu, nv);
    const double along = dimension_ == 2 ? -1e300 : std::max(low_ - x[w_], x[w_] - high_);
    const double end = x[w_] > 0.5 * (low_ + high_) ? 1 : -1;
    if (across > 0 && along > 0) {  // nearest to the rim of an end
      result = std::hypot(across, along);
      n[u_] = nu * across / result;
      n[v_] = nv * across / result;
      n[w_] = end * along / result;
    } else if (along > across) {
      result = along;
      n[w_] = end;
    } else {
      result = across;
      n[u_] = nu;
      n[v_] = nv;
    }
  }
  if (normal != nullptr) *normal = n;
  return result;
}

double Solid::volume() const {
  constexpr double pi = std::numbers::pi;
  const double r = form_.radius;
  double result = 0;
  switch (form_.kind) {
    case Form::Kind::sphere:
      return dimension_ == 2 ? pi * r * r : 4.0 / 3.0 * pi * r * r * r;
    case Form::Kind::cylinder:
      return pi * r * r * (dimension_ == 2 ? 1.0 : form_.length);
    case Form::Kind::stl:
      return coupling::solid_moments(mesh_->triangles()).volume;
    default:
      for (std::size_t k = 0; k < form_.polygon.size(); ++k) {
        const Vec3d& a = form_.polygon[k];
        const Vec3d& b = form_.polygon[(k + 1) % form_.polygon.size()];
        result += 0.5 * (a[0] * b[1] - b[0] * a[1]);
      }
      return std::abs(result) * (dimension_ == 2 ? 1.0 : high_ - low_);
  }
}

std::vector<Vec3d> Solid::points(double spacing, double depth) const {
  if (form_.kind == Form::Kind::cylinder || form_.kind == Form::Kind::sphere) return round_points(spacing, depth);
  const BoxRegion box = bounds(form_, dimension_);
  const auto distance_to = [&](const coupling::Vec3& place, coupling::Vec3& away) {
    Vec3d normal{};
    const double result = distance(place.data(), &normal);
    away = vector(normal.data());
    return result;
  };
  std::vector<Vec3d> result;
  for (const coupling::LayerPoint& point :
       coupling::layer_points({vector(box.lower.data()), vector(box.upper.data())}, coupling::Vec3::Constant(spacing),
                              dimension_, spacing, depth, distance_to)) {
    result.push_back({point.position.x(), point.position.y(), point.position.z()});
  }
  return result;
}

std::vector<Vec3d> Solid::round_points(double spacing, double depth) const {
  coupling::Shape shape;
  shape.kind = form_.kind == Form::Kind::sphere ? coupling::ShapeKind::sphere : coupling::ShapeKind::cylinder;
  shape.size = {form_.radius, form_.length, 0};
  shape.density = 1;
  std::vector<Vec3d> result;
  for (const coupling::ShapePoint& point : shape.points(spacing, depth, dimension_)) {
    Vec3d x = form_.centre;
    x[u_] += point.position.x();
    x[v_] += point.position.y();
    if (dimension_ == 3) x[w_] += point.position.z();
    result.push_back(x);
  }
  return result;
}

}  // namespace embacle::mps
