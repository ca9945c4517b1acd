// Model floe in LIGGGHTS: rebound, rest and friction of whole bodies, whatever spheres cover them.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

#include "contact/floe_contacts.hpp"
#include "contact/floe_styles.hpp"
#include "solids.hpp"

namespace embacle::liggghts {
namespace {

using coupling::SolidBody;
using coupling::Vec3;

const std::string floor_wall = "fix floor all wall/gran model floe primitive type 1 zplane 0.0";
constexpr double edge = 0.2, height = 0.1, mass = 900 * edge * edge * height;
constexpr double degree = std::numbers::pi / 180;

/// Whether this run has one rank; tests of physics need no more.
bool alone() {
  int ranks = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks == 1;
}

std::string box(int spheres) { return fmt::format("shape box 0.2 0.2 0.1 density 900 spheres {} ", spheres); }

/// The largest over the ranks of a component of the only body's force [N].
double force_on_body(const Solids& solids, int component) {
  auto* multisphere = find_multisphere(solids.lammps(), "test");
  double force = -1e300;
  if (multisphere->n_body() > 0) force = multisphere->data().extract_double_vector("fcm")[0][component];
  MPI_Allreduce(MPI_IN_PLACE, &force, 1, MPI_DOUBLE, MPI_MAX, solids.lammps()->world);
  return force;
}

struct Impact {
  coupling::State after;
  double duration = 0;       ///< [s]
  double largest_force = 0;  ///< [N]
};

/// A tilted box without weight hits a smooth floor and leaves it. The modulus grows with the square of the speed, so
/// that the floor is touched along the same path at any speed.
Impact hit_floor(double restitution, double speed, int spheres, double tilt) {
  Solids solids;
  const double modulus = 5e8 * std::pow(speed / 0.05, 2), step = 2e-6 * 0.05 / speed;
  solids.prepare(fmt::format("{}", modulus), "floe", restitution, 0);
  const double low = 0.5 * edge * std::sin(tilt * degree) + 0.5 * height * std::cos(tilt * degree);
  solids.run({fmt::format("timestep {}", step), floor_wall,
              "fix floes all floe/create " + box(spheres) +
                  fmt::format("position 0 0 {} rotate 0 1 0 {} velocity 0 0 {}", low + 2e-6, tilt, -speed),
              "run 0"});
  Impact impact;
  bool touched = false;
  for (int n = 0; n < 20000; ++n) {
    solids.run({"run 1 pre no post no"});
    const double force = force_on_body(solids, 2);
    impact.largest_force = std::max(impact.largest_force, force);
    if (touched && force <= 0) break;
    touched = touched || force > 0;
    if (touched) impact.duration += step;
  }
  EXPECT_TRUE(touched);
  impact.after = solids.bodies()[0].state;
  return impact;
}

/// Velocity and turning after an impulse (1 + e) v / (1 / m + arm^2 / I) at the lowest corner.
void expect_rigid_impact(const Impact& impact, double restitution, double speed, double tilt, double tolerance) {
  const double arm = tilt > 0 ? 0.5 * edge * std::cos(tilt * degree) - 0.5 * height * std::sin(tilt * degree) : 0.0;
  const double inertia = mass * (edge * edge + height * height) / 12;
  const double separation = impact.after.velocity.z() - impact.after.angular_velocity.y() * arm;
  EXPECT_NEAR(separation / speed, restitution, tolerance * restitution) << "tilt " << tilt << " speed " << speed;
  const double impulse = (1 + restitution) * speed / (1 / mass + arm * arm / inertia);
  EXPECT_NEAR(impact.after.velocity.z(), impulse / mass - speed, tolerance * speed);
  EXPECT_NEAR(impact.after.angular_velocity.y(), -impulse * arm / inertia, tolerance * speed / edge);
}

TEST(FloeContact, TheImpulseOnAWallIsTheChangeOfMomentum) {
  Solids solids;
  solids.prepare("1e7", "floe", 0.4, 0.3);
  const std::string table = testing::TempDir() + "embacle-walls.csv";
  solids.run({"timestep 1e-5", "fix pier all wall/gran model floe primitive type 1 xplane 0.5",
              "fix left all wall/gran model floe primitive type 1 yplane -0.9",
              "fix floes all floe/create " + box(8) + "position 0.37 0.1 0 rotate 0 0 1 20 velocity 0.8 0.1 0",
              fmt::format("fix record all floe/record walls {} every 100", table), "run 0"});
  const auto before = solids.bodies()[0].state;
  solids.run({"run 5000"});
  const auto after = solids.bodies()[0].state;
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank != 0) return;
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  EXPECT_TRUE(line.starts_with("t [s],pier fx [N],pier fy [N]")) << line;
  Vec3 pier = Vec3::Zero(), left = Vec3::Zero();
  double torque = 0, time = 0;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    double t = 0;
    Vec3 force, moment, force_left, moment_left;
    numbers >> t;
    for (Vec3* part : {&force, &moment, &force_left, &moment_left}) numbers >> (*part)[0] >> (*part)[1] >> (*part)[2];
    ASSERT_TRUE(numbers);
    pier += (t - time) * force;
    left += (t - time) * force_left;
    torque += (t - time) * moment.z();
    time = t;
  }
  const Vec3 change = mass * (before.velocity - after.velocity);
  EXPECT_GT(change.x(), 0.8 * mass);
  EXPECT_LT((pier - change).norm(), 1e-3 * change.norm());
  EXPECT_EQ(left.norm(), 0);
  const double inertia = mass * (edge * edge + edge * edge) / 12;
  const auto angular = [&](const coupling::State& s) {
    return s.position.cross(mass * s.velocity).z() + inertia * s.angular_velocity.z();
  };
  EXPECT_NEAR(torque, angular(before) - angular(after), 2e-3 * std::abs(torque)) << "about the origin";
  std::remove(table.c_str());
}

TEST(FloeContact, ReboundsAsAskedWithAnySpheres) {
  if (!alone()) GTEST_SKIP();
  for (const double speed : {0.05, 5.0}) {
    for (const double restitution : {0.1, 0.5, 0.95}) {
      const Impact few = hit_floor(restitution, speed, 8, 0);
      expect_rigid_impact(few, restitution, speed, 0, 1e-4);
      const Impact many = hit_floor(restitution, speed, 125, 0);
      expect_rigid_impact(many, restitution, speed, 0, 1e-4);
      EXPECT_NEAR(few.duration / many.duration, 1, 1e-9);
      EXPECT_NEAR(few.largest_force / many.largest_force, 1, 1e-9);
    }
  }
}

TEST(FloeContact, TiltedBoxesReboundAsRigidOnes) {
  if (!alone()) GTEST_SKIP();
  for (const double tilt : {5.0, 30.0}) {
    for (const double restitution : {0.1, 0.5, 0.95}) {
      expect_rigid_impact(hit_floor(restitution, 0.05, 8, tilt), restitution, 0.05, tilt, 0.03);
    }
  }
}

TEST(FloeContact, ShiftedBoxesReboundAndKeepMomentum) {
  if (!alone()) GTEST_SKIP();
  for (const double restitution : {0.1, 0.5, 0.95}) {
    Solids solids;
    solids.prepare("5e8", "floe", restitution, 0);
    solids.run({"timestep 2e-6",
                "fix floes all floe/create " + box(27) +
                    "position 0 0 0.0501 velocity 0 0 -0.5 position 0.025 0.025 -0.0501 velocity 0 0 0.5",
                "run 0", "run 1500 pre no post no"});
    const auto bodies = solids.bodies();
    const Vec3 centre(0.0125, 0.0125, 0);
    const auto at_centre = [&](const SolidBody& body) {
      return Vec3(body.state.velocity + body.state.angular_velocity.cross(centre - body.state.position));
    };
    EXPECT_NEAR(at_centre(bodies[0]).z() - at_centre(bodies[1]).z(), restitution, 0.01 * restitution);
    EXPECT_LT((bodies[0].state.velocity + bodies[1].state.velocity).norm(), 1e-13);
    // Equal boxes that meet at the middle of their patch turn alike.
    EXPECT_LT((bodies[0].state.angular_velocity - bodies[1].state.angular_velocity).norm(), 1e-10);
  }
}

TEST(FloeContact, StackComesToRest) {
  if (!alone()) GTEST_SKIP();
  Solids solids;
  solids.prepare("5e7", "floe");
  std::string words = "fix floes all floe/create " + box(4);
  for (int b = 0; b < 5; ++b) words += fmt::format(" position {} 0 {}", 0.003 * (b % 2), 0.05005 + 0.10005 * b);
  solids.run({"timestep 2e-5", floor_wall, "fix g all gravity 9.81 vector 0 0 -1", words, "run 0",
              "run 20000 pre no post no"});
  const auto bodies = solids.bodies();
  // Each contact yields by weight over stiffness: two springs of E / h each in a row, and likewise on the floor.
  const double stiffness = 0.5 * 5e7 / height * edge * edge;
  double expected = -0.5 * height;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto& state = bodies[b].state;
    EXPECT_LT(state.velocity.norm() + state.angular_velocity.norm() * edge, 1e-5);
    const double width = b == 0 ? edge : edge - 0.003;
    expected += height - static_cast<double>(bodies.size() - b) * mass * 9.81 / (stiffness * width / edge);
    EXPECT_NEAR(state.position.z(), expected, 1e-7);
    EXPECT_NEAR(state.position.x(), 0.003 * static_cast<double>(b % 2), 1e-5);  // it sways as it settles
  }
}

TEST(FloeContact, FrictionSticksAndSlides) {
  if (!alone()) GTEST_SKIP();
  for (const int spheres : {8, 125}) {
    for (const double angle : {15.0, 25.0}) {  // friction 0.4: sticks up to 21.8 degrees
      Solids solids;
      solids.prepare("5e7", "floe");
      solids.run(
          {"timestep 2e-5", floor_wall,
           fmt::format("fix g all gravity 9.81 vector {} 0 {}", std::sin(angle * degree), -std::cos(angle * degree)),
           "fix floes all floe/create " + box(spheres) + "position -0.5 0 0.05", "run 0", "run 10000 pre no post no"});
      const double before = solids.bodies()[0].state.velocity.x();
      solids.run({"run 10000 pre no post no"});
      const double after = solids.bodies()[0].state.velocity.x();
      const double sliding = 9.81 * (std::sin(angle * degree) - 0.4 * std::cos(angle * degree));
      if (sliding < 0) {
        EXPECT_LT(std::abs(after), 1e-6);
      } else {
        EXPECT_NEAR((after - before) / 0.2, sliding, 1e-3 * sliding);
      }
    }
  }
}

TEST(FloeContact, CylindersRollOn) {
  if (!alone()) GTEST_SKIP();
  // Soft enough for its patch to span more than a side of the polygon; what slows it is then restitution alone.
  Solids solids;
  solids.prepare("1e7", "floe", 0.5, 0.4);
  const std::string cylinder =
      "fix floes all floe/create shape cylinder 0.05 0.2 density 900 spheres 8 position -0.5 0 0.05 "
      "rotate 1 0 0 90 velocity 0.5 0 0 omega 0 10 0";
  solids.run({"timestep 2e-5", "fix g all gravity 9.81 vector 0 0 -1", floor_wall, cylinder, "run 5000"});
  const double before = solids.bodies()[0].state.velocity.x();
  solids.run({"run 45000"});
  const auto state = solids.bodies()[0].state;
  const double resistance = 1.5 * (before - state.velocity.x()) / (0.9 * 9.81);
  EXPECT_LT(std::abs(resistance), 0.004);
  EXPECT_NEAR(state.angular_velocity.y() * 0.05, state.velocity.x(), 0.01 * state.velocity.x());
}

TEST(FloeContact, MeshesActLikePlanes) {
  if (!alone()) GTEST_SKIP();
  // The plane z = 0 as two triangles, with corners far outside of the body and an edge below it.
  std::FILE* file = std::fopen("floor.stl", "w");
  ASSERT_NE(file, nullptr);
  std::fputs(
      "solid floor\nfacet normal 0 0 1\nouter loop\nvertex -0.9 -0.9 0\nvertex 0.9 -0.9 0\nvertex 0.9 0.9 0\n"
      "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex -0.9 -0.9 0\nvertex 0.9 0.9 0\n"
      "vertex -0.9 0.9 0\nendloop\nendfacet\nendsolid floor\n",
      file);
  std::fclose(file);
  // Without damping and friction: those depend, slightly, on how the triangles cut the patch.
  std::vector<coupling::State> ends;
  for (const bool mesh : {false, true}) {
    Solids solids;
    solids.prepare("5e7", "floe", 1, 0);
    if (mesh) {
      solids.run({"fix surface all mesh/surface file floor.stl type 1",
                  "fix floor all wall/gran model floe mesh n_meshes 1 meshes surface"});
    } else {
      solids.run({floor_wall});
    }
    solids.run({"timestep 2e-5", "fix g all gravity 9.81 vector 0.2 0 -1",
                "fix floes all floe/create " + box(8) + "position 0.03 -0.02 0.12 rotate 1 2 3 20", "run 0",
                "run 15000 pre no post no"});
    ends.push_back(solids.bodies()[0].state);
  }
  EXPECT_LT((ends[0].position - ends[1].position).norm(), 1e-9);
  EXPECT_LT((ends[0].velocity - ends[1].velocity).norm(), 1e-7);
}

/// Boxes, a prism and a disc that tumble onto the floor; with `restart_file`, continued from there.
struct Heap : Solids {
  explicit Heap(MPI_Comm world, const std::string& restart_file = "") : Solids(world) {
    std::string words = "fix floes all floe/create shape box 0.2 0.2 0.1 density 900 spheres 8";
    for (int b = 0; b < 6; ++b) {
      words += fmt::format(" position {} {} {} rotate 1 {} 3 {}", -0.3 + 0.12 * b, 0.02 * b - 0.05, 0.2 + 0.11 * b, b,
                           10 * b + 5);
    }
    words +=
        " shape prism 0.1 3 0 0 0.3 0 0.1 0.2 density 900 spheres 10 position -0.65 0.1 0.2 velocity 1 0 0"
        " shape disc 0.1 0.08 density 900 spheres 10 position 0.5 -0.1 0.2 velocity -1 0.1 0 omega 5 0 3";
    prepare("5e7", "floe", 0.5, 0.4, restart_file);
    run({"timestep 2e-5", floor_wall, "fix g all gravity 9.81 vector 0 0 -1", words, "run 0"});
  }
  void steps(int count) { run({fmt::format("run {} pre no post no", count)}); }
};

void expect_same(const std::vector<SolidBody>& bodies, const std::vector<SolidBody>& expected, double tolerance) {
  ASSERT_EQ(bodies.size(), expected.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_EQ(bodies[b].tag, expected[b].tag);
    EXPECT_LE((bodies[b].state.position - expected[b].state.position).norm(), tolerance) << "body " << bodies[b].tag;
    EXPECT_LE((bodies[b].state.velocity - expected[b].state.velocity).norm(), 100 * tolerance)
        << "body " << bodies[b].tag;
  }
}

TEST(FloeContact, RanksAgree) {
  Heap one(MPI_COMM_SELF), all(MPI_COMM_WORLD);
  one.steps(10000);
  all.steps(10000);
  expect_same(all.bodies(), one.bodies(), 1e-9);
}

TEST(FloeContact, ContinuesFromARestartFile) {
  Heap whole(MPI_COMM_WORLD);
  whole.steps(9000);
  auto contacts = floe_contacts(whole.lammps())->memory().contacts.size();
  MPI_Bcast(&contacts, 1, MPI_UNSIGNED_LONG, 0, MPI_COMM_WORLD);
  EXPECT_GT(contacts, 0U);
  whole.run({"write_restart floes.restart"});
  whole.steps(1000);
  Heap same_ranks(MPI_COMM_WORLD, "floes.restart");
  same_ranks.steps(1000);
  expect_same(same_ranks.bodies(), whole.bodies(), 0);
  MPI_Barrier(MPI_COMM_WORLD);
  Heap one_rank(MPI_COMM_SELF, "floes.restart");
  one_rank.steps(1000);
  expect_same(one_rank.bodies(), whole.bodies(), 1e-9);
}

TEST(FloeContact, RefusesOverlapsAndLeaps) {
  if (!alone()) GTEST_SKIP();
  const std::string prism = "shape prism 0.1 3 0 0 0.3 0 0.1 0.2 density 900 spheres 10 ";
  const std::string discs = "shape disc 0.1 0.1 density 900 spheres 8 ";  // whose spheres do not touch
  const std::vector<std::array<std::string, 3>> cases = {
      {box(8) + "position 0 0 0.02", "1e-5", "overlap by 0.03 m all at once"},
      {prism + "position 0 0 0.3 position 0.17 0.1 0.3", "1e-5", "1 pair(s) of bodies overlap"},
      {discs + "position 0 0 0.3 position 0.19 0 0.3", "1e-5", "the bodies 1 and 2 overlap by"},
      {box(8) + "position 0 0 0.3 velocity 0 0 -1e3", "1e-3", "could pass through others unseen"},
      {box(8) + "position 0 0 0.3", "0", "the time step must be positive"}};
  for (const auto& [words, step, message] : cases) {
    Solids solids;
    solids.prepare("5e7", "floe");
    try {
      solids.run({floor_wall, "timestep " + step, "fix floes all floe/create " + words, "run 0"});
      ADD_FAILURE() << "accepted: " << words;
    } catch (const std::exception& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
}

TEST(FloeContact, StopsWhereItWouldBeWrong) {
  if (!alone()) GTEST_SKIP();
  const auto message = [](const std::string& modulus, double speed) -> std::string {
    Solids solids;
    solids.prepare(modulus, "floe");
    solids.run({"timestep 1e-5", floor_wall,
                "fix floes all floe/create " + box(8) + fmt::format("position 0 0 0.0501 velocity 0 0 {}", -speed),
                "run 0"});
    try {
      solids.run({"run 1000"});
    } catch (const coupling::InstabilityError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("5e7", 1), "");
  EXPECT_NE(message("5e12", 1).find("too long for the contact of body 1 and fix floor"), std::string::npos);
  EXPECT_NE(message("5e6", 50).find("body 1 and fix floor press into each other"), std::string::npos);
}

TEST(FloeContact, WarnsWhereAHeavyBodyWouldReboundTooMuch) {
  if (!alone()) GTEST_SKIP();
  // Onto a light box that lies on the floor.
  const auto warned = [](double ratio, double step) {
    Solids solids;
    solids.prepare("5e7", "floe");
    FILE* const before = solids.lammps()->screen;
    FILE* const screen = solids.lammps()->screen = std::tmpfile();
    solids.run({fmt::format("timestep {}", step), floor_wall,
                "fix floes all floe/create " + box(8) + "position 0 0 0.050001 " +
                    fmt::format("shape box 0.2 0.2 0.1 density {} spheres 8 position 0 0 0.150002 velocity 0 0 -0.1",
                                900 * ratio),
                "run 200"});
    std::rewind(screen);
    std::string text(100000, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), screen));
    std::fclose(screen);
    solids.lammps()->screen = before;
    return text.find("body 1 is pressed by body 2") != std::string::npos;
  };
  EXPECT_FALSE(warned(1, 6e-5));
  EXPECT_FALSE(warned(100, 6e-5));
  EXPECT_TRUE(warned(1000, 6e-5));
  EXPECT_FALSE(warned(1000, 1.2e-5));
}

TEST(FloeContact, RefusesWhatItDoesNotKnow) {
  if (!alone()) GTEST_SKIP();
  const auto refused = [](const std::vector<std::string>& lines) {
    Solids solids;
    solids.prepare("5e7", "floe");
    EXPECT_THROW(solids.run(lines), coupling::InputError) << lines.back();
  };
  refused({"pair_style gran model floe tangential history"});
  refused({"pair_style gran model floe rolling_friction cdt"});
  refused({"fix floor all wall/gran model floe tangential history primitive type 1 zplane 0.0"});
  refused({"fix pipe all wall/gran model floe primitive type 1 zcylinder 0.5 0 0", "run 0"});
  refused({"fix floes all floe/create shape sphere 0.1 density 900 spacing 0.1 position 0 0 0", "run 0"});
  refused(
      {"fix floes all floe/create shape prism 0.1 6 0 0 0.6 0 0.6 0.2 0.2 0.2 0.2 0.5 0 0.5 density 917 spacing "
       "0.1 position 0 0 0",
       "run 0"});
}

}  // namespace
}  // namespace embacle::liggghts
