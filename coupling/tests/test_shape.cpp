// Shapes: exact mass properties, and points and covering spheres that respect the geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "embacle/coupling/shape.hpp"

namespace embacle::coupling {
namespace {

using std::numbers::pi;

const Shape floe{.name = "floe", .kind = ShapeKind::box, .size = Vec3(0.5, 0.3, 0.1), .density = 917};
const Shape ball{.name = "ball", .kind = ShapeKind::sphere, .size = Vec3(0.2, 0, 0), .density = 500};
const Shape log_{.name = "log", .kind = ShapeKind::cylinder, .size = Vec3(0.12, 0.6, 0), .density = 700};

/// Half the edges of the shape's bounding box.
Vec3 half_extent(const Shape& shape) {
  if (shape.kind == ShapeKind::box) return 0.5 * shape.size;
  if (shape.kind == ShapeKind::sphere) return Vec3::Constant(shape.size.x());
  return {shape.size.x(), shape.size.x(), 0.5 * shape.size.y()};
}

/// Mass properties by summing small cells of the bounding box whose centre is inside: an independent oracle.
MassProperties summed(const Shape& shape, int cells) {
  const Vec3 half = half_extent(shape);
  const Vec3 edge = 2 * half / cells;
  const double volume = edge.prod();
  MassProperties sum;
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      for (int k = 0; k < cells; ++k) {
        const Vec3 point = (Vec3(i, j, k).array() + 0.5) * edge.array() - half.array();
        if (shape.signed_distance(point) > 0) continue;
        sum.volume += volume;
        sum.mass += shape.density * volume;
        sum.inertia += shape.density * volume * (Vec3::Constant(point.squaredNorm()) - point.cwiseAbs2());
      }
    }
  }
  return sum;
}

class EveryShape : public testing::TestWithParam<Shape> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EveryShape, testing::Values(floe, ball, log_),
                         [](const auto& parameter) { return parameter.param.name; });

TEST_P(EveryShape, MassPropertiesAgreeWithSummation) {
  const MassProperties exact = GetParam().mass_properties();
  const MassProperties sum = summed(GetParam(), 120);
  EXPECT_NEAR(sum.volume / exact.volume, 1, 0.005);
  EXPECT_NEAR(sum.mass / exact.mass, 1, 0.005);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum.inertia[axis] / exact.inertia[axis], 1, 0.005) << axis;
}

TEST_P(EveryShape, AreasSumToTheSurfaceAndClose) {
  const Shape& shape = GetParam();
  for (const double spacing : {0.013, 0.02, 0.05, 0.3}) {
    double area = 0;
    Vec3 closed = Vec3::Zero();
    for (const ShapePoint& point : shape.points(spacing, 1e9)) {
      area += point.area;
      closed += point.area * point.normal;
      if (point.on_surface() && spacing < 0.05) {
        EXPECT_NEAR(point.normal.norm(), 1, 1e-12);
      }
    }
    EXPECT_NEAR(area / shape.surface_area(), 1, 1e-12) << spacing;
    EXPECT_LT(closed.norm(), 1e-12 * shape.surface_area()) << spacing;
  }
}

TEST_P(EveryShape, PointsLieInsideAtHalfASpacingAndTheirCentreIsTheOrigin) {
  const Shape& shape = GetParam();
  const double spacing = 0.02;
  const std::vector<ShapePoint> points = shape.points(spacing, 1e9);
  Vec3 centre = Vec3::Zero();
  double nearest = -1e9;
  for (const ShapePoint& point : points) {
    centre += point.position;
    const double distance = shape.signed_distance(point.position);
    nearest = std::max(nearest, distance);
    if (point.on_surface()) {
      EXPECT_NEAR(distance, -0.5 * spacing, 0.05 * spacing);
    } else {
      EXPECT_LT(distance, -spacing);
    }
  }
  EXPECT_LT(nearest, -0.45 * spacing);
  EXPECT_LT(centre.norm() / static_cast<double>(points.size()), 1e-12);
  const double represented = static_cast<double>(points.size()) * spacing * spacing * spacing;
  EXPECT_NEAR(represented / shape.mass_properties().volume, 1, 0.06);
}

TEST_P(EveryShape, NoTwoPointsAreCloserThanAThirdOfTheSpacing) {
  const std::vector<ShapePoint> points = GetParam().points(0.04, 1e9);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) ASSERT_GT((points[i].position - points[j].position).norm(), 0.04 / 3);
  }
}

TEST_P(EveryShape, DepthLeavesOutDeepPointsOnly) {
  const Shape& shape = GetParam();
  const double spacing = 0.01;
  const double depth = 2.6 * spacing;
  std::size_t expected = 0;
  for (const ShapePoint& point : shape.points(spacing, 1e9)) {
    expected += -shape.signed_distance(point.position) <= depth ? 1 : 0;
  }
  const std::vector<ShapePoint> shell = shape.points(spacing, depth);
  EXPECT_EQ(shell.size(), expected);
  EXPECT_LT(shell.size(), shape.points(spacing, 1e9).size());
  double area = 0;
  for (const ShapePoint& point : shell) area += point.area;
  EXPECT_NEAR(area / shape.surface_area(), 1, 1e-12);
}

TEST_P(EveryShape, BoundingRadiusContainsAndTouches) {
  const Shape& shape = GetParam();
  double farthest = 0;
  for (const ShapePoint& point : shape.points(0.002, 0.0)) farthest = std::max(farthest, point.position.norm());
  EXPECT_LT(farthest, shape.bounding_radius());
  EXPECT_GT(farthest, shape.bounding_radius() - 0.002);
}

TEST_P(EveryShape, CoveringSpheresTouchTheFacesFromInside) {
  const Shape& shape = GetParam();
  for (const double radius : {0.0, 0.02}) {
    const std::vector<CoveringSphere> spheres = shape.covering_spheres(0.05, radius);
    ASSERT_FALSE(spheres.empty());
    Vec3 lowest = Vec3::Constant(1e9), highest = Vec3::Constant(-1e9), centre = Vec3::Zero();
    for (const CoveringSphere& sphere : spheres) {
      EXPECT_NEAR(shape.signed_distance(sphere.centre) + sphere.radius, 0, 1e-12);
      lowest = lowest.cwiseMin(Vec3(sphere.centre.array() - sphere.radius));
      highest = highest.cwiseMax(Vec3(sphere.centre.array() + sphere.radius));
      centre += sphere.centre;
    }
    EXPECT_LT(centre.norm(), 1e-10);
    const Vec3 half = half_extent(shape);
    EXPECT_NEAR(highest.x(), half.x(), 1e-12);
    EXPECT_NEAR(highest.z(), half.z(), 1e-12);
    EXPECT_NEAR(lowest.z(), -half.z(), 1e-12);
  }
}

TEST(Box, PointCountsAndShares) {
  // 0.5 x 0.3 x 0.1 at 0.02: 25 x 15 x 5 cells.
  EXPECT_EQ(floe.points(0.02, 1e9).size(), 25u * 15u * 5u);
  EXPECT_EQ(floe.points(0.02, 0.02).size(), 25u * 15u * 5u - 23u * 13u * 3u);
  for (const ShapePoint& point : floe.points(0.02, 0.02)) {
    const Vec3 corner(0.24, 0.14, 0.04);
    if ((point.position - corner).norm() > 1e-12) continue;
    EXPECT_NEAR(point.area, 3 * 0.02 * 0.02, 1e-15);
    EXPECT_NEAR((point.normal - Vec3::Ones() / std::sqrt(3.0)).norm(), 0, 1e-12);
    return;
  }
  FAIL() << "no point in the corner";
}

TEST(Box, PlateOfOneLayerHasNoNormalInTheMiddle) {
  const Shape plate{.name = "plate", .kind = ShapeKind::box, .size = Vec3(0.1, 0.1, 0.02), .density = 917};
  int middle = 0;
  for (const ShapePoint& point : plate.points(0.02, 1e9)) {
    EXPECT_TRUE(point.on_surface());
    if (point.position.head<2>().norm() > 1e-9) continue;
    ++middle;
    EXPECT_EQ(point.normal.norm(), 0);
    EXPECT_NEAR(point.area, 2 * 0.02 * 0.02, 1e-15);
  }
  EXPECT_EQ(middle, 1);
}

TEST(Slice, PerimetersInTwoDimensions) {
  const auto perimeter = [](const Shape& shape) {
    double sum = 0;
    Vec3 closed = Vec3::Zero();
    for (const ShapePoint& point : shape.points(0.02, 0.05, 2)) {
      EXPECT_EQ(point.position.z(), 0);
      EXPECT_EQ(point.normal.z(), 0);
      sum += point.area;
      closed += point.area * point.normal;
    }
    EXPECT_LT(closed.norm(), 1e-12);
    return sum;
  };
  EXPECT_NEAR(perimeter(floe), 2 * (0.5 + 0.3), 1e-12);
  EXPECT_NEAR(perimeter(ball), 2 * pi * 0.2, 1e-12);
  EXPECT_NEAR(perimeter(log_), 2 * pi * 0.12, 1e-12);
  EXPECT_EQ(floe.points(0.02, 1e9, 2).size(), 25u * 15u);
}

TEST(CoveringSpheres, BoxIsCoveredOnItsSurfaceOnly) {
  // One layer over the thickness: 5 x 3 spheres of diameter 0.1.
  const std::vector<CoveringSphere> plate = floe.covering_spheres(0.1);
  EXPECT_EQ(plate.size(), 5u * 3u);
  EXPECT_DOUBLE_EQ(plate.front().radius, 0.05);
  const Shape cube{.name = "cube", .kind = ShapeKind::box, .size = Vec3::Constant(0.5), .density = 917};
  EXPECT_EQ(cube.covering_spheres(0.1).size(), 125u - 27u);
  EXPECT_THROW((void)floe.covering_spheres(0.1, 0.06), InputError);
  EXPECT_THROW((void)floe.covering_spheres(0.0), InputError);
}

TEST(Points, WrongSpacingOrDimensionIsAnInputError) {
  EXPECT_THROW((void)floe.points(0, 1), InputError);
  EXPECT_THROW((void)floe.points(0.1, 1, 1), InputError);
}

}  // namespace
}  // namespace embacle::coupling
