// Shapes of walls and water: distances, normals, points; water at rest beside them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/filling.hpp"
#include "core/solid.hpp"
#include "small_runs.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

using test::run;

Form cylinder(Axis axis) {
  Form form;
  form.kind = Form::Kind::cylinder;
  form.axis = axis;
  form.centre = {0.1, 0.2, 0.3};
  form.radius = 0.1;
  form.length = 0.3;
  return form;
}

Form sphere() {
  Form form;
  form.kind = Form::Kind::sphere;
  form.centre = {0.1, -0.2, 0.1};
  form.radius = 0.15;
  return form;
}

/// An L, which has a corner that points inwards.
Form prism(Axis axis) {
  Form form;
  form.kind = Form::Kind::prism;
  form.axis = axis;
  form.polygon = {{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.1, 0}, {0.1, 0.1, 0}, {0.1, 0.3, 0}, {0, 0.3, 0}};
  form.from = -0.1;
  form.to = 0.2;
  return form;
}

/// The same L along z as a surface of triangles.
Form surface() {
  const Form flat = prism(Axis::z);
  const auto& p = flat.polygon;
  const auto at = [&](std::size_t k, double z) { return Vec3d{p[k % 6][0], p[k % 6][1], z}; };
  auto result = std::make_shared<Surface>();
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) { result->triangles.push_back({{a, b, c}}); };
  for (std::size_t k = 0; k < 6; ++k) {
    add(at(k, flat.from), at(k + 1, flat.from), at(k + 1, flat.to));
    add(at(k, flat.from), at(k + 1, flat.to), at(k, flat.to));
  }
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    add(at(a, flat.to), at(b, flat.to), at(c, flat.to));
    add(at(a, flat.from), at(c, flat.from), at(b, flat.from));
  }
  Form form;
  form.kind = Form::Kind::stl;
  form.surface = result;
  return form;
}

std::vector<std::pair<Form, int>> forms() {
  return {{cylinder(Axis::x), 3}, {cylinder(Axis::y), 3}, {cylinder(Axis::z), 3}, {cylinder(Axis::z), 2},
          {sphere(), 3},          {sphere(), 2},          {prism(Axis::x), 3},    {prism(Axis::y), 3},
          {prism(Axis::z), 3},    {prism(Axis::z), 2},    {surface(), 3}};
}

/// Random places in and around a form.
std::vector<Vec3d> places(const Form& form, int dimension, int count) {
  const BoxRegion box = bounds(form, dimension);
  std::mt19937 random(7);
  std::vector<Vec3d> result;
  for (int k = 0; k < count; ++k) {
    Vec3d x{};
    for (int c = 0; c < dimension; ++c)
      x[c] = std::uniform_real_distribution<double>(box.lower[c] - 0.15, box.upper[c] + 0.15)(random);
    result.push_back(x);
  }
  return result;
}

TEST(Solid, DistancesReachTheSurfaceAlongTheNormal) {
  for (const auto& [form, dimension] : forms()) {
    const Solid solid(form, dimension);
    int inside = 0;
    for (const Vec3d& x : places(form, dimension, 2000)) {
      Vec3d normal{};
      const double distance = solid.distance(x.data(), &normal);
      inside += distance < 0 ? 1 : 0;
      EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-12);
      // The foot lies on the surface, and on either side of it the sign is as it should be.
      for (const double step : {0.0, 1e-6, -1e-6}) {
        Vec3d foot = x;
        for (int c = 0; c < 3; ++c) foot[c] += (step - distance) * normal[c];
        const double there = solid.distance(foot.data());
        if (step == 0) {
          EXPECT_NEAR(there, 0, 1e-9);
        } else {
          EXPECT_EQ(there > 0, step > 0);
        }
      }
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(Solid, NoPlaceIsNearerThanTheDistance) {
  for (const auto& [form, dimension] : forms()) {
    const Solid solid(form, dimension);
    const auto all = places(form, dimension, 120);
    for (const Vec3d& a : all) {
      for (const Vec3d& b : all) {  // a signed distance changes by no more than the way
        const double way = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        EXPECT_LE(std::abs(solid.distance(a.data()) - solid.distance(b.data())), way * (1 + 1e-9) + 1e-12);
      }
    }
  }
}

TEST(Solid, ASurfaceOfTrianglesIsTheSameAsThePrism) {
  const Solid triangles(surface(), 3), exact(prism(Axis::z), 3);
  for (const Vec3d& x : places(prism(Axis::z), 3, 5000)) {
    EXPECT_NEAR(triangles.distance(x.data()), exact.distance(x.data()), 1e-12);
  }
}

TEST(Solid, PointsLieInLayersAndAreAsManyAsTheyShould) {
  const double spacing = 0.01, depth = 0.03;
  for (const auto& [form, dimension] : forms()) {
    const Solid solid(form, dimension);
    const std::vector<Vec3d> points = solid.points(spacing, depth);
    for (const Vec3d& x : points) {
      const double below = -solid.distance(x.data());
      EXPECT_GT(below, 0.2 * spacing);
      EXPECT_LT(below, depth + 0.2 * spacing);
    }
    // The volume within the depth, from random places.
    int within = 0;
    const auto all = places(form, dimension, 200000);
    for (const Vec3d& x : all) {
      const double below = -solid.distance(x.data());
      within += below > 0 && below < depth ? 1 : 0;
    }
    const BoxRegion box = bounds(form, dimension);
    double volume = 1;
    for (int c = 0; c < dimension; ++c) volume *= box.upper[c] - box.lower[c] + 0.3;
    const double expected = volume * within / static_cast<double>(all.size()) / std::pow(spacing, dimension);
    EXPECT_NEAR(static_cast<double>(points.size()) / expected, 1, 0.06)
        << "form " << static_cast<int>(form.kind) << ", " << dimension << "-D: " << points.size();
  }
}

/// Still water in a tank, 20 particles wide, around a wall.
Scene around(const Wall& wall) {
  Scene scene = test::still_tank(2, 20);
  scene.walls.push_back(wall);
  scene.walls.back().region = bounds(wall.form, 2);
  return scene;
}

TEST(Solid, WaterStaysStillBesideWallsOfAnyForm) {
  Wall disc;
  disc.kind = Wall::Kind::cylinder;
  disc.form.kind = Form::Kind::cylinder;
  disc.form.centre = {0.1, 0.08, 0};
  disc.form.radius = 0.04;
  Wall ramp;
  ramp.kind = Wall::Kind::prism;
  ramp.form.kind = Form::Kind::prism;
  ramp.form.polygon = {{0.06, 0, 0}, {0.2, 0, 0}, {0.2, 0.1, 0}};
  for (const Wall& wall : {disc, ramp}) {
    const Scene scene = around(wall);
    Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
    run(simulation, 4400);
    const WaterState state = measure(simulation, scene);
    const double removed = 400 - static_cast<double>(state.particles);
    EXPECT_NEAR(removed, wall.kind == Wall::Kind::prism ? 70 : 50, 4);
    EXPECT_LT(state.energy.kinetic, 3e-5 * state.mass * 9.81 * 0.2);
    const Solid solid(wall.form, 2);
    double deepest = 0;
    for (std::size_t i = 0; i < simulation.particles().water; ++i)
      deepest = std::max(deepest, -solid.distance(simulation.particles().record[i].x));
    EXPECT_LT(deepest, 0.001);
    Gauge gauge;
    gauge.kind = GaugeKind::pressure;
    gauge.position = {0.04, 0.05, 0};
    EXPECT_NEAR(pressure_at(simulation, gauge), 1000 * 9.81 * 0.15, 0.02 * 1000 * 9.81 * 0.15);
  }
}

std::int64_t particles_of(const Scene& scene) {
  const Constants constants = constants_of(scene);
  const Walls walls(scene, scene.dimension, constants.layers);
  std::int64_t count = 0;
  for (int rank = 0; rank < 3; ++rank)
    count += static_cast<std::int64_t>(fill(scene, constants, walls, rank, 3).water.size());
  return count;
}

TEST(Solid, WaterFillsForms) {
  Scene scene = test::still_tank(3, 10);
  Water& water = scene.water.front();
  water.kind = Water::Kind::sphere;
  water.form.kind = Form::Kind::sphere;
  water.form.centre = {0.05, 0.05, 0.05};
  water.form.radius = 0.05;
  water.region = bounds(water.form, 3);
  EXPECT_EQ(particles_of(scene), 552) << "5 % more than its volume, of which a warning tells";
}

TEST(Solid, WaterFillsWhatIsConnected) {
  // A plate across the tank parts the water.
  Scene scene = test::still_tank(2, 20);
  Wall plate;
  plate.region = {{0.08, 0, 0}, {0.12, 0.3, 0}};
  scene.walls.push_back(plate);
  EXPECT_EQ(particles_of(scene), 16 * 20);
  scene.water.front().fill_from = {0.15, 0.1, 0};
  EXPECT_EQ(particles_of(scene), 8 * 20);
  scene.water.front().region.upper = {0.25, 0.15, 0};  // reaches beyond the tank
  EXPECT_EQ(particles_of(scene), 8 * 15);
  scene.water.front().fill_from = {0.1, 0.1, 0};
  EXPECT_THROW((void)particles_of(scene), coupling::InputError);
  scene.water.front().fill_from = {0.1, 0.2, 0};
  EXPECT_THROW((void)particles_of(scene), coupling::InputError);
}

}  // namespace
}  // namespace embacle::mps
