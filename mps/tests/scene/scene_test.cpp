// The strict scene reader: what it reads, and that every mistake gets a message that names place, key and remedy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <sstream>

#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "scene/units.hpp"
#include "scene_fixture.hpp"

namespace embacle::mps {
namespace {

TEST(Read, FullScene) {
  const Scene s = read_scene(scenes / "full.toml");
  EXPECT_EQ(s.file, scenes / "full.toml");
  EXPECT_EQ(s.title, "All keys");
  EXPECT_EQ(s.dimension, 3);
  EXPECT_EQ(s.domain.upper, (Vec3d{2, 0.5, 1}));
  EXPECT_EQ(s.fluid.density, 998);
  EXPECT_EQ(s.fluid.kinematic_viscosity, 1e-6);
  EXPECT_EQ(s.fluid.gravity, (Vec3d{0, 0, -9.81}));
  EXPECT_EQ(s.fluid.central_force_centre, (Vec3d{1, 0, 0}));
  const Numerics& n = s.numerics;
  EXPECT_EQ(n.particle_distance, 0.005);
  EXPECT_EQ(n.kernel, KernelKind::wendland);
  EXPECT_TRUE(n.adaptive_step);
  EXPECT_EQ((std::vector{n.support, n.cfl, n.sound_speed, n.reference_speed, n.artificial_viscosity,
                         n.diffusion_coefficient(), n.collision_distance, n.collision_restitution, n.skin,
                         n.rebalance_imbalance}),
            (std::vector{3.1, 0.4, 30.0, 3.0, 0.02, 0.1, 0.8, 0.4, 0.2, 1.2}));
  EXPECT_EQ(n.diffusion, Diffusion::plain);
  EXPECT_EQ(n.turbulence, TurbulenceModel::smagorinsky);
  EXPECT_EQ(n.smagorinsky, 0.2);
  EXPECT_EQ(s.coupling.loads, Loads::pressure);
  ASSERT_EQ(s.water.size(), 5U);
  EXPECT_EQ(s.water[0].name, "upstream");
  EXPECT_EQ(s.water[0].region.upper, (Vec3d{0.5, 0.5, 0.25}));
  EXPECT_EQ(s.water[0].velocity, (Vec3d{0.1, 0, 0}));
  EXPECT_EQ(s.water[0].level, 0.25 + 0.02);
  EXPECT_EQ(s.water[0].line, 42);
  EXPECT_EQ(s.water[0].kind, Water::Kind::box);
  EXPECT_EQ(s.water[1].kind, Water::Kind::table);
  const WaterTable& table = s.water[1].table;
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_TRUE(table.has_velocity);
  EXPECT_TRUE(table.has_pressure);
  EXPECT_EQ(table.rows[1].position, (Vec3d{0.705, 0.1, 0.02}));
  EXPECT_EQ(table.rows[1].velocity, (Vec3d{0.1, -0.2, 0.3}));
  EXPECT_EQ(table.rows[1].pressure, 50);
  EXPECT_EQ(table.rows[1].line, 3);
  EXPECT_NEAR(s.water[1].region.lower[0], 0.7 - 0.0025, 1e-15);
  EXPECT_NEAR(s.water[1].region.upper[0], 0.705 + 0.0025, 1e-15);
  ASSERT_EQ(s.walls.size(), 8U);
  const Form& pillar = s.walls[4].form;
  EXPECT_EQ(s.walls[4].kind, Wall::Kind::cylinder);
  EXPECT_EQ(pillar.kind, Form::Kind::cylinder);
  EXPECT_EQ(pillar.centre, (Vec3d{1.2, 0.25, 0.2}));
  EXPECT_EQ(pillar.radius, 0.05);
  EXPECT_NEAR(s.walls[4].region.lower[2], 0, 1e-15);
  EXPECT_NEAR(s.walls[4].region.upper[0], 1.25, 1e-15);
  EXPECT_EQ(s.walls[5].form.polygon, (Polygon{{1, 0, 0}, {1.5, 0, 0}, {1.5, 0.1, 0}}));
  EXPECT_EQ(s.walls[5].form.axis, Axis::y);
  EXPECT_EQ(s.walls[5].region.lower, (Vec3d{1, 0.1, 0}));
  EXPECT_EQ(s.walls[5].region.upper, (Vec3d{1.5, 0.4, 0.1}));
  ASSERT_TRUE(s.walls[6].form.surface);
  EXPECT_EQ(s.walls[6].form.surface->triangles.size(), 4U);
  EXPECT_NEAR(s.walls[6].region.upper[1], 0.1, 1e-15);
  EXPECT_NEAR(s.water[4].region.upper[1], 0.2, 1e-15);
  EXPECT_EQ(s.water[4].fill_from, (Vec3d{0.01, 0.02, 0.02}));
  EXPECT_FALSE(s.water[0].fill_from);
  EXPECT_EQ(s.walls[0].kind, Wall::Kind::tank);
  EXPECT_EQ(s.walls[0].open, std::vector<std::string>{"z+"});
  EXPECT_FALSE(s.walls[0].motion);
  EXPECT_EQ(s.walls[0].slip, false);
  EXPECT_FALSE(s.walls[1].slip.has_value());
  EXPECT_EQ(s.walls[3].motion.value().surface_velocity, (Vec3d{0.1, 0, 0}));
  EXPECT_FALSE(s.walls[3].motion->moves());
  EXPECT_EQ(s.walls[1].kind, Wall::Kind::box);
  EXPECT_EQ(s.walls[1].motion.value().velocity, (Vec3d{0, 0, 0.4}));
  EXPECT_EQ(s.walls[1].motion->start, 0.1);
  EXPECT_EQ(s.walls[1].motion->stop, 0.7);
  EXPECT_EQ(s.walls[2].motion.value().table, (MotionTable{{0, {0, 0, 0}}, {0.5, {-0.02, 0, 0}}, {1, {0, 0, 0}}}));
  EXPECT_NEAR(s.walls[4].motion.value().angular_velocity, std::acos(-1) / 6, 1e-15);
  EXPECT_EQ(s.walls[4].motion->pivot, (Vec3d{1.2, 0.25, 0}));
  EXPECT_EQ(s.walls[4].motion->interpolation, Interpolation::linear);
  const Motion& flap = s.walls[7].motion.value();
  ASSERT_EQ(flap.angle_table.size(), 3U);
  EXPECT_NEAR(flap.angle_table[1].second, std::acos(-1) / 20, 1e-15);
  EXPECT_EQ(flap.axis, (Vec3d{0, 1, 0})) << "a unit vector";
  EXPECT_EQ(flap.interpolation, Interpolation::cubic);
  EXPECT_TRUE(flap.moves());
  ASSERT_EQ(s.openings.size(), 3U);
  const Opening &brook = s.openings[0], &mouth = s.openings[1];
  EXPECT_EQ(brook.kind, Opening::Kind::inflow);
  EXPECT_EQ(brook.direction, Direction::x_plus);
  EXPECT_EQ(brook.discharge, 0.012);
  EXPECT_EQ(brook.level, 0.2);
  EXPECT_EQ(brook.profile, Profile::power);
  EXPECT_EQ(brook.discharge_at(5), 0.012);
  EXPECT_EQ(axis_of(mouth.direction), 1);
  EXPECT_EQ(sign_of(mouth.direction), -1);
  EXPECT_EQ(mouth.discharge_at(-1), 0.01);
  EXPECT_DOUBLE_EQ(mouth.discharge_at(0.5), 0.015);
  EXPECT_EQ(mouth.discharge_at(3), 0.03);
  EXPECT_EQ(s.openings[2].kind, Opening::Kind::drain);
  ASSERT_EQ(s.sponges.size(), 1U);
  EXPECT_EQ(s.sponges[0].direction, Direction::x_plus);
  EXPECT_EQ(s.sponges[0].damping_time, 0.05);
  EXPECT_EQ(s.sponges[0].velocity, (Vec3d{0.02, 0, 0}));
  ASSERT_EQ(s.gauges.size(), 2U);
  EXPECT_EQ(s.gauges[0].kind, GaugeKind::level);
  EXPECT_EQ(s.gauges[0].position, (Vec3d{0.25 + 0.05, 0.25, 0}));
  EXPECT_EQ(s.gauges[1].kind, GaugeKind::front);
  EXPECT_EQ(s.gauges[1].direction, (Vec3d{0.6, 0.8, 0})) << "a unit vector";
  EXPECT_TRUE(s.coupled());
  EXPECT_EQ(s.coupling.script, scenes / "in.blocks");
  EXPECT_EQ(s.coupling.steps_per_window, 2);
  EXPECT_EQ(s.coupling.scheme, Scheme::parallel);
  EXPECT_FALSE(s.coupling.predictor);
  EXPECT_EQ(s.coupling.variables,
            (std::map<std::string, std::string>{
                {"blocks", "4"}, {"width", "0.02"}, {"half", "0.125"}, {"ice", "floes.txt"}, {"many", "100000"}}));
  EXPECT_EQ(s.output.fields_every, 0.1);
  EXPECT_EQ(s.output.bodies_every, 0.01);
  EXPECT_EQ(s.output.gauges_every, 0.005);
  EXPECT_EQ(s.output.energies_every, 0.02);
  EXPECT_FALSE(s.output.fields);
  EXPECT_TRUE(s.output.audit);
  EXPECT_EQ(s.output.pictures, (std::vector{0.0, 0.5, 1.0}));
  EXPECT_EQ(s.end_time, 2);
  EXPECT_EQ(s.parameters, (std::map<std::string, double>{{"depth", 0.25}, {"freeboard", 0.25 + 0.05}, {"blocks", 4}}));
}

TEST(Read, FlatSceneAndDefaults) {
  const Scene s = read_scene(scenes / "flat.toml");
  EXPECT_EQ(s.dimension, 2);
  EXPECT_EQ(s.fluid.gravity, (Vec3d{0, -9.81, 0}));
  EXPECT_EQ(s.domain.upper, (Vec3d{1, 1, 0}));
  EXPECT_EQ(s.thickness, 1);
  EXPECT_FALSE(s.coupled());
  EXPECT_FALSE(s.water[0].level);
  EXPECT_EQ(s.numerics.cfl, Numerics{}.cfl);
  EXPECT_EQ(read_scene(scenes / "flat.toml", {"domain.thickness=5 cm"}).thickness, 0.05);
}

TEST(Read, OverridesReplaceValuesBeforeTheyAreChecked) {
  const auto with = [](const std::vector<std::string>& overrides) {
    return read_scene(scenes / "full.toml", overrides);
  };
  EXPECT_EQ(with({"parameters.depth=2.5cm"}).water[0].region.upper[2], 0.025);
  EXPECT_EQ(with({"parameters.depth=0.03"}).parameters.at("depth"), 0.03);
  EXPECT_EQ(with({"parameters.kernel_name=rational"}).numerics.kernel, KernelKind::rational);
  EXPECT_EQ(with({"water.upstream.level=30 cm"}).water[0].level, 0.3);
  EXPECT_EQ(with({"water.upstream.upper=[\"10 cm\", 0.2, \"$depth\"]"}).water[0].region.upper, (Vec3d{0.1, 0.2, 0.25}));
  EXPECT_EQ(with({"numerics.particle_distance=\"4 mm\""}).numerics.particle_distance, 0.004);
  EXPECT_EQ(with({"numerics.particle_distance = 3 mm"}).numerics.particle_distance, 0.003);
  EXPECT_EQ(with({"coupling.variables.blocks=9", "coupling.variables.fresh=a.txt"}).coupling.variables.at("blocks"),
            "9");
  EXPECT_EQ(with({"coupling.variables.fresh=a.txt"}).coupling.variables.at("fresh"), "a.txt");
  EXPECT_EQ(with({"output.audit=false"}).output.audit, false);
  EXPECT_EQ(with({"wall.gate.motion.stop=1 s"}).walls[1].motion->stop, 1);
  EXPECT_EQ(with({"run.end_time=0.2", "run.end_time=0.3"}).end_time, 0.3) << "the last one counts";
  EXPECT_EQ(with({"numerics.kernel=rational"}).numerics.kernel, KernelKind::rational)
      << "a parameter that only the replaced value used is no error";
  EXPECT_EQ(read_scene(scenes / "flat.toml", {"fluid.density=868 kg/m3"}).fluid.density, 868)
      << "also in a new section";
}

TEST(Read, FolderMeansItsSceneFile) {
  EXPECT_HAS(message_of(here), "the folder has no scene.toml");
  EXPECT_HAS(message_of(scenes / "ful.toml"), "no such scene file or folder; did you mean 'full.toml'?");
  EXPECT_HAS(message_of("/dev/null"), "neither a file nor a folder");
}

TEST_F(SceneFile, IsFoundInItsFolder) {
  (void)scene(flat_);
  EXPECT_EQ(read_scene(folder_).file, folder_ / "scene.toml");
}

TEST_F(SceneFile, MessagesHaveOneForm) {
  EXPECT_EQ(error_with("density =", "densty ="),
            "scene.toml:16: fluid.densty: unknown key; did you mean 'density'? allowed: central_force, "
            "central_force_centre, density, gravity, "
            "kinematic_viscosity");
  EXPECT_EQ(error(full_, {"fluid.densty=5"}),
            "--set fluid.densty=5: fluid.densty: unknown key; did you mean 'density'? allowed: central_force, "
            "central_force_centre, density, gravity, "
            "kinematic_viscosity");
  EXPECT_EQ(error_with("\"0.998 g/cm3\"", "-3"),
            "scene.toml:16: fluid.density: -3 kg/m3 is out of range; allowed: > 0 kg/m3");
  EXPECT_EQ(error_with("\"0.998 g/cm3\"", "\"3 mm\""),
            "scene.toml:16: fluid.density: '3 mm' is a length [m], expected a density; allowed: a number in kg/m3 or "
            "text such "
            "as \"868 kg/m3\" (units kg/m3, g/cm3, t/m3)");
  EXPECT_EQ(error_with("scheme = \"parallel\"", "scheme = \"serail\""),
            "scene.toml:81: coupling.scheme: unknown value 'serail'; did you mean 'serial'? allowed: serial, parallel");
}

TEST_F(SceneFile, BadTomlSaysLineAndColumn) {
  EXPECT_HAS(error_with("density = \"0.998 g/cm3\"", "density = 868 kg/m3"), "scene.toml:16:15: not valid TOML");
  EXPECT_HAS(error_with("density = \"0.998 g/cm3\"", "density = 868 kg/m3"), "need quotes");
  EXPECT_HAS(error_with("[fluid]", "[fluid"), "scene.toml:15:7: not valid TOML");
  EXPECT_HAS(error_with("density =", "gravity ="), "not valid TOML");
}

struct Mistake {
  const char* from;
  const char* to;
  const char* expected;
};

TEST_F(SceneFile, EachMistakeIsNamed) {
  const Mistake mistakes[] = {
      // sections
      {"[fluid]", "[flud]", "scene.toml:15: flud: unknown section; did you mean 'fluid'?"},
      {"[fluid]", "[[fluid]]", "scene.toml:15: fluid: may stand only once: write [fluid], not [[fluid]]"},
      {"title =", "run_title =", "scene.toml:2: run_title: unknown key; did you mean 'title'?"},
      {"[output]", "[output]\ncfl = 1",
       "scene.toml:91: output.cfl: unknown key; it belongs to [numerics]; allowed: audit"},
      {"end_time = \"2 s\"", "", "scene.toml:101: run.end_time: required, but missing; allowed: a time"},
      {"[run]\nend_time = \"2 s\"", "", "scene.toml: run.end_time: required, but missing"},
      {"script = \"in.blocks\"", "", "coupling.script: required, but missing"},
      // values
      {"dimension = 3", "dimension = 4", "scene.toml:3: dimension: 4 is out of range; allowed: 2 to 3"},
      {"upper = [\"2 m\", \"50 cm\", 1.0]", "upper = [1, 2]", "domain.upper: has 2 components, the scene 3 dimensions"},
      {"upper = [\"2 m\", \"50 cm\", 1.0]", "upper = 1",
       "domain.upper: found number 1; allowed: a list of 3 components"},
      {"support = 3.1", "support = inf", "numerics.support: must be a finite number, found inf"},
      {"support = 3.1", "support = \"3.1\"", "numerics.support: '3.1' has no unit: write the number without quotes"},
      {"support = 3.1", "support = 1.6", "numerics.support: 1.6 does not suit the wendland kernel; allowed: 2 to 5"},
      {"particle_distance = \"5 mm\"", "particle_distance = 3",
       "numerics.particle_distance: 3 m is more than the domain's extent"},
      {"\"5 mm\"", "\"5 MM\"",
       "numerics.particle_distance: unknown unit 'MM'; did you mean 'mm'? allowed: a number in m"},
      {"\"5 mm\"", "\"2,5 mm\"", "the decimal sign is a point"},
      {"\"5 mm\"", "\"five\"", "numerics.particle_distance: cannot read 'five'"},
      {"\"5 mm\"", "\"1e999 m\"", "is out of the range of numbers"},
      {"\"5 mm\"", "\"1 mm + 2 s\"", "adds or subtracts a length [m] and a time [s]"},
      {"\"5 mm\"", "\"1 mm * 2 mm\"", "only multiplication by a plain number is possible"},
      {"steps_per_window = 2", "steps_per_window = 2.5", "found number 2.5; allowed: a whole number, 1 to 10000"},
      {"predictor = false", "predictor = 0", "coupling.predictor: found number 0; allowed: true or false"},
      {"\"in.blocks\"", "\"in.block\"", "scene.toml:79: coupling.script: there is no file 'in.block'"},
      {"width = \"2 cm\"", "width = true", "coupling.variables.width: found true; allowed: a number, a quantity, text"},
      {"width = \"2 cm\"", "width = \"2 cmm\"", "coupling.variables.width: unknown unit 'cmm'; did you mean 'cm'?"},
      {"width = \"2 cm\"", "a-b = 1", "coupling.variables.a-b: a variable's name has letters, digits and _"},
      // parameters
      {"\"$depth\"]", "\"$dept\"]",
       "water.upstream.upper: undefined parameter '$dept'; did you mean 'depth'? parameters: blocks"},
      {"\"$blocks\"", "4", "scene.toml:8: parameters.blocks: is not used; write \"$blocks\""},
      {"\"25 cm\"", "\"$freeboard - 5 cm\"", "'$depth' refers to itself"},
      {"\"25 cm\"", "true", "scene.toml:6: parameters.depth: expected a number, a quantity or text, found true"},
      {"\"5 mm\"", "\"$kernel_name\"", "'$kernel_name' is the text 'wendland', not a number"},
      {"\"$kernel_name\"", "\"$depth\"", "numerics.kernel: '$depth' is a number; allowed: wendland, rational"},
      // rules between keys
      {"dimension = 3", "dimension = 3\ndomain.thickness = 1", "not valid TOML"},
      {"lower = [0, 0, 0]\nupper = [\"2 m\"", "thickness = 1\nlower = [0, 0, 0]\nupper = [\"2 m\"",
       "domain.thickness: only for 2-D"},
      {"upper = [\"50 cm\", \"50 cm\"", "upper = [\"-50 cm\", \"50 cm\"",
       "water.upstream.upper: in x upper (-0.5 m) must be at least lower (0 m)"},
      {"upper = [0.51,", "upper = [0.5,", "wall.gate.upper: in x upper (0.5 m) must be greater than lower (0.5 m)"},
      {"upper = [\"50 cm\", \"50 cm\"", "upper = [\"50 cm\", \"51 cm\"",
       "water.upstream.upper: [0.5, 0.51, 0.25] m is outside of the domain, [0, 0, 0] to [2, 0.5, 1] m"},
      {"upper = [1.95,", "upper = [2.95,", "wall.paddle.upper: [2.95, 0.5, 0.4] m is outside of the domain"},
      {"[\"$freeboard\"", "[3", "gauge.middle.position: [3, 0.25, 0] m is outside of the domain"},
      {"position = [\"$freeboard\", \"25 cm\", 0]", "direction = [1, 0, 0]",
       "gauge.middle: the key 'position' is required"},
      {"direction = [3, 4, 0]", "direction = [0, 0, 0]", "gauge.surge.direction: must not be zero"},
      {"direction = [3, 4, 0]", "position = [0, 0, 0]", "gauge.surge.position: a front has a direction, no position"},
      {"gravity = [0, 0, \"-9.81 m/s2\"]", "gravity = [0, 0, 0]", "water.upstream.level: a level needs gravity"},
      {"name = \"paddle\"", "name = \"gate\"", "wall[3].name: 'gate' is taken by the [[wall]] at "},
      {"name = \"paddle\"", "name = 3", "wall[3].name: found number 3; allowed: a name in quotes"},
      {"name = \"paddle\"", "name = \"a/b\"", "'a/b' cannot be a name"},
      {"open = [\"z+\"]", "open = [\"z\"]", "wall.tank.open: unknown value 'z'; did you mean 'z-'? allowed: x-, x+"},
      {"open = [\"z+\"]", "open = [\"z+\", \"z+\"]", "wall.tank.open: names a side twice"},
      {"open = [\"z+\"]", "open = [\"x-\", \"x+\", \"y-\", \"y+\", \"z-\", \"z+\"]", "all sides are open"},
      {"kind = \"tank\"", "kind = \"box\"", "wall.tank.open: only a tank has open sides"},
      {"lower = [1.9, 0, 0]\n", "", "wall.paddle: the key 'lower' is required for a wall of this kind (box)"},
      {"length = 0.4\n", "", "wall.pillar: the key 'length' is required for a wall of this kind (cylinder)"},
      {"length = 0.4", "length = 0.4\nfrom = 1",
       "wall.pillar.from: does not belong to a wall of kind cylinder; leave it out (kinds that have it: prism)"},
      {"centre = [1.2,", "centre = [2.2,", "wall.pillar: from [2.15, 0.2, 0] to [2.25, 0.3, 0.4] m it reaches out of"},
      {"[1.5, 0], [1.5, \"10 cm\"]]", "[1.5, 0]]", "wall.ramp.polygon: has 2 corners; allowed: at least 3"},
      {"[1.5, 0], [1.5, \"10 cm\"]]", "[1.5, 0], [1.5, 0]]", "wall.ramp.polygon: corners 2 and 3 are the same"},
      {"[1.5, 0], [1.5, \"10 cm\"]]", "[1.5, 0], [1.2, 0]]", "wall.ramp.polygon: its corners are on one line"},
      {"[1.5, 0], [1.5, \"10 cm\"]]", "[1.5, 0.1], [1.5, 0], [1, 0.1]]",
       "wall.ramp.polygon: the edges from corners 1 and 3 on cross"},
      {"[1.5, 0], [1.5, \"10 cm\"]]", "[1.5, 0, 1], [1.5, 0.1]]",
       "wall.ramp.polygon: found a list; allowed: a list of points"},
      {"from = 0.1\nto = 0.4\n\n[[wall]]", "from = 0.4\nto = 0.4\n\n[[wall]]",
       "wall.ramp.to: 0.4 m must be greater than from (0.4 m)"},
      {"scale = 0.002", "scale = 0.02", "water.bag: from [0, 0, 0] to [2, 2, 2] m it reaches out of the domain"},
      {"fill_from = [\"1 cm\", 0.02, 0.02]", "fill_from = [9, 0, 0]",
       "water.bag.fill_from: [9, 0, 0] m is outside of the domain"},
      {"stop = \"0.7 s\"", "stop = \"0.1 s\"", "wall.gate.motion.stop: 0.1 s must be after start (0.1 s)"},
      {"stop = \"0.7 s\"", "table = \"paddle.csv\"",
       "wall.gate.motion.table: a motion has either a table or a velocity, of the wall or of its surface, not both"},
      {"stop = \"0.7 s\"", "surface_velocity = [0, 0, 1]",
       "wall.gate.motion.surface_velocity: a motion has either a table or a velocity, of the wall or of its surface"},
      {"table = \"paddle.csv\"", "",
       "wall.paddle.motion: needs a velocity, a surface_velocity or a table, or an angular_velocity"},
      {"slip = false", "slip = 1", "wall.tank.slip: found number 1; allowed: true or false"},
      {"kinematic_viscosity = \"1e-6 m2/s\"", "",
       "wall.tank.slip: needs a viscosity, and fluid.kinematic_viscosity is zero"},
      {"kinematic_viscosity = \"1e-6 m2/s\"", "",
       "wall.belt.motion.surface_velocity: needs a viscosity, and fluid.kinematic_viscosity is zero"},
      {"name = \"belt\"", "name = \"belt\"\nslip = true",
       "wall.belt.slip: a wall with a velocity of its surface drags the water: leave out one"},
      {"table = \"paddle.csv\"", "table = \"paddle.csv\"\nstart = 1",
       "wall.paddle.motion.start: belongs to a motion by velocity"},
      {"wall_pressure = \"extrapolated\"", "wall_pressure = \"continuity\"",
       "numerics.wall_pressure: continuity is for walls only, and the scene has solids (coupling.script)"},
      {"integrator = \"leapfrog\"", "integrator = \"symplectic\"",
       "opening.brook: does not go with symplectic; allowed: leapfrog"},
      {"regularisation = \"none\"", "regularisation = \"shifting\"",
       "opening.brook: does not go with shifting; allowed: collision, none"},
      {"integrator = \"leapfrog\"", "integrator = \"symplectic\"",
       "numerics.integrator: symplectic is for scenes without solids (coupling.script)"},
      {"turbulence = \"smagorinsky\"", "turbulence = \"none\"",
       "numerics.smagorinsky: belongs to turbulence = \"smagorinsky\""},
      {"pictures = [1,", "pictures = [3,", "output.pictures: 3 s is after the end of the run (run.end_time = 2 s)"},
  };
  ASSERT_EQ(error(full_), "");
  for (const Mistake& mistake : mistakes) EXPECT_HAS(error_with(mistake.from, mistake.to), mistake.expected);
  EXPECT_HAS(error(replaced(flat_, "[[water]]", "[water]")),
             "scene.toml:8: water: found a section; allowed: any number of sections, each begun by [[water]]");
  EXPECT_HAS(error(flat_ + "[[wall]]\nname='t'\nkind='tank'\nlower=[0,0]\nupper=[1,1]\nopen=['z+']"),
             "a 2-D tank has no sides in z");
}

TEST_F(SceneFile, OverridesAreBlamedForTheirMistakes) {
  EXPECT_HAS(error(full_, {"numerics.integrator=symplectic", "numerics.regularisation=shifting"}),
             "numerics.integrator: symplectic does not go with shifting");
  const std::pair<const char*, const char*> mistakes[] = {
      {"title", "--set title: expected key.path=value"},
      {"a..b=1", "expected key.path=value"},
      {"fluid.gravity=[0, 0, 9.81 m/s2]", "quantities in lists need quotes"},
      {"water.upstrem.level=3", "water.upstrem: no [[water]] has this name; did you mean 'upstream'? names: upstream"},
      {"water.upstream=3", "water.upstream: a key must follow the name"},
      {"water.upstream.name=pool", "water.upstream.name: a name is what --set goes by"},
      {"title.x=3", "title.x: 'title' is no section"},
      {"parameters.dept=3", "parameters.dept: the scene has no such parameter; did you mean 'depth'?"},
      {"fluid=3", "--set fluid=3: fluid: found number 3; allowed: a section, [fluid]"},
      {"flud.density=3", "--set flud.density=3: flud: unknown section; did you mean 'fluid'?"},
      {"parameters.depth=3 kg", "--set parameters.depth=3 kg (scene.toml:7): parameters.freeboard: "},
      {"parameters.depth=5",
       "--set parameters.depth=5 (scene.toml:45): water.upstream.upper: [0.5, 0.5, 5] m is outside"},
      {"domain.upper=[0.1,0.1,0.1]", "--set domain.upper=[0.1,0.1,0.1]: water.upstream.upper: "},
  };
  for (const auto& [text, expected] : mistakes) EXPECT_HAS(error(full_, {text}), expected);
  EXPECT_EQ(error(full_, {"run.end_time=0.1"}), "") << "cutting a run short leaves later pictures out";
}

TEST_F(SceneFile, AllProblemsComeTogetherInTheOrderOfTheFile) {
  std::string text = replaced(full_, "title = \"All keys\"", "title = 3");
  text = replaced(text, "cfl = 0.4", "cfl = 9");
  text = replaced(text, "[run]", "[run]\nspeed = 1");
  const std::string message = error(text, {"fluid.density=-1"});
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 3) << message;
  EXPECT_LT(message.find("--set fluid.density"), message.find("scene.toml:2: title"));
  EXPECT_LT(message.find("scene.toml:2: title"), message.find("scene.toml:25: numerics.cfl"));
  EXPECT_LT(message.find("scene.toml:25: numerics.cfl"), message.find("run.speed"));

  for (int i = 0; i < 13; ++i) text += "\nnonsense" + std::to_string(i) + " = 1";
  const std::string many = error(text);
  EXPECT_EQ(std::count(many.begin(), many.end(), '\n'), 10) << "ten problems and the rest counted";
  EXPECT_HAS(many, "\n... and 6 more");
}

// The schema as a whole.

/// Calls f(path of a key in full.toml, key, target) for every key of the schema.
template <class F>
void for_each_key(F&& f) {
  schema().for_each([&]<class T>(const Section<T>& section) {
    static const std::map<std::string, std::string> instances{
        {"water", "water.upstream"},  {"wall", "wall.tank"},      {"wall.motion", "wall.gate.motion"},
        {"opening", "opening.brook"}, {"sponge", "sponge.beach"}, {"gauge", "gauge.surge"}};
    const auto found = instances.find(section.path);
    const std::string at = found == instances.end() ? section.path : found->second;
    for (const Field<T>& field : section.fields) {
      T fresh{};
      f(at.empty() ? field.key.name : at + "." + field.key.name, field.key, field.target(fresh));
    }
  });
}

bool is_number(const Target& target) {
  return std::holds_alternative<double*>(target) || std::holds_alternative<std::optional<double>*>(target) ||
         std::holds_alternative<int*>(target);
}
bool is_numbers(const Target& target) {
  return std::holds_alternative<Vec3d*>(target) || std::holds_alternative<std::vector<double>*>(target);
}
std::string in_list(const std::string& value, const Target& target) {
  if (is_number(target)) return value;
  return std::holds_alternative<Vec3d*>(target) ? "[" + value + ", 0, 0]" : "[" + value + "]";
}

TEST(Schema, AWrongUnitIsAnErrorForEveryKeyThatTakesNumbers) {
  int keys = 0;
  for_each_key([&](const std::string& path, const Key& key, const Target& target) {
    if (!is_number(target) && !is_numbers(target)) return;
    ++keys;
    const std::string message = message_of(scenes / "full.toml", {path + "=" + in_list("\"1 kg\"", target)});
    EXPECT_HAS(message, ": " + path + ": '1 kg' is a mass [kg], expected " + a_quantity(key.quantity) +
                            "; allowed: " + how_to_write(key.quantity));
  });
  EXPECT_GT(keys, 30);
}

TEST(Schema, AWrongTypeIsAnErrorForEveryKey) {
  for_each_key([&](const std::string& path, const Key& key, const Target& target) {
    if (key.label) return;  // not settable; in the file: see EachMistakeIsNamed
    const bool truth = std::holds_alternative<bool*>(target) || std::holds_alternative<std::optional<bool>*>(target);
    const std::string wrong = truth ? "1" : "true";
    const std::string message = message_of(scenes / "full.toml", {path + "=" + wrong});
    EXPECT_HAS(message, ": " + path + ": found ");
    EXPECT_HAS(message, "allowed: " + expectation(key, target, 3));
  });
}

TEST(Schema, ValuesBeyondTheRangeAreErrorsAndItsEndsAreNot) {
  int ends = 0;
  for_each_key([&](const std::string& path, const Key& key, const Target& target) {
    if (!is_number(target) && !is_numbers(target)) return;
    const auto reads = [&](double value) {
      const std::string message = message_of(scenes / "full.toml", {path + "=" + in_list(number_text(value), target)});
      return !has(message, "is out of range; allowed: " + key.range.text());
    };
    if (std::isfinite(key.range.lower)) {
      ++ends;
      EXPECT_EQ(reads(key.range.lower), !key.range.lower_open) << path;
      EXPECT_FALSE(reads(key.range.lower - 1)) << path;
    }
    if (std::isfinite(key.range.upper)) {
      ++ends;
      EXPECT_TRUE(reads(key.range.upper)) << path;
      EXPECT_FALSE(reads(key.range.upper + 1)) << path;
    }
  });
  EXPECT_GT(ends, 25);
}

TEST_F(SceneFile, EveryKeyMisspeltByOneLetterGetsItsRightName) {
  std::vector<std::string> lines;
  std::istringstream stream(full_);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  std::set<std::string> seen;
  std::string section;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string line = lines[i];
    if (line.starts_with("[")) section = line;
    const std::string key = line.substr(0, line.find(" = "));
    if (key == line || line.starts_with("#") || section == "[parameters]" || section == "[coupling.variables]")
      continue;
    seen.insert(section + key);
    std::set<std::string> misspelt;
    for (std::size_t at = 0; at < key.size(); ++at) {
      std::string word = key;
      misspelt.insert(word.replace(at, 1, "z"));
      misspelt.insert((word = key).erase(at, 1));
      misspelt.insert((word = key).insert(at, "z"));
      if (at > 0 && key[at] != key[at - 1]) {
        word = key;
        std::swap(word[at], word[at - 1]);
        misspelt.insert(word);
      }
    }
    for (const std::string& word : misspelt) {
      lines[i] = word + line.substr(key.size());
      std::string text;
      for (const std::string& each : lines) text += each + "\n";
      const std::string message = error(text);
      EXPECT_HAS(message, "scene.toml:" + std::to_string(i + 1) + ": ");
      EXPECT_HAS(message, word + ": unknown key; did you mean '" + key + "'? allowed: ");
    }
    lines[i] = line;
  }
  schema().for_each([&]<class T>(const Section<T>& each) {
    const std::string heading =
        each.path.empty() ? "" : (each.repeated ? "[[" + each.path + "]]" : "[" + each.path + "]");
    for (const Field<T>& field : each.fields)
      EXPECT_TRUE(seen.contains(heading + field.key.name) || field.key.name == "thickness")  // of 2-D scenes only
          << "full.toml lacks " << heading << " " << field.key.name;
  });
}

TEST(Schema, ReferencePageIsUpToDateAndHasEveryKey) {
  const std::string page = scene_reference();
  EXPECT_EQ(text_of(here / "../../../docs/scene-reference.md"), page)
      << "write it anew: mps --reference > docs/scene-reference.md";
  for_each_key([&](const std::string&, const Key& key, const Target&) {
    EXPECT_HAS(page, "| `" + key.name + "` | ");
    EXPECT_FALSE(key.meaning.empty()) << key.name;
  });
}

// Garbage: whatever comes, either a scene or an InputError.

TEST_F(SceneFile, RandomBytesNeverCrash) {
  std::mt19937 random(1);
  const auto byte = [&] { return static_cast<char>(random() % 256); };
  for (int i = 0; i < 200; ++i) {
    std::string text(random() % 200, ' ');
    for (char& c : text) c = byte();
    (void)error(text);
  }
  for (int i = 0; i < 500; ++i) {
    std::string text = full_;
    for (unsigned k = 0; k <= random() % 4; ++k) {
      const std::size_t at = random() % text.size();
      std::string line = text.substr(at, 20);
      line.insert(line.begin(), '\n');
      line.push_back('\n');
      switch (random() % 5) {
        case 0:
          text[at] = byte();
          break;
        case 1:
          text.erase(at, random() % 30);
          break;
        case 2:
          text.insert(at, 1, "[]{}\"'=.,#$\n0-e"[random() % 15]);
          break;
        case 3:
          text.insert(random() % text.size(), line);
          break;
        default:
          text.resize(at + 1);
      }
    }
    (void)error(text);
  }
}

TEST(Garbage, RandomOverridesNeverCrash) {
  std::mt19937 random(2);
  const std::vector<std::string> pieces{"water",   "upstream", "level", ".",      "=",        "[",         "]",
                                        "{",       "}",        "\"",    "$depth", "3",        " mm",       "fluid",
                                        "density", "wall",     "gate",  "motion", "coupling", "variables", "parameters",
                                        "depth",   "-",        "name",  ",",      "\n",       "run",       "*",
                                        "+",       "true",     "x"};
  for (int i = 0; i < 800; ++i) {
    std::string text;
    for (unsigned k = 0; k < 2 + random() % 9; ++k) text += pieces[random() % pieces.size()];
    (void)message_of(scenes / "full.toml", {text});
  }
}

TEST(Garbage, RandomExpressionsNeverCrash) {
  std::mt19937 random(3);
  const std::vector<std::string> pieces{"$a", "$", "1", "2.5",  "e9", "e-400", " ", "mm", "m/s2",
                                        "²",  "³", "^", "^9",   "/",  "*",     "+", "-",  ".",
                                        "µm", "%", "°", "\xC2", "kg", "1 mm",  ",", "("};
  int read = 0;
  for (int i = 0; i < 10000; ++i) {
    std::string text;
    for (unsigned k = 0; k < 1 + random() % 6; ++k) text += pieces[random() % pieces.size()];
    try {
      read += std::isfinite(evaluate(text, [](const std::string&) { return Number{2, {}}; }).value) ? 1 : 0;
    } catch (const ValueError&) {
    }
    (void)looks_like_quantity(text);
  }
  EXPECT_GT(read, 250);
}

}  // namespace
}  // namespace embacle::mps
