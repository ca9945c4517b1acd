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

bool cut_by(const PosedShape& body, const ConvexShape::Face& face, Polygon& polygon) {
  return std::all_of(face.region.begin(), face.region.end(),
                     [&](const HalfSpace& bound) { return polygon.cut(body.to_global(bound)); });
}

/// Whether a sphere reaches into a body at all.
bool reaches(const Vec3& centre, double reach, const PosedShape& body) {
  const Vec3 x = body.axes.transpose() * (centre - body.position);
  return std::all_of(body.shape->faces.begin(), body.shape->faces.end(), [&](const ConvexShape::Face& face) {
    return face.outside.normal.dot(x) - face.outside.offset <= reach;
  });
}

/// Faces of `body` whose regions may meet `other`.
void candidates(const PosedShape& body, const PosedShape& other, std::vector<const ConvexShape::Face*>& faces) {
  faces.clear();
  for (const auto& face : body.shape->faces) {
    if (reaches(body.to_global(face.centre), face.reach, other)) faces.push_back(&face);
  }
}

void press_polygon(const PosedShape& body, const Polygon& whole, const Vec3& normal, Patch& patch) {
  thread_local Polygon polygon;
  for (const auto& face : body.shape->faces) {
    polygon = whole;
    if (cut_by(body, face, polygon)) {
      add_polygon(polygon, normal, pressure_field(body, face), body.hardness, patch);
    }
  }
}

}  // namespace

void press(const PosedShape& first, const PosedShape& second, Patch& patch) {
  thread_local std::vector<const ConvexShape::Face*> first_faces, second_faces;
  thread_local Polygon polygon;
  candidates(first, second, first_faces);
  candidates(second, first, second_faces);
  const double spring = first.hardness * second.hardness / (first.hardness + second.hardness);
  for (const auto* f : first_faces) {
    const PressureField of_first = pressure_field(first, *f);
    const Vec3 centre = first.to_global(f->centre);
    for (const auto* g : second_faces) {
      const PressureField of_second = pressure_field(second, *g);
      // Equal pressure: difference . x + value = 0; the difference grows into the first body.
      const Vec3 difference = of_first.slope - of_second.slope;
      const double length = difference.norm();
      if (length < 1e-9 * (first.hardness + second.hardness)) continue;
      const Vec3 normal = difference / length;
      const double height = (difference.dot(centre) + of_first.value - of_second.value) / length;
      if (std::abs(height) > f->reach) continue;
      polygon.set_square(centre - height * normal, normal, f->reach);
      if (cut_by(first, *f, polygon) && cut_by(second, *g, polygon)) {
        add_polygon(polygon, normal, of_first, spring, patch);
      }
    }
  }
}

void press_plane(const PosedShape& body, const Vec3& point, const Vec3& normal, Patch& patch) {
  const double height = normal.dot(body.position - point);
  if (std::abs(height) > body.shape->reach) return;
  thread_local Polygon whole;
  whole.set_square(body.position - height * normal, normal, body.shape->reach);
  press_polygon(body, whole, normal, patch);
}

void press_triangle(const PosedShape& body, const coupling::Triangle& triangle, const Vec3& normal, Patch& patch) {
  thread_local Polygon whole;
  whole.set({triangle.begin(), triangle.end()});
  press_polygon(body, whole, normal, patch);
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
