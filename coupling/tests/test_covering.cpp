// Prisms and solids of triangles, coverings by spheres and their errors, against closed formulas and random places.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {
namespace {

using Vec2 = Eigen::Vector2d;
using std::numbers::pi;

const std::vector<Vec2> ell = {{0, 0}, {0.6, 0}, {0.6, 0.2}, {0.2, 0.2}, {0.2, 0.5}, {0, 0.5}};
const std::vector<Vec2> pentagon = {{0.1, 0}, {0.7, 0.1}, {0.8, 0.4}, {0.4, 0.6}, {0, 0.3}};
const std::vector<Vec2> triangle = {{0, 0}, {0.6, 0}, {0, 0.4}};

std::vector<Vec2> rectangle(double a, double b) { return {{0, 0}, {a, 0}, {a, b}, {0, b}}; }

std::vector<Triangle> tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
}

/// The triangles of a shape, moved and turned.
std::vector<Triangle> moved(const Shape& shape, const Quaternion& turn, const Vec3& shift) {
  std::vector<Triangle> triangles = shape.polyhedron->surface.triangles();
  for (Triangle& t : triangles) {
    for (Vec3& corner : t) corner = turn * corner + shift;
  }
  return triangles;
}

const Quaternion tilt(Eigen::AngleAxisd(0.7, Vec3(1, -2, 3).normalized()));

Shape named(Shape shape, const char* name) {
  shape.name = name;
  return shape;
}

std::vector<Shape> polyhedra() {
  return {named(make_prism(ell, 0.1, 900), "ell"), named(make_prism(pentagon, 0.15, 900), "pentagon"),
          named(make_prism(triangle, 0.2, 900), "triangle"),
          named(make_solid(moved(make_prism(ell, 0.2, 1), tilt, Vec3(3, 2, 1)), 900), "solid"),
          named(make_solid(tetrahedron({0, 0, 0}, {0.5, 0, 0}, {0, 0.6, 0}, {0, 0, 0.7}), 900), "tetrahedron")};
}

/// Inertia tensor of a shape about its centre of mass in the frame in which it was given.
Mat3 given_inertia(const Shape& shape) {
  const Mat3 axes = shape.given_axes.toRotationMatrix();
  return axes * shape.mass_properties().inertia.asDiagonal() * axes.transpose();
}

TEST(Polyhedron, ARectangularPrismIsTheBox) {
  const Shape box{.name = "box", .kind = ShapeKind::box, .size = Vec3(0.5, 0.3, 0.1), .density = 917};
  const Shape prism = make_prism(rectangle(0.5, 0.3), 0.1, 917);
  const MassProperties a = box.mass_properties(), b = prism.mass_properties();
  EXPECT_NEAR(b.volume / a.volume, 1, 1e-14);
  EXPECT_NEAR(b.mass / a.mass, 1, 1e-14);
  EXPECT_LT((a.inertia - b.inertia).norm(), 1e-14 * a.inertia.norm());
  EXPECT_LT((prism.given_centre - Vec3(0.25, 0.15, 0)).norm(), 1e-15);
  EXPECT_EQ(prism.given_axes.angularDistance(Quaternion::Identity()), 0);
  EXPECT_NEAR(prism.bounding_radius(), box.bounding_radius(), 1e-15);
  EXPECT_NEAR(prism.surface_area(), box.surface_area(), 1e-15);
  EXPECT_NEAR(prism.inscribed_radius(), 0.05, 1e-12);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.4, 0.4);
  for (int k = 0; k < 5000; ++k) {
    const Vec3 place(coordinate(random), coordinate(random), coordinate(random));
    EXPECT_NEAR(prism.signed_distance(place), box.signed_distance(place), 1e-14);
  }
}

TEST(Polyhedron, ATriangularPrismHasTheMomentsOfTheTextbook) {
  // Right triangle with legs a, b: Ixx = A b^2 / 18, Iyy = A a^2 / 18, product of inertia A a b / 36 about the
  // centroid.
  const double a = 0.6, b = 0.4, length = 0.2, density = 900, area = a * b / 2, mass = density * area * length;
  const Shape prism = make_prism(triangle, length, density);
  EXPECT_NEAR(prism.mass_properties().mass, mass, 1e-13 * mass);
  EXPECT_LT((prism.given_centre - Vec3(a / 3, b / 3, 0)).norm(), 1e-15);
  Mat3 expected = Mat3::Zero();
  expected(0, 0) = mass * (b * b / 18 + length * length / 12);
  expected(1, 1) = mass * (a * a / 18 + length * length / 12);
  expected(2, 2) = mass * (a * a + b * b) / 18;
  expected(0, 1) = expected(1, 0) = mass * a * b / 36;  // minus the integral of x y, which is negative
  EXPECT_LT((given_inertia(prism) - expected).norm(), 1e-13 * expected.norm());
  EXPECT_NEAR((prism.given_axes * Vec3::UnitZ() - Vec3::UnitZ()).norm(), 0, 1e-15);  // the axis stays the axis
}

TEST(Polyhedron, ARegularTetrahedronHasEqualMoments) {
  // Edge s: I = m s^2 / 20 about every axis through the centre.
  const double s = 0.5 * std::sqrt(8.0);
  const Shape solid =
      make_solid(tetrahedron({0.5, 0.5, 0.5}, {-0.5, 0.5, -0.5}, {0.5, -0.5, -0.5}, {-0.5, -0.5, 0.5}), 1000);
  const double mass = 1000 * s * s * s / (6 * std::sqrt(2.0));
  EXPECT_NEAR(solid.mass_properties().mass / mass, 1, 1e-14);
  EXPECT_LT((solid.mass_properties().inertia / (mass * s * s / 20) - Vec3::Ones()).norm(), 1e-13);
  EXPECT_EQ(solid.given_axes.angularDistance(Quaternion::Identity()), 0);  // no axis is better than the given ones
}

TEST(Polyhedron, AnEllOfTwoBoxesObeysTheParallelAxisTheorem) {
  const double length = 0.1, density = 900;
  const Shape prism = make_prism(ell, length, density);
  // The L as two boxes: [0, 0.6] x [0, 0.2] and [0, 0.2] x [0.2, 0.5].
  const Vec3 sizes[] = {{0.6, 0.2, length}, {0.2, 0.3, length}}, centres[] = {{0.3, 0.1, 0}, {0.1, 0.35, 0}};
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  for (int k = 0; k < 2; ++k) {
    mass += density * sizes[k].prod();
    centre += density * sizes[k].prod() * centres[k];
  }
  centre /= mass;
  Mat3 inertia = Mat3::Zero();
  for (int k = 0; k < 2; ++k) {
    const Shape box{.name = "part", .kind = ShapeKind::box, .size = sizes[k], .density = density};
    const MassProperties part = box.mass_properties();
    const Vec3 arm = centres[k] - centre;
    inertia +=
        Mat3(part.inertia.asDiagonal()) + part.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  EXPECT_NEAR(prism.mass_properties().mass / mass, 1, 1e-14);
  EXPECT_LT((prism.given_centre - centre).norm(), 1e-15);
  EXPECT_LT((given_inertia(prism) - inertia).norm(), 1e-14 * inertia.norm());
  EXPECT_GT(std::abs(inertia(0, 1)), 0.05 * inertia.norm());  // the test is about products of inertia too
}

TEST(Polyhedron, MovedAndTurnedTrianglesGiveTheSameBody) {
  const Shape prism = make_prism(ell, 0.2, 900);
  const Vec3 shift(30, -20, 10);
  const Shape solid = make_solid(moved(prism, tilt, shift), 900);
  const Vec3 a = prism.mass_properties().inertia, b = solid.mass_properties().inertia;
  EXPECT_NEAR(solid.mass_properties().mass / prism.mass_properties().mass, 1, 1e-12);
  EXPECT_LT((solid.given_centre - shift).norm(), 1e-12);
  for (int axis = 0; axis < 3; ++axis) {  // the same three, perhaps in another order
    double nearest = 1;
    for (int other = 0; other < 3; ++other) nearest = std::min(nearest, std::abs(b[axis] - a[other]) / a[other]);
    EXPECT_LT(nearest, 1e-11) << axis;
  }
  const Mat3 turn = tilt.toRotationMatrix(), expected = turn * a.asDiagonal() * turn.transpose();
  EXPECT_LT((given_inertia(solid) - expected).norm(), 1e-11 * expected.norm());
  EXPECT_NEAR(solid.given_axes.toRotationMatrix().determinant(), 1, 1e-12);
}

TEST(Polyhedron, TheSenseOfAPolygonDoesNotMatter) {
  std::vector<Vec2> clockwise(ell.rbegin(), ell.rend());
  clockwise.insert(clockwise.begin() + 1, Vec2(0.5 * (clockwise[0] + clockwise[1])));  // a corner that does not turn
  const Shape a = make_prism(ell, 0.1, 900), b = make_prism(clockwise, 0.1, 900);
  EXPECT_NEAR(b.mass_properties().mass, a.mass_properties().mass, 1e-13 * a.mass_properties().mass);
  EXPECT_EQ(b.polyhedron->polygon.size(), 6U);
  EXPECT_LT((given_inertia(a) - given_inertia(b)).norm(), 1e-13 * given_inertia(a).norm());
}

template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Polyhedron, WrongPolygonsAreNamed) {
  const auto message = [](const std::vector<Vec2>& corners) {
    return message_of([&] { (void)make_prism(corners, 0.1, 900); });
  };
  EXPECT_EQ(message({{0, 0}, {1, 0}}), "a polygon needs at least 3 corners, not 2");
  EXPECT_EQ(message({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), "corners 2 and 3 of the polygon are at the same place");
  EXPECT_NE(message({{0, 0}, {1, 1}, {1, 0}, {0, 1}}).find("edge from corner 1 to 2 meets the one from 3 to 4"),
            std::string::npos);
  EXPECT_NE(message({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}).find("meets"), std::string::npos);  // touches itself
  EXPECT_NE(message({{0, 0}, {2, 0}, {1, 0}, {1, 1}}).find("meets"), std::string::npos);          // runs back
  EXPECT_NE(message({{0, 0}, {1, 0}, {2, 0}}).find("meets"), std::string::npos);                  // no area
}

TEST(Polyhedron, PointsSharesAndPiecesCoverTheSurface) {
  for (const Shape& shape : polyhedra()) {
    for (const double spacing : {0.013, 0.02, 0.05}) {
      std::vector<SurfacePiece> pieces;
      const auto points = shape.points(spacing, 1e9, 3, &pieces);
      double area = 0, of_pieces = 0;
      for (const ShapePoint& point : points) {
        area += point.area;
        const double distance = shape.signed_distance(point.position);
        EXPECT_LT(distance, -0.2 * spacing) << shape.name;
        EXPECT_LT(point.normal.norm(), 1 + 1e-12);
      }
      EXPECT_NEAR(area / shape.surface_area(), 1, 1e-12) << shape.name;
      Vec3 closed = Vec3::Zero(), torque = Vec3::Zero();
      double volume = 0;
      for (const SurfacePiece& piece : pieces) {
        of_pieces += piece.area.norm();
        closed += piece.area;
        torque += piece.place.cross(piece.area);
        volume += piece.place.dot(piece.area) / 3;
        EXPECT_NEAR(shape.signed_distance(piece.place), 0, 1e-9);
        EXPECT_LT((points[piece.point].position - piece.place).norm(), 2.5 * spacing) << shape.name;
      }
      EXPECT_NEAR(of_pieces / shape.surface_area(), 1, 1e-12) << shape.name;
      EXPECT_LT(closed.norm(), 1e-12 * shape.surface_area()) << shape.name;
      EXPECT_LT(torque.norm(), 1e-12 * shape.surface_area() * shape.bounding_radius()) << shape.name;
      EXPECT_NEAR(volume / shape.mass_properties().volume, 1, 1e-12) << shape.name;
    }
  }
}

TEST(Polyhedron, PointsAreEvenAndRepresentTheVolume) {
  for (const Shape& shape : polyhedra()) {
    const double spacing = 0.02;
    const auto points = shape.points(spacing, 1e9);
    const double represented = static_cast<double>(points.size()) * spacing * spacing * spacing;
    EXPECT_NEAR(represented / shape.mass_properties().volume, 1, 0.1) << shape.name << ": " << points.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        ASSERT_GT((points[i].position - points[j].position).norm(), spacing / 2.2) << shape.name;
      }
    }
    // No place just below the surface is far from a point.
    double farthest = 0;
    shape.visit_surface(spacing, [&](const Vec3& place, const Vec3&) {
      double nearest = 1;
      for (const ShapePoint& point : points) nearest = std::min(nearest, (point.position - place).norm());
      farthest = std::max(farthest, nearest);
    });
    EXPECT_LT(farthest, 3 * spacing) << shape.name;  // in the sharpest corners
    EXPECT_LT(shape.points(spacing, 1.1 * spacing).size(), points.size());
  }
  const Shape plate = make_prism(rectangle(0.5, 0.3), 0.1, 900);  // where it fits, the lattice of the box
  EXPECT_EQ(plate.points(0.02, 1e9).size(), 25U * 15U * 5U);
  EXPECT_EQ(plate.points(0.02, 1e9, 2).size(), 25U * 15U);
}

TEST(Polyhedron, SlicesOfPrismsCloseInTwoDimensions) {
  for (const auto& polygon : {ell, pentagon, triangle}) {
    const Shape prism = make_prism(polygon, 1, 900);
    double perimeter = 0, length = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k)
      perimeter += (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
    std::vector<SurfacePiece> pieces;
    for (const ShapePoint& point : prism.points(0.02, 0.05, 2, &pieces)) {
      EXPECT_EQ(point.position.z(), 0);
      length += point.area;
    }
    EXPECT_NEAR(length, perimeter, 1e-12);
    Vec3 closed = Vec3::Zero();
    for (const SurfacePiece& piece : pieces) closed += piece.area;
    EXPECT_LT(closed.norm(), 1e-13);
  }
  const Shape solid = make_solid(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_THROW((void)solid.points(0.1, 1, 2), InputError);
}

TEST(Polyhedron, ExtentsFollowTheCorners) {
  const Shape prism = make_prism(triangle, 0.2, 900);
  const Box box = prism.extents(tilt);
  Vec3 lower = Vec3::Constant(1e9), upper = -lower;
  for (const Triangle& t : prism.polyhedron->surface.triangles()) {
    for (const Vec3& corner : t) {
      lower = lower.cwiseMin(tilt * corner);
      upper = upper.cwiseMax(tilt * corner);
    }
  }
  EXPECT_LT((box.lower - lower).norm() + (box.upper - upper).norm(), 1e-15);
}

TEST(Covering, SpheresOfPolyhedraTouchTheFacesFromInside) {
  for (const Shape& shape : polyhedra()) {
    for (const double spacing : {0.1, 0.3}) {
      const auto spheres = shape.covering_spheres(spacing);
      ASSERT_FALSE(spheres.empty()) << shape.name;
      double nearest = 1;
      for (std::size_t i = 0; i < spheres.size(); ++i) {
        EXPECT_NEAR(shape.signed_distance(spheres[i].centre) + spheres[i].radius, 0, 1e-8 * spheres[i].radius);
        for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, (spheres[i].centre - spheres[j].centre).norm());
      }
      EXPECT_GT(nearest, spacing / 2 * (1 - 1e-9)) << shape.name;
      const auto finer = shape.covering_spheres(spacing / 2);
      EXPECT_GT(finer.size(), spheres.size()) << shape.name;
    }
  }
}

TEST(Covering, ACountIsKept) {
  const Shape box{.name = "box", .kind = ShapeKind::box, .size = Vec3(0.5, 0.3, 0.1), .density = 917};
  const Shape disc{.name = "disc", .kind = ShapeKind::cylinder, .size = Vec3(0.3, 0.1, 0), .density = 917};
  for (const int count : {8, 60, 200}) {
    for (const Shape& shape : {box, disc}) {
      const auto spheres = shape.covering_spheres_of_count(count);
      EXPECT_LE(static_cast<int>(spheres.size()), count) << shape.name;
      EXPECT_GT(static_cast<int>(spheres.size()), count / 3) << shape.name << count;
    }
    for (const Shape& shape : polyhedra()) {
      EXPECT_EQ(static_cast<int>(shape.covering_spheres_of_count(count).size()), count) << shape.name;
    }
  }
  EXPECT_EQ(make_prism(rectangle(0.5, 0.3), 0.1, 917).covering_spheres_of_count(4, 0.05).size(), 4U);
  EXPECT_NE(message_of([&] { (void)box.covering_spheres_of_count(3); }).find("at least 4 spheres"), std::string::npos);
  EXPECT_NE(message_of([&] { (void)box.covering_spheres_of_count(9, 0.06); }).find("0.05 m"), std::string::npos);
  EXPECT_THROW((void)box.covering_spheres_of_count(0), InputError);
}

TEST(Covering, FourSpheresOfAPlateStandInItsCorners) {
  const auto spheres = make_prism(rectangle(0.5, 0.3), 0.1, 917).covering_spheres_of_count(4, 0.05);
  for (const CoveringSphere& sphere : spheres) {
    EXPECT_LT((sphere.centre.cwiseAbs() - Vec3(0.2, 0.1, 0)).norm(), 1e-9) << sphere.centre.transpose();
  }
}

TEST(Covering, MoreSpheresLeaveSmallerGaps) {
  for (const Shape& shape : polyhedra()) {
    double before = 1;
    for (const int count : {4, 32, 128}) {
      const double gap = shape.covering_error(shape.covering_spheres_of_count(count)).largest_gap;
      EXPECT_LT(gap, before) << shape.name << " " << count;
      before = gap;
    }
    EXPECT_LT(before, 0.25 * shape.covering_error(shape.covering_spheres_of_count(4)).largest_gap + 0.02) << shape.name;
  }
}

TEST(CoveringError, ASphereInItselfHasNone) {
  const Shape ball{.name = "ball", .kind = ShapeKind::sphere, .size = Vec3(0.2, 0, 0), .density = 500};
  const CoveringError error = ball.covering_error(ball.covering_spheres(1));
  EXPECT_LT(error.largest_gap, 1e-15);
  EXPECT_LT(error.mean_gap, 1e-15);
  EXPECT_LT(error.largest_protrusion, 1e-15);
  EXPECT_EQ(error.outside_volume, 0);
  EXPECT_LT(error.missing_volume, 1e-3);
  EXPECT_NEAR(error.size, std::cbrt(4.0 / 3 * pi) * 0.2, 1e-15);
}

TEST(CoveringError, OneSphereInACubeIsKnownExactly) {
  const Shape cube{.name = "cube", .kind = ShapeKind::box, .size = Vec3::Ones(), .density = 917};
  const CoveringError inside = cube.covering_error({{Vec3::Zero(), 0.5}});
  EXPECT_NEAR(inside.largest_gap, 0.5 * std::sqrt(3.0) - 0.5, 1e-15);
  EXPECT_EQ(inside.outside_volume, 0);
  EXPECT_NEAR(inside.missing_volume, 1 - pi / 6, 2e-3);
  // The sphere through the corners: what it has outside are six caps.
  const double radius = 0.5 * std::sqrt(3.0), height = radius - 0.5;
  const CoveringError around = cube.covering_error({{Vec3::Zero(), radius}});
  EXPECT_LT(around.largest_gap, 1e-15);
  EXPECT_NEAR(around.largest_protrusion, height, 1e-15);
  EXPECT_NEAR(around.outside_volume, 4.0 / 3 * pi * radius * radius * radius - 1, 5e-3);
  EXPECT_LT(around.missing_volume, 1e-3);
}

/// Distance outside a prism of plane faces by all its triangles: no cells, no normals of edges.
double plain_gap(const Vec3& place, const std::vector<CoveringSphere>& spheres) {
  double gap = 1e9;
  for (const CoveringSphere& sphere : spheres) gap = std::min(gap, (place - sphere.centre).norm() - sphere.radius);
  return std::max(gap, 0.0);
}

/// Whether a place is inside: how often a ray along a crooked direction meets the triangles.
bool plain_inside(const Shape& shape, const Vec3& place) {
  const Vec3 ray(0.2718, 0.5772, 0.7701);
  int crossings = 0;
  for (const Triangle& t : shape.polyhedron->surface.triangles()) {
    const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], p = ray.cross(ac), s = place - t[0], q = s.cross(ab);
    const double det = ab.dot(p), u = s.dot(p) / det, v = ray.dot(q) / det;
    crossings += u >= 0 && v >= 0 && u + v <= 1 && ac.dot(q) / det > 0 ? 1 : 0;
  }
  return crossings % 2 == 1;
}

/// Distance to the nearest of very many random places of the surface.
std::vector<Vec3> random_surface(const Shape& shape, int count, std::mt19937& random) {
  std::vector<double> areas;
  for (const Triangle& t : shape.polyhedron->surface.triangles())
    areas.push_back((t[1] - t[0]).cross(t[2] - t[0]).norm());
  std::discrete_distribution<std::size_t> choose(areas.begin(), areas.end());
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> places;
  for (int k = 0; k < count; ++k) {
    const Triangle& t = shape.polyhedron->surface.triangles()[choose(random)];
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    places.emplace_back(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]));
  }
  return places;
}

TEST(CoveringError, AgreesWithMonteCarlo) {
  std::mt19937 random(11);
  for (const Shape& shape : polyhedra()) {
    auto spheres = shape.covering_spheres_of_count(40);
    for (CoveringSphere& sphere : spheres) sphere.radius += 0.02;  // so that something is outside
    const double radius = spheres.front().radius;
    const CoveringError error = shape.covering_error(spheres);

    double largest = 0, mean = 0;
    const auto surface = random_surface(shape, 20000, random);
    for (const Vec3& place : surface) {
      const double gap = plain_gap(place, spheres);
      largest = std::max(largest, gap);
      mean += gap / static_cast<double>(surface.size());
    }
    EXPECT_NEAR(error.largest_gap, largest, 0.15 * radius) << shape.name;
    EXPECT_NEAR(error.mean_gap, mean, 0.05 * mean + 1e-4 * error.size) << shape.name;

    const Box box = shape.extents(Quaternion::Identity());
    const Vec3 lower = box.lower.array() - 0.021, upper = box.upper.array() + 0.021;
    const double volume = (upper - lower).prod();
    std::uniform_real_distribution<double> uniform(0, 1);
    int outside = 0, missing = 0, inside = 0;
    constexpr int tries = 100000;
    for (int k = 0; k < tries; ++k) {
      const Vec3 place = lower + Vec3(uniform(random), uniform(random), uniform(random)).cwiseProduct(upper - lower);
      const bool in_shape = plain_inside(shape, place), in_union = plain_gap(place, spheres) == 0;
      inside += in_shape ? 1 : 0;
      outside += in_union && !in_shape ? 1 : 0;
      if (!in_shape || in_union) continue;
      double nearest = 1e9;  // to the planes' triangles, by the surface's random places where it matters
      for (const Triangle& t : shape.polyhedron->surface.triangles()) {
        const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
        const double below = -normal.dot(place - t[0]);
        if (below > radius) continue;
        nearest = std::min(nearest, std::abs(below));
      }
      if (nearest > radius) continue;  // even the planes of the faces are farther
      if (-shape.signed_distance(place) < radius) ++missing;
    }
    const double share = volume / tries / shape.mass_properties().volume;
    EXPECT_NEAR(inside * share, 1, 0.02) << shape.name;
    const auto tolerance = [&](int hits) { return 4 * share * std::sqrt(hits + 1.0) + 0.004; };
    EXPECT_NEAR(error.outside_volume, outside * share, tolerance(outside)) << shape.name;
    EXPECT_NEAR(error.missing_volume, missing * share, tolerance(missing)) << shape.name;
    EXPECT_GT(error.outside_volume, 0.005) << shape.name;
  }
}

TEST(ClosedSurface, DistanceIsThatOfTheNearestRandomPlace) {
  std::mt19937 random(5);
  for (const Shape& shape : polyhedra()) {
    const auto surface = random_surface(shape, 20000, random);
    std::uniform_real_distribution<double> coordinate(-0.5, 0.5);
    const double error = 3 * std::sqrt(shape.surface_area() / static_cast<double>(surface.size()));
    for (int k = 0; k < 100; ++k) {
      const Vec3 place(coordinate(random), coordinate(random), coordinate(random));
      double nearest = 1e9;
      for (const Vec3& other : surface) nearest = std::min(nearest, (place - other).norm());
      const double distance = shape.signed_distance(place);
      EXPECT_LE(std::abs(distance), nearest + 1e-12) << shape.name;
      EXPECT_GT(std::abs(distance), nearest - error) << shape.name;
      EXPECT_EQ(distance < 0, plain_inside(shape, place)) << shape.name;
    }
  }
}

TEST(Stl, FilesAreReadWithNameAndLine) {
  const std::string path = testing::TempDir() + "embacle-tetrahedron.stl";
  const auto write = [&](const std::string& number) {
    std::ofstream file(path);
    file << "solid t\n";
    for (const auto& t : tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (const Vec3& c : t) file << "vertex " << c.x() << ' ' << (c.y() == 1 ? number : "0") << ' ' << c.z() << '\n';
      file << "endloop\nendfacet\n";
    }
    file << "endsolid t\n";
  };
  write("1");
  const Shape solid = make_solid(read_stl(path), 6);
  EXPECT_NEAR(solid.mass_properties().mass, 1, 1e-14);
  EXPECT_LT((solid.given_centre - Vec3::Constant(0.25)).norm(), 1e-15);
  write("one");
  EXPECT_NE(message_of([&] { (void)read_stl(path); }).find(path + ":5: 'one' is not a number"), std::string::npos);
  std::remove(path.c_str());
  EXPECT_NE(message_of([&] { (void)read_stl(path); }).find("cannot read the STL file '" + path), std::string::npos);
}

}  // namespace
}  // namespace embacle::coupling
