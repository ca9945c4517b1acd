// Parts of scenes with rules of their own: tables, surfaces, periodic directions.
#include <gtest/gtest.h>

#include <cstdint>
#include <tuple>

#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "scene_fixture.hpp"

namespace embacle::mps {
namespace {

TEST_F(SceneFile, MotionTablesAreReadStrictly) {
  const std::string header = "t [s], x [m], y [m], z [m]\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {"", "paddle.csv: wall.paddle.motion.table: has no rows"},
      {header, "has no rows"},
      {"0, 0, 0, 0\n",
       "paddle.csv:1: wall.paddle.motion.table: the header is '0, 0, 0, 0'; allowed: t [s], x [m], y [m], z [m]"},
      {"t [s], x [m], y [m]\n0, 0, 0\n", "paddle.csv:1: "},
      {"t [s], x [kg], y [m], z [m]\n0, 0, 0, 0\n", "column 'x [kg]': '1 kg' is a mass [kg], expected a length"},
      {header + "0, 0, 0\n", "paddle.csv:2: wall.paddle.motion.table: has 3 columns, the header 4"},
      {header + "0, 0, 0, 0\n1, 0, o, 0\n", "paddle.csv:3: wall.paddle.motion.table: column 3: 'o' is not a number"},
      {header + "0, 0, 0, nan\n", "column 4: 'nan' is not a number"},
      {header + "0, 0, 0, 0\n\n# pause\n0, 1, 0, 0\n", "paddle.csv:5: wall.paddle.motion.table: time 0 s is not after"},
  };
  for (const auto& [text, expected] : mistakes) {
    write(folder_ / "paddle.csv", text);
    EXPECT_HAS(error(full_), expected);
  }
  write(folder_ / "paddle.csv", "\xEF\xBB\xBFt,x,y,z\r\n0,1,2,3\r\n");
  EXPECT_EQ(read_scene(scene(full_)).walls[2].motion->table, (MotionTable{{0, {1, 2, 3}}}));
}

TEST_F(SceneFile, AngleTablesAreReadStrictly) {
  const std::pair<std::string, const char*> mistakes[] = {
      {"t [s], angle [m]\n0, 0\n",
       "flap.csv:1: wall.flap.motion.angle_table: column 'angle [m]': '1 m' is a length [m], "
       "expected an angle"},
      {"t, x, y\n0, 0, 0\n",
       "flap.csv:1: wall.flap.motion.angle_table: the header is 't, x, y'; allowed: t [s], angle"},
      {"t, angle\n1, 0\n1, 1\n",
       "flap.csv:3: wall.flap.motion.angle_table: time 1 s is not after that of the row before"},
  };
  for (const auto& [text, expected] : mistakes) {
    write(folder_ / "flap.csv", text);
    EXPECT_HAS(error(full_), expected);
  }
  write(folder_ / "flap.csv", "t [ms], angle [rad]\n500, 2\n");
  EXPECT_EQ(read_scene(scene(full_)).walls[7].motion->angle_table, (AngleTable{{0.5, 2}}));
}

TEST_F(SceneFile, HydrographsAreReadStrictly) {
  const std::pair<std::string, const char*> mistakes[] = {
      {"t [s], discharge [m2/s]\n0, 0\n", "expected a discharge"},
      {"t [s], discharge [l/s]\n0, 1\n1, -2\n",
       "flood.csv:3: opening.mouth.hydrograph: discharge -0.002 m3/s; allowed: >= 0"},
      {"t, discharge\n1, 0\n1, 1\n", "flood.csv:3: opening.mouth.hydrograph: time 1 s is not after"},
  };
  for (const auto& [text, expected] : mistakes) {
    write(folder_ / "flood.csv", text);
    EXPECT_HAS(error(full_), expected);
  }
}

TEST_F(SceneFile, OpeningsHaveRules) {
  const std::tuple<const char*, const char*, const char*> mistakes[] = {
      {"kind = \"drain\"", "kind = \"drain\"\nlevel = 0.1", "opening.gully.level: does not belong to a drain"},
      {"kind = \"outflow\"", "kind = \"outflow\"\nprofile = \"power\"",
       "opening.mouth.profile: does not belong to an outflow"},
      {"direction = \"+x\"\n", "", "opening.brook: the key 'direction' is required for an inflow"},
      {"direction = \"+x\"", "direction = \"+z\"", "opening.brook.direction: must be level, across gravity"},
      {"direction = \"+x\"", "direction = \"x\"", "allowed: -x, +x, -y, +y, -z, +z"},
      {"level = \"20 cm\"\nhydrograph", "hydrograph", "opening.mouth: the key 'level' is required for an outflow"},
      {"discharge = \"12 l/s\"\n", "", "opening.brook: the key 'discharge' or 'hydrograph' is required"},
      {"hydrograph = \"flood.csv\"", "hydrograph = \"flood.csv\"\ndischarge = 1",
       "opening.mouth.hydrograph: an opening has either of them, not both"},
      {"level = \"20 cm\"\nprofile", "level = 0.5\nprofile", "opening.brook.level: 0.5 m is not within the zone's"},
      {"upper = [\"5 cm\", 0.4, 0.4]", "upper = [\"2 cm\", 0.4, 0.4]",
       "in x the zone is 0.01 m long; allowed: at least the support and a particle distance, 0.0205 m"},
      {"lower = [1.6, 0.1, 0]", "lower = [1.6, 0, 0]",
       "opening.mouth.lower: behind the zone the domain must go on for at least one particle distance"},
  };
  for (const auto& [from, to, expected] : mistakes) EXPECT_HAS(error_with(from, to), expected);
}

TEST_F(SceneFile, SpongesHaveRules) {
  const std::tuple<const char*, const char*, const char*> mistakes[] = {
      {"direction = \"+x\"\ndamping_time", "damping_time", "sponge.beach.direction: required, but missing"},
      {"direction = \"+x\"\ndamping_time", "direction = \"-z\"\ndamping_time",
       "sponge.beach.direction: must be level; allowed: -x, +x, -y, +y"},
      {"damping_time = \"50 ms\"", "damping_time = \"-1 ms\"",
       "sponge.beach.damping_time: -0.001 s is out of range; allowed: >= 0 s"},
      {"upper = [1.9, 0.5, 0.4]", "upper = [1.9, 0.5, 40]", "sponge.beach.upper"},
  };
  for (const auto& [from, to, expected] : mistakes) EXPECT_HAS(error_with(from, to), expected);
}

TEST_F(SceneFile, TurnsAndCentralForcesHaveRules) {
  const std::tuple<const char*, const char*, const char*> mistakes[] = {
      {"angle_table = \"flap.csv\"", "angle_table = \"flap.csv\"\nangular_velocity = 1",
       "wall.flap.motion.angle_table: a turn has either an angle_table or an angular_velocity, not both"},
      {"angle_table = \"flap.csv\"", "angle_table = \"flap.csv\"\nstop = 1",
       "wall.flap.motion.stop: belongs to a motion by velocity"},
      {"angle_table = \"flap.csv\"\n", "velocity = [1, 0, 0]\n", "wall.flap.motion.axis: is of a turn"},
      {"angle_table = \"flap.csv\"\n", "surface_velocity = [1, 0, 0]\nangle_table = \"flap.csv\"\n",
       "wall.flap.motion.surface_velocity: belongs to a wall that stays where it is; leave out the turn"},
      {"pivot = [\"22.5 cm\", 0, 0]\n", "",
       "wall.flap.motion.angle_table: the key 'pivot' is required for a wall that"},
      {"axis = [0, 2, 0]", "axis = [0, 0, 0]", "wall.flap.motion.axis: must not be zero"},
      {"stop = \"0.7 s\"", "interpolation = \"cubic\"", "wall.gate.motion.interpolation: is of tables"},
      {"stop = \"0.7 s\"", "angular_velocity = 1\npivot = [0.5, 0, 0]",
       "wall.gate.motion.angular_velocity: in x the wall is thinner (0.01 m) than the support (0.0155 m)"},
      {"central_force = 0", "central_force = 1",
       "fluid.central_force: acts on the water only, and the scene has solids"},
      {"central_force = 0\n", "", "fluid.central_force_centre: is of a central_force, and there is none; leave it out"},
  };
  for (const auto& [from, to, expected] : mistakes) EXPECT_HAS(error_with(from, to), expected);
  const std::string flat =
      flat_ + "[[wall]]\nname='w'\nlower=[0.2,0]\nupper=[0.3,1]\n[wall.motion]\nangular_velocity=1\n";
  EXPECT_EQ(error(flat + "pivot=[0,0]"), "");
  EXPECT_HAS(error(flat + "pivot=[0,0]\naxis=[0,1]"), "wall.w.motion.axis: only for 3-D scenes; leave it out");
  EXPECT_HAS(error(flat + "pivot=[0,0]", {"domain.periodic=[\"x\"]"}),
             "wall.w.motion.angular_velocity: the domain is periodic in x, where a wall cannot turn");
}

TEST_F(SceneFile, WaterTablesAreReadStrictly) {
  const std::string header = "x [m], y [m], z [m], vx [m/s], vy [m/s], vz [m/s], p [Pa]\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {"", "start.csv: water.spray.file: has no rows"},
      {"x [m], y [m]\n",
       "start.csv:1: water.spray.file: the header is 'x [m], y [m]'; allowed: x [m], y [m], z [m], vx"},
      {"x, y, z, vx, vy\n", "start.csv:1: "},
      {"x, y, z, p, vx, vy, vz\n", "start.csv:1: "},
      {"x, y, z, p [m]\n", "start.csv:1: water.spray.file: column 'p [m]': '1 m' is a length [m], expected a pressure"},
      {header + "0, 0, 0\n", "start.csv:2: water.spray.file: has 3 columns, the header 7"},
      {"x, y, z\n0, 0, 1 mm\n", "start.csv:2: water.spray.file: column 3: '1 mm' is not a number"},
      {"x, y, z\n0, 0, 0\n0.5, 0, 0\n0, 0, 0\n", "start.csv:4: water.spray.file: is at the same place as line 2"},
      {"x, y, z\n0, 0, 0\n# far\n5, 0, 0\n", "water.spray.file: start.csv:4: [5, 0, 0] m is outside of the domain"},
  };
  for (const auto& [text, expected] : mistakes) {
    write(folder_ / "start.csv", text);
    EXPECT_HAS(error(full_), expected);
  }
  write(folder_ / "start.csv", "x [mm], y [mm], z [mm], p [kPa]\n1, 2, 3, 4\n");
  const WaterTable pressures = read_scene(scene(full_)).water[1].table;
  EXPECT_EQ(pressures.rows[0].position, (Vec3d{0.001, 0.002, 0.003}));
  EXPECT_EQ(pressures.rows[0].pressure, 4000);
  EXPECT_FALSE(pressures.has_velocity);

  const std::string spray = "file = \"start.csv\"";
  EXPECT_HAS(error_with(spray, spray + "\nlevel = 0.5"), "water.spray.level: the table has pressures");
  EXPECT_HAS(error_with(spray, spray + "\nupper = [1, 1, 1]"),
             "water.spray.upper: does not belong to water of kind table; leave it out (kinds that have it: box)");
  EXPECT_HAS(error_with(spray, spray + "\nfill_from = [1, 0, 0]"),
             "water.spray.fill_from: does not belong to water of kind table");
  EXPECT_HAS(error_with(spray, ""), "water.spray: the key 'file' is required for water of this kind (table)");
  EXPECT_HAS(error_with("kind = \"table\"\n", ""), "water.spray.file: does not belong to water of kind box");
  EXPECT_HAS(error_with("lower = [0, 0, 0]\nupper = [\"50 cm\"", "upper = [\"50 cm\""),
             "water.upstream: the key 'lower' is required for water of this kind (box)");
  write(folder_ / "start.csv", "x, y, z, vx, vy, vz\n0, 0, 0, 1, 1, 1\n");
  EXPECT_HAS(error_with(spray, spray + "\nvelocity = [1, 0, 0]"), "water.spray.velocity: the table has velocities");
}

TEST_F(SceneFile, SurfacesAreReadStrictly) {
  const std::string block = text_of(scenes / "block.stl");
  const std::tuple<const char*, const char*, const char*> mistakes[] = {
      {"solid block, in", "blocks in", "block.stl:1: wall.rock.surface: is no STL file"},
      {"vertex 0 100 0", "vertex 0 1OO 0", "block.stl:5: wall.rock.surface: '1OO' is not a number"},
      {"vertex 0 100 0", "vertex 0 100", "block.stl:5: wall.rock.surface: '' is not a number"},
      {"    vertex 0 100 0\n", "", "block.stl:7: wall.rock.surface: the triangle has fewer than three corners"},
      {"vertex 0 100 0", "vertex 0 100 0\n vertex 1 1 1", "block.stl:7: wall.rock.surface: a 'vertex' too many"},
      {"vertex 0 100 0", "vertex 0 0 0", "block.stl:2: wall.rock.surface: the triangle has two corners at the same"},
      {"vertex 0 100 0", "vertex 0 99 0", "wall.rock.surface: an edge of the triangle has no neighbour"},
      {"vertex 0 100 0\n    vertex 100 0 0", "vertex 100 0 0\n    vertex 0 100 0",
       "wall.rock.surface: an edge of the triangle belongs to another one in the same direction"},
      {"outer loop", "outre loop", "block.stl:3: wall.rock.surface: unknown word 'outre'"},
  };
  for (const auto& [from, to, expected] : mistakes) {
    write(folder_ / "block.stl", replaced(block, from, to));
    EXPECT_HAS(error(full_), expected);
  }
  write(folder_ / "block.stl", "solid nothing\nendsolid\n");
  EXPECT_HAS(error(full_), "block.stl: wall.rock.surface: has no triangles");

  // The same in binary.
  write(folder_ / "block.stl", block);
  const Scene ascii = read_scene(scene(full_));
  const auto& triangles = ascii.walls[6].form.surface->triangles;
  std::string binary(80, 'x');
  const auto append = [&](const auto& value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
  append(static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& triangle : triangles) {
    for (int c = 0; c < 3; ++c) append(0.0F);
    for (const Vec3d& corner : triangle.corner)
      for (const double x : corner) append(static_cast<float>(x * 1000));
    binary.append(2, '\0');
  }
  write(folder_ / "block.stl", binary);
  const Scene again = read_scene(scene(full_));
  ASSERT_EQ(again.walls[6].form.surface->triangles.size(), 4U);
  EXPECT_EQ(again.walls[6].region.upper, ascii.walls[6].region.upper);
  EXPECT_HAS(
      error(replaced(flat_, "[run]", "[[wall]]\nname = \"rock\"\nkind = \"stl\"\nsurface = \"block.stl\"\n[run]")),
      "wall.rock.kind: a 2-D scene has no surfaces; a prism is a polygon there");
  EXPECT_HAS(error(replaced(flat_, "[run]",
                            "[[wall]]\nname = \"pole\"\nkind = \"cylinder\"\ncentre = [0.5, 0.2]\nradius = 0.1\n"
                            "length = 1\n[run]")),
             "wall.pole.length: only for 3-D scenes; leave it out");
}

TEST_F(SceneFile, PeriodicDirectionsAreChecked) {
  const auto flat = [&](const std::string& periodic, const std::string& more = "",
                        const std::string& upper = "[1, 1]") {
    return error(replaced(replaced(flat_, "upper = [1, 1]", "upper = " + upper + "\nperiodic = " + periodic), "[run]",
                          more + "\n[run]"));
  };
  EXPECT_EQ(flat("[\"x\"]"), "");
  EXPECT_EQ(flat("[\"x\", \"y\"]"), "");
  EXPECT_HAS(flat("[\"x\", \"x\"]"), "scene.toml:6: domain.periodic: names a direction twice");
  EXPECT_HAS(flat("[\"z\"]"), "domain.periodic: a 2-D scene has no direction z; allowed: x, y");
  EXPECT_HAS(flat("[\"w\"]"), "domain.periodic: unknown value 'w'; allowed: x, y, z");
  EXPECT_HAS(flat("[\"x\"]", "", "[1.004, 1]"),
             "domain.periodic: the domain's length in x, 1.004 m, is no whole number of particle distances (0.01 m); "
             "nearest: 1 m");
  EXPECT_HAS(error(replaced(replaced(flat_, "upper = [1, 1]", "upper = [0.05, 1]\nperiodic = [\"x\"]"),
                            "upper = [1, 0.5]", "upper = [0.05, 0.5]")),
             "the domain's length in x, 0.05 m, is less than twice the support and skin; allowed: >= 0.067");
  EXPECT_HAS(error_with("periodic = []", "periodic = [\"x\"]"),
             "scene.toml:14: domain.periodic: bodies in a periodic domain are not possible yet");

  const std::string tank = "[[wall]]\nname = \"tank\"\nkind = \"tank\"\n";
  EXPECT_EQ(flat("[\"x\"]", tank + "lower = [0, 0]\nupper = [1, 1]\nopen = [\"x-\", \"x+\"]"), "");
  EXPECT_HAS(flat("[\"x\"]", tank + "lower = [0, 0]\nupper = [1, 1]\nopen = [\"x-\"]"),
             "wall.tank.open: the domain is periodic in x, so a tank must be open at x+");
  EXPECT_HAS(flat("[\"x\"]", tank + "lower = [0, 0]\nupper = [0.9, 1]\nopen = [\"x-\", \"x+\"]"),
             "wall.tank.upper: the domain is periodic in x, so a tank must reach from end to end, 0 m to 1 m");
  const std::string box = "[[wall]]\nname = \"sill\"\n";
  EXPECT_EQ(flat("[\"x\"]", box + "lower = [0.2, 0]\nupper = [0.3, 0.1]"), "");
  EXPECT_HAS(flat("[\"x\"]", box + "lower = [0.2, 0]\nupper = [0.22, 0.1]"),
             "wall.sill.upper: in x the wall is thinner than the support (0.031 m)");
  const std::string front = "[[gauge]]\nname = \"surge\"\nkind = \"front\"\n";
  EXPECT_EQ(flat("[\"x\"]", front + "direction = [0, 1]"), "");
  EXPECT_HAS(flat("[\"x\"]", front + "direction = [1, 0]"), "gauge.surge.direction: the domain is periodic in x");
  EXPECT_HAS(error(replaced(replaced(flat_, "upper = [1, 1]", "upper = [1, 1]\nperiodic = [\"x\", \"y\"]"), "[1, 0.5]",
                            "[1, 0.5]\nlevel = 0.4")),
             "water.pool.level: fluid.gravity acts only along periodic directions; leave it out");
}

}  // namespace
}  // namespace embacle::mps
