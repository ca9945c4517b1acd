#include "contact/patch.hpp"

#include <algorithm>
#include <limits>

namespace embacle::liggghts {

using coupling::Vec3;

namespace {

/// Pressure = slope . x + value.
struct PressureField {
  Vec3 slope;
  double value;
  double operator()(const Vec3& x) const { return slope.dot(x) + value; }
  /// How much larger this is than the other.
  [[nodiscard]] double above(const PressureField& other, const Vec3& x) const { return (*this)(x)-other(x); }
};

PressureField pressure_field(const PosedShape& body, const ConvexShape::Face& face) {
  const HalfSpace outside = body.to_global(face.outside);
  return {-body.hardness * outside.normal, body.hardness * outside.offset};
}

/// Adds a polygon with a linear pressure: the middles of the edges of its triangles integrate quadratic functions
/// exactly, so also moments of the pressure. The side of the corners' sense does not matter.
void add_polygon(const Polygon& polygon, const Vec3& normal, const PressureField& pressure, double spring,
                 Patch& patch) {
  const auto& corners = polygon.corners();
  for (std::size_t c = 2; c < corners.size(); ++c) {
    const double area = 0.5 * (corners[c - 1] - corners[0]).cross(corners[c] - corners[0]).norm();
    if (area == 0) continue;
    patch.stiffness += spring * area;
    const Vec3 share = normal * (area / 3);
    for (const Vec3& middle : {Vec3(0.5 * (corners[0] + corners[c - 1])), Vec3(0.5 * (corners[c - 1] + corners[c])),
                               Vec3(0.5 * (corners[c] + corners[0]))}) {
      patch.places.push_back({middle, share, std::max(0.0, pressure(middle))});
    }
  }
}

/// The box around a face's corners, which are given, and `depth` [m] around it.
coupling::Box face_box(const ConvexShape::Face& face, const std::vector<Vec3>& corners, double depth) {
  coupling::Box box{corners[face.corners[0]], corners[face.corners[0]]};
  for (const int c : face.corners) {
    box.lower = box.lower.cwiseMin(corners[c]);
    box.upper = box.upper.cwiseMax(corners[c]);
  }
  box.lower.array() -= depth;
  box.upper.array() += depth;
  return box;
}

bool overlap(const coupling::Box& a, const coupling::Box& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

/// A face with what the search for patches needs of it, in the frame of the first body.
struct NearFace {
  const ConvexShape::Face* face;
  coupling::Box box;  ///< around the part of its region that the overlap may hold
  PressureField pressure;
  std::vector<HalfSpace> region;
};

/// The faces of `body` whose regions may take part; `corners`: of the body in the frame, `around`: the other body's
/// box.
void near_faces(const PosedShape& body, const std::vector<Vec3>& corners, double depth, const coupling::Box& around,
                std::vector<NearFace>& faces) {
  faces.clear();
  for (const auto& face : body.shape->faces) {
    const coupling::Box box = face_box(face, corners, depth);
    if (!overlap(box, around)) continue;
    NearFace near{&face, box, pressure_field(body, face), {}};
    near.region.reserve(face.region.size());
    for (const HalfSpace& bound : face.region) near.region.push_back(body.to_global(bound));
    faces.push_back(std::move(near));
  }
}

coupling::Box box_around(const std::vector<Vec3>& corners) {
  coupling::Box box{corners[0], corners[0]};
  for (const Vec3& corner : corners) {
    box.lower = box.lower.cwiseMin(corner);
    box.upper = box.upper.cwiseMax(corner);
  }
  return box;
}

bool cut_by(const std::vector<HalfSpace>& region, Polygon& polygon) {
  return std::all_of(region.begin(), region.end(), [&](const HalfSpace& bound) { return polygon.cut(bound); });
}

/// `deepest`: distance of the body's deepest corner beyond the wall; no place on the wall is deeper in the body.
void press_polygon(const PosedShape& body, const Polygon& whole, const Vec3& normal, double deepest, Patch& patch) {
  thread_local Polygon polygon;
  const Vec3 direction = body.axes.transpose() * normal;
  const double level = direction.dot(body.axes.transpose() * (whole.corners()[0] - body.position));
  for (const auto& face : body.shape->faces) {
    const bool near = std::any_of(face.corners.begin(), face.corners.end(), [&](int c) {
      return direction.dot(body.shape->corners[c]) - level <= deepest * (1 + 1e-9);
    });
    if (!near) continue;
    polygon = whole;
    const bool left = std::all_of(face.region.begin(), face.region.end(),
                                  [&](const HalfSpace& bound) { return polygon.cut(body.to_global(bound)); });
    if (left) add_polygon(polygon, normal, pressure_field(body, face), body.hardness, patch);
  }
}

}  // namespace

void press(const PosedShape& first, const PosedShape& second, double overlap_depth, Patch& patch) {
  thread_local std::vector<NearFace> first_faces, second_faces;
  thread_local std::vector<Vec3> second_corners;
  thread_local Polygon polygon;
  // In the frame of the first body, where the boxes around its faces are tight. Neither pressure in the overlap exceeds
  // what the overlap's depth gives in the harder body.
  const PosedShape a{first.shape, coupling::Mat3::Identity(), Vec3::Zero(), first.hardness};
  const PosedShape b{second.shape, first.axes.transpose() * second.axes,
                     first.axes.transpose() * (second.position - first.position), second.hardness};
  second_corners.clear();
  for (const Vec3& corner : second.shape->corners) second_corners.push_back(b.to_global(corner));
  const double most = std::max(first.hardness, second.hardness) * overlap_depth * (1 + 1e-9);
  near_faces(a, first.shape->corners, most / first.hardness, box_around(second_corners), first_faces);
  near_faces(b, second_corners, most / second.hardness, box_around(first.shape->corners), second_faces);
  const double spring = first.hardness * second.hardness / (first.hardness + second.hardness);
  const std::size_t begin = patch.places.size();
  for (const NearFace& f : first_faces) {
    for (const NearFace& g : second_faces) {
      const Vec3 lower = f.box.lower.cwiseMax(g.box.lower), upper = f.box.upper.cwiseMin(g.box.upper);
      if ((lower.array() > upper.array()).any()) continue;
      // Equal pressure: difference . x + value = 0; the difference grows into the first body.
      const Vec3 difference = f.pressure.slope - g.pressure.slope;
      const double length = difference.norm();
      if (length < 1e-9 * (first.hardness + second.hardness)) continue;
      const Vec3 normal = difference / length;
      const Vec3 centre = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
      const double height = f.pressure.above(g.pressure, centre) / length;
      if (std::abs(height) > half.dot(normal.cwiseAbs())) continue;  // the plane passes by
      polygon.set_square(centre - height * normal, normal, half.norm());
      if (cut_by(f.region, polygon) && cut_by(g.region, polygon)) {
        add_polygon(polygon, normal, f.pressure, spring, patch);
      }
    }
  }
  for (std::size_t p = begin; p < patch.places.size(); ++p) {
    patch.places[p].position = first.to_global(patch.places[p].position);
    patch.places[p].area = first.axes * patch.places[p].area;
  }
}

void press_plane(const PosedShape& body, const Vec3& point, const Vec3& normal, Patch& patch) {
  const double deepest = -separation_from_plane(body, point, normal);
  if (deepest <= 0) return;
  const double height = normal.dot(body.position - point);
  thread_local Polygon whole;
  whole.set_square(body.position - height * normal, normal, body.shape->reach);
  press_polygon(body, whole, normal, deepest, patch);
}

void press_triangle(const PosedShape& body, const coupling::Triangle& triangle, const Vec3& normal, Patch& patch) {
  const double deepest = -separation_from_plane(body, triangle[0], normal);
  if (deepest <= 0) return;
  thread_local Polygon whole;
  whole.set({triangle.begin(), triangle.end()});
  press_polygon(body, whole, normal, deepest, patch);
}

double separation(const PosedShape& first, const PosedShape& second) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const auto& [body, other] : {std::pair(&first, &second), std::pair(&second, &first)}) {
    const coupling::Mat3 turn = body->axes.transpose() * other->axes;
    const Vec3 shift = body->axes.transpose() * (other->position - body->position);
    for (const auto& face : body->shape->faces) {
      const Vec3 direction = turn.transpose() * face.outside.normal;
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec3& corner : other->shape->corners) nearest = std::min(nearest, direction.dot(corner));
      largest = std::max(largest, nearest + face.outside.normal.dot(shift) - face.outside.offset);
    }
  }
  return largest;
}

double separation_from_triangle(const PosedShape& body, const coupling::Triangle& triangle) {
  Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  if (normal.dot(triangle[0] - body.position) > 0) normal = -normal;
  double largest = separation_from_plane(body, triangle[0], normal);
  for (const auto& face : body.shape->faces) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& corner : triangle) {
      nearest = std::min(nearest, face.outside.normal.dot(body.axes.transpose() * (corner - body.position)));
    }
    largest = std::max(largest, nearest - face.outside.offset);
  }
  return largest;
}

double separation_from_plane(const PosedShape& body, const Vec3& point, const Vec3& normal) {
  const Vec3 direction = body.axes.transpose() * normal;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& corner : body.shape->corners) nearest = std::min(nearest, direction.dot(corner));
  return nearest + normal.dot(body.position - point);
}

}  // namespace embacle::liggghts
