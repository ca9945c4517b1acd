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

/// In the body's own frame.
PressureField pressure_field(double hardness, const HalfSpace& outside) {
  return {-hardness * outside.normal, hardness * outside.offset};
}

/// Adds a polygon with a linear pressure. The middles of the edges of its triangles integrate quadratic functions
/// exactly, so also moments of the pressure; triangles side by side share one. The spread, of third order, takes the
/// corners and centroids as well. The polygon, `pressure` and the unit normal towards the first body are in the frame
/// of `pose`.
void add_polygon(const PosedShape& pose, const FlatPolygon& polygon, const Vec3& normal, const PressureField& pressure,
                 double spring, Patch& patch) {
  using Corner = FlatPolygon::Corner;
  const Vec3 origin = pose.to_global(polygon.origin());
  const Vec3 along = pose.axes * polygon.along(), across = pose.axes * polygon.across();
  const Vec3 direction = pose.axes * normal;
  const double at_origin = pressure(polygon.origin());
  const double per_s = pressure.slope.dot(polygon.along()), per_t = pressure.slope.dot(polygon.across());
  const auto place = [&](const Corner& at) -> Vec3 { return origin + at.s * along + at.t * across; };
  const auto pressed = [&](const Corner& at) { return std::max(0.0, at_origin + at.s * per_s + at.t * per_t); };
  const auto moment = [&](const Corner& at) { return pressed(at) * place(at).squaredNorm(); };
  const auto middle = [](const Corner& a, const Corner& b) { return Corner{0.5 * (a.s + b.s), 0.5 * (a.t + b.t)}; };
  const auto add = [&](const Corner& at, double area) {
    const double here = pressed(at), size = here * area;
    patch.highest = std::max(patch.highest, here);
    patch.places.push_back({place(at), size * direction, size});
  };
  const Corner& a = polygon.corner(0);
  double before = 0, whole = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const double area = polygon.area(k);
    const Corner &b = polygon.corner(k - 1), &c = polygon.corner(k);
    const Corner ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    const Corner centroid{(a.s + b.s + c.s) / 3, (a.t + b.t + c.t) / 3};
    patch.spread +=
        area / 60 *
        (3 * (moment(a) + moment(b) + moment(c)) + 8 * (moment(ab) + moment(bc) + moment(ca)) + 27 * moment(centroid));
    add(ab, (before + area) / 3);
    add(bc, area / 3);
    before = area;
    whole += area;
  }
  add(middle(a, polygon.corner(polygon.size() - 1)), before / 3);
  patch.stiffness += spring * whole;
}

/// A box by its middle and half its edges.
struct MiddleBox {
  Vec3 centre, half;
  explicit MiddleBox(const coupling::Box& box) : centre(0.5 * (box.lower + box.upper)), half(box.upper - centre) {}
};

/// A face with what the search for patches needs of it, in the frame of the first body.
struct NearFace {
  coupling::Box box;  ///< around the part of its region that the overlap may hold
  PressureField pressure;
  std::size_t begin, end;  ///< of its bounds that cut the box
};

struct NearFaces {
  std::vector<NearFace> faces;
  std::vector<HalfSpace> bounds;
  void clear() {
    faces.clear();
    bounds.clear();
  }
  [[nodiscard]] std::span<const HalfSpace> of(const NearFace& face) const {
    return {bounds.data() + face.begin, face.end - face.begin};
  }
  /// Adds a face in a box, which holds places of its region down to `depth` [m]; `around`: a box around the overlap.
  template <typename Transform>
  void add(const ConvexShape::Face& face, coupling::Box box, double hardness, double depth, const coupling::Box& around,
           const Transform& to_frame) {
    box.lower = (box.lower.array() - depth).matrix().cwiseMax(around.lower);
    box.upper = (box.upper.array() + depth).matrix().cwiseMin(around.upper);
    if ((box.lower.array() > box.upper.array()).any()) return;
    const MiddleBox middle(box);
    const std::size_t begin = bounds.size();
    for (const HalfSpace& bound : face.region) {
      const HalfSpace here = to_frame(bound);
      if (here.misses(middle.centre, middle.half)) {
        bounds.resize(begin);
        return;
      }
      if (!here.holds(middle.centre, middle.half)) bounds.push_back(here);
    }
    faces.push_back({box, pressure_field(hardness, to_frame(face.outside)), begin, bounds.size()});
  }
};

/// Area [m^2] of the largest side of a box.
double largest_section(const coupling::Box& box) {
  const Vec3 edge = box.upper - box.lower;
  return std::max({edge[0] * edge[1], edge[1] * edge[2], edge[2] * edge[0]});
}

/// `whole`: of the wall, in the body's frame; `deepest`: distance of the body's deepest corner beyond the wall: no
/// place on the wall is deeper in the body.
void press_polygon(const PosedShape& body, const FlatPolygon& whole, const Vec3& direction, double level,
                   double deepest, Patch& patch) {
  thread_local FlatPolygon polygon;
  for (const auto& face : body.shape->faces) {
    const bool near = std::any_of(face.corners.begin(), face.corners.end(), [&](int c) {
      return direction.dot(body.shape->corners[c]) - level <= deepest * (1 + 1e-9);
    });
    if (!near) continue;
    polygon = whole;
    const bool left =
        std::all_of(face.region.begin(), face.region.end(), [&](const HalfSpace& bound) { return polygon.cut(bound); });
    if (left) {
      add_polygon(body, polygon, direction, pressure_field(body.hardness, face.outside), body.hardness, patch);
    }
  }
}

}  // namespace

void press(const PosedShape& first, const PosedShape& second, double overlap_depth, Patch& patch) {
  thread_local NearFaces ours, theirs;
  thread_local std::vector<Vec3> their_corners;
  thread_local FlatPolygon polygon;
  thread_local std::vector<FlatPolygon::HalfPlane> cuts;
  // In the frame of the first body, where the boxes around its faces are tight. A place at a depth below the face that
  // separates them best is at most the rest of the overlap's depth below the other's surface; where the pressures are
  // equal, both depths follow.
  const coupling::Mat3 turn = first.axes.transpose() * second.axes;
  // Faces of both bodies that lie in one plane would have the same pressure in a whole region: a hair between them,
  // which is fixed to the first body and so changes the potential but not that there is one.
  const Vec3 hair = 1e-12 * first.shape->reach * Vec3(1.0, 1.3, 1.7);
  const Vec3 shift = first.axes.transpose() * (second.position - first.position) + hair;
  their_corners.clear();
  for (const Vec3& corner : second.shape->corners) their_corners.emplace_back(shift + turn * corner);
  coupling::Box around = box_around(their_corners);
  around.lower = around.lower.cwiseMax(first.shape->box.lower);
  around.upper = around.upper.cwiseMin(first.shape->box.upper);
  const double spring = first.hardness * second.hardness / (first.hardness + second.hardness);
  const double most = spring * (overlap_depth * (1 + 1e-9) + hair.norm());
  ours.clear();
  theirs.clear();
  for (const auto& face : first.shape->faces) {
    ours.add(face, face.box, first.hardness, most / first.hardness, around,
             [](const HalfSpace& bound) { return bound; });
  }
  for (const auto& face : second.shape->faces) {
    const auto box = box_around(face.corners, [&](int c) -> const Vec3& { return their_corners[c]; });
    theirs.add(face, box, second.hardness, most / second.hardness, around, [&](const HalfSpace& bound) {
      const Vec3 normal = turn * bound.normal;
      return HalfSpace{normal, bound.offset + normal.dot(shift)};
    });
  }
  const double negligible = 1e-7 * largest_section(around);
  for (const NearFace& f : ours.faces) {
    for (const NearFace& g : theirs.faces) {
      const coupling::Box box{f.box.lower.cwiseMax(g.box.lower), f.box.upper.cwiseMin(g.box.upper)};
      if ((box.lower.array() > box.upper.array()).any() || largest_section(box) < negligible) continue;
      // Equal pressure: difference . x + value = 0; the difference grows into the first body.
      const Vec3 difference = f.pressure.slope - g.pressure.slope;
      const double value = f.pressure.value - g.pressure.value;
      const MiddleBox middle(box);
      if (std::abs(difference.dot(middle.centre) + value) > difference.cwiseAbs().dot(middle.half)) continue;
      const auto missed = [&](const HalfSpace& bound) { return bound.misses(middle.centre, middle.half); };
      if (std::ranges::any_of(ours.of(f), missed) || std::ranges::any_of(theirs.of(g), missed)) continue;
      const double length = difference.norm();
      if (length < 1e-9 * (first.hardness + second.hardness)) continue;
      const Vec3 normal = difference / length;
      cuts.clear();
      if (polygon.set(normal, -value / length, box.lower, box.upper, cuts) && polygon.gather(ours.of(f), cuts) &&
          polygon.gather(theirs.of(g), cuts) && polygon.cut(cuts)) {
        add_polygon(first, polygon, normal, f.pressure, spring, patch);
      }
    }
  }
}

void press_plane(const PosedShape& body, const Vec3& point, const Vec3& normal, Patch& patch) {
  const double deepest = -separation_from_plane(body, point, normal);
  if (deepest <= 0) return;
  const Vec3 direction = body.axes.transpose() * normal;
  const double level = normal.dot(point - body.position);
  thread_local FlatPolygon whole;
  if (whole.set(direction, level, body.shape->box.lower, body.shape->box.upper)) {
    press_polygon(body, whole, direction, level, deepest, patch);
  }
}

void press_triangle(const PosedShape& body, const coupling::Triangle& triangle, const Vec3& normal, Patch& patch) {
  const double deepest = -separation_from_plane(body, triangle[0], normal);
  if (deepest <= 0) return;
  const Vec3 direction = body.axes.transpose() * normal;
  coupling::Triangle here;
  for (int c = 0; c < 3; ++c) here[c] = body.axes.transpose() * (triangle[c] - body.position);
  const double level = direction.dot(here[0]);
  thread_local FlatPolygon whole;
  whole.set(direction, level, here);
  press_polygon(body, whole, direction, level, deepest, patch);
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
