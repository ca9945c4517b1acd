// The solid side of a coupled run against a water of known loads: the first ranks play the fluid, the others run
// LIGGGHTS.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>

#include "coupled_run.hpp"
#include "fix_floe_create.hpp"
#include "solids.hpp"

namespace embacle::liggghts {
namespace {

using coupling::BodyTag;
using coupling::FluidBody;
using coupling::FluidLink;
using coupling::FluidTerms;
using coupling::Load;
using coupling::Scheme;
using coupling::State;
using coupling::Vec3;

/// What a fluid rank does: the load on a body in a window, and a look at the states after each window.
struct Water {
  Vec3 gravity = Vec3::Zero();
  Scheme scheme = Scheme::serial;
  double window = 1e-3;
  int windows = 50;
  std::function<Load(const FluidBody&, int window)> load = [](const FluidBody&, int) { return Load{}; };
  std::function<double(const Vec3&)> pressure;  ///< at a place [Pa]
  std::function<void(const std::vector<FluidBody>&, int window)> look = [](const std::vector<FluidBody>&, int) {};
};

class Coupled : public testing::Test {
 protected:
  void SetUp() override {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    fluid_ranks_ = size_ >= 4 ? 2 : 1;
    participants_ = coupling::split_world(fluid() ? coupling::Role::fluid : coupling::Role::solid, own_);
  }
  void TearDown() override { coupling::release(participants_); }
  [[nodiscard]] bool fluid() const { return rank_ < fluid_ranks_; }

  /// Plays the fluid: the box is cut along x among the fluid ranks; a body's load is shared equally by its sharers.
  void play(const Water& water) {
    FluidTerms terms;
    terms.gravity = water.gravity;
    terms.scheme = water.scheme;
    terms.particle_distance = 0.02;
    terms.point_depth = 0.04;
    terms.reach = 0.1;
    terms.reference_speed = 5;
    terms.fluid_density = 1000;
    FluidLink link(participants_, own_, terms);
    int me = 0;
    MPI_Comm_rank(own_, &me);
    coupling::Box region{Vec3::Constant(-1e3), Vec3::Constant(1e3)};
    if (fluid_ranks_ == 2) (me == 0 ? region.upper : region.lower).x() = 0;
    std::vector<std::vector<coupling::ShapePoint>> points;
    for (const auto& shape : link.solid().shapes) points.push_back(shape.points(0.02, 0.04));

    int done = 0;
    bool first = true;
    const auto send = [&](int window) {
      std::vector<Load> loads;
      std::vector<coupling::BodyPressures> pressures;
      for (const FluidBody& body : link.bodies()) {
        Load load = water.load(body, window);
        load.force /= static_cast<double>(body.sharers.size());
        load.torque /= static_cast<double>(body.sharers.size());
        loads.push_back(load);
        if (!link.surface_pressures_due()) continue;
        coupling::BodyPressures part{body.tag, {}, {}};
        for (std::size_t k = 0; k < points[body.shape].size(); ++k) {
          const Vec3 place = body.state.position + body.state.orientation * points[body.shape][k].position;
          if (!region.contains(place)) continue;
          part.point.push_back(static_cast<int>(k));
          part.pressure.push_back(water.pressure(place));
        }
        pressures.push_back(part);
      }
      link.send_loads(loads, pressures);
    };
    while (true) {
      coupling::Epoch proposal;
      proposal.windows = std::min(10, water.windows - done);
      proposal.window = water.window;
      proposal.time = done * water.window;
      const coupling::Epoch epoch = link.plan(region, proposal);
      if (epoch.windows == 0) break;
      if (first && water.scheme == Scheme::parallel) send(-1);
      first = false;
      for (int w = 0; w < epoch.windows; ++w, ++done) {
        send(done);
        link.receive_states();
        water.look(link.bodies(), done);
      }
    }
  }

  /// Runs the solids; `after` sees them at the end.
  SolidReport solve(
      const std::vector<std::string>& lines, const std::string& young,
      const std::function<void(Solids&)>& after = [](Solids&) {}) {
    Solids solids(own_);
    solids.prepare(young);
    solids.run(lines);
    SolidReport report;
    run_coupled(solids.lammps(), find_couple_mps(solids.lammps()), participants_, own_, "", {}, report);
    after(solids);
    return report;
  }

  int rank_ = 0, size_ = 0, fluid_ranks_ = 1;
  MPI_Comm own_ = MPI_COMM_NULL;
  coupling::Participants participants_;
};

TEST_F(Coupled, ConstantLoadGivesForceOverMass) {
  const Vec3 force(3, -2, 1), torque(0, 0, 0.004), gravity(0, 0, -9.81);
  Water water;
  water.gravity = gravity;
  water.load = [&](const FluidBody& body, int) { return body.tag == 1 ? Load{force, torque} : Load{}; };
  std::map<BodyTag, State> start = {{1, State{}}, {2, State{}}, {3, State{}}};
  start[1].position = Vec3(-0.3, 0.2, 0.4);
  start[2].position = Vec3(0.5, 0.5, 0.5);
  start[2].velocity = Vec3(-1, 0, 2);
  start[3].position = Vec3(0.01, -0.5, 0.5);  // crosses the middle, where subdomains meet
  start[3].velocity = Vec3(-0.7, 0.3, 0);
  const double mass = 2.5, inertia = 0.4 * mass * 0.01;  // sphere of radius 0.1
  water.look = [&](const std::vector<FluidBody>& bodies, int window) {
    const double time = (window + 1) * water.window;
    for (const FluidBody& body : bodies) {
      const State& from = start.at(body.tag);
      const Vec3 acceleration = body.tag == 1 ? Vec3(gravity + force / mass) : gravity;
      EXPECT_LT((body.state.velocity - from.velocity - acceleration * time).norm(), 1e-12) << body.tag;
      EXPECT_LT((body.state.position - from.position - from.velocity * time - 0.5 * acceleration * time * time).norm(),
                1e-12)
          << body.tag;
      const Vec3 spin = body.tag == 1 ? Vec3(torque * time / inertia) : Vec3::Zero();
      EXPECT_LT((body.state.angular_velocity - spin).norm(), 1e-12);
      EXPECT_LT(body.state.contact_force.norm(), 1e-9);
      EXPECT_LT(body.state.contact_torque.norm(), 1e-12);
    }
  };
  if (fluid()) {
    play(water);
    return;
  }
  const SolidReport report = solve(
      {"fix gravity all gravity 9.81 vector 0 0 -1",
       "fix floes all floe/create shape sphere 0.1 mass 2.5 position -0.3 0.2 0.4 position 0.5 0.5 0.5 velocity -1 0 2 "
       "position 0.01 -0.5 0.5 velocity -0.7 0.3 0",
       "fix couple all couple/mps"},
      "5e7");
  EXPECT_EQ(report.windows, 50);
  EXPECT_EQ(report.most_sub_steps, 1);
  EXPECT_EQ(report.skin_limited_windows, 0);
  EXPECT_EQ(report.counters.windows, 50);
}

TEST_F(Coupled, LoadThatChangesEveryWindowIsAppliedInItsWindow) {
  // Serial: the load of a window acts in that window. Parallel: the load of the window before.
  for (const Scheme scheme : {Scheme::serial, Scheme::parallel}) {
    Water water;
    water.scheme = scheme;
    water.windows = 25;
    const auto force = [](int window) { return Vec3(std::sin(1.0 + window), 0, 2.0 * window); };
    water.load = [&](const FluidBody&, int window) { return Load{force(window), Vec3::Zero()}; };
    Vec3 velocity = Vec3::Zero();
    water.look = [&](const std::vector<FluidBody>& bodies, int window) {
      const int lag = scheme == Scheme::parallel ? 1 : 0;
      velocity += force(window - lag) / 2.5 * water.window;
      for (const FluidBody& body : bodies) EXPECT_LT((body.state.velocity - velocity).norm(), 1e-12) << window;
    };
    if (fluid()) {
      play(water);
    } else {
      solve({"fix floes all floe/create shape box 0.1 0.1 0.1 mass 2.5 spacing 0.05 position 0 0 0",
             "fix couple all couple/mps"},
            "5e7");
    }
    coupling::release(participants_);
    participants_ = coupling::split_world(fluid() ? coupling::Role::fluid : coupling::Role::solid, own_);
  }
}

TEST_F(Coupled, ContactIsResolvedAndReportedExactly) {
  // Two boxes meet at 1 m/s; before and after, one sub-step per window is enough.
  Water water;
  water.windows = 80;
  std::map<BodyTag, Vec3> velocity = {{1, Vec3(0.5, 0, 0)}, {2, Vec3(-0.5, 0, 0)}};
  double largest_force = 0;
  water.look = [&](const std::vector<FluidBody>& bodies, int) {
    Vec3 both = Vec3::Zero();
    for (const FluidBody& body : bodies) {
      const auto mass = 900 * 0.1 * 0.1 * 0.05;
      velocity[body.tag] += body.state.contact_force * water.window / mass;
      EXPECT_LT((body.state.velocity - velocity[body.tag]).norm(), 1e-11);
      both += body.state.contact_force;
      largest_force = std::max(largest_force, body.state.contact_force.norm());
    }
    if (bodies.size() == 2) {
      EXPECT_LT(both.norm(), 1e-9 * std::max(1.0, largest_force));
    }
  };
  if (fluid()) {
    play(water);
    EXPECT_GT(largest_force, 100);
    EXPECT_LT(velocity[1].x(), 0);  // thrown back
    return;
  }
  const SolidReport report = solve({"fix floes all floe/create shape box 0.1 0.1 0.05 density 900 spacing 0.05 "
                                    "position -0.062 0 0 velocity 0.5 0 0 position 0.062 0 0 velocity -0.5 0 0",
                                    "fix couple all couple/mps"},
                                   "5e8");
  EXPECT_EQ(report.fewest_sub_steps, 1);
  EXPECT_GT(report.most_sub_steps, 10);
  EXPECT_GT(report.resolved_windows, 0);
  EXPECT_LT(report.resolved_windows, report.windows / 2);
  EXPECT_EQ(report.skin_limited_windows, 0);
}

TEST_F(Coupled, PrimitiveWallAndMovingMeshAreFelt) {
  // A ball falls on a floor while a mesh plate moves up to another ball from below and lifts it.
  Water water;
  water.windows = 150;
  double floored = 0, lifted = 0;  // final speeds; a fluid rank knows only the bodies near its piece
  water.look = [&](const std::vector<FluidBody>& bodies, int) {
    for (const FluidBody& body : bodies) (body.tag == 1 ? floored : lifted) = body.state.velocity.z();
  };
  if (fluid()) {
    play(water);
    MPI_Allreduce(MPI_IN_PLACE, &floored, 1, MPI_DOUBLE, MPI_MAX, own_);
    MPI_Allreduce(MPI_IN_PLACE, &lifted, 1, MPI_DOUBLE, MPI_MAX, own_);
    EXPECT_GT(floored, 0.1);
    EXPECT_GT(lifted, 0.5);
    return;
  }
  const std::string plate = testing::TempDir() + "embacle-plate.stl";
  int solid_rank = 0;
  MPI_Comm_rank(own_, &solid_rank);
  if (solid_rank == 0) {
    std::ofstream(plate) << "solid plate\nfacet normal 0 0 1\nouter loop\nvertex 0.2 -0.3 -0.1\nvertex 0.8 -0.3 -0.1\n"
                            "vertex 0.5 0.4 -0.1\nendloop\nendfacet\nendsolid plate\n";
  }
  MPI_Barrier(own_);
  const SolidReport report =
      solve({"fix floor all wall/gran model hertz tangential history primitive type 1 zplane -0.5",
             "fix plate all mesh/surface file " + plate + " type 1",
             "fix gate all wall/gran model hertz tangential history mesh n_meshes 1 meshes plate",
             "fix move all move/mesh mesh plate linear 0 0 0.5",
             "fix floes all floe/create shape sphere 0.1 density 900 position -0.5 0 -0.38 velocity 0 0 -0.5 "
             "position 0.5 0 0.03",
             "fix couple all couple/mps"},
            "5e8");
  EXPECT_GT(report.most_sub_steps, 10);
  EXPECT_EQ(report.fewest_sub_steps, 1);
  EXPECT_EQ(report.windows, 150);
}

TEST_F(Coupled, SurfacePressuresReachTheSpheres) {
  Water water;
  water.windows = 7;
  const auto pressure = [](const Vec3& place) { return 5000 + Vec3(3000, -2000, -9810).dot(place); };
  water.pressure = pressure;
  if (fluid()) {
    play(water);
    return;
  }
  // The box straddles all subdomains. Spheres at corners, edges and faces: the mean of the pressure over their points.
  solve({"fix floes all floe/create shape box 0.4 0.4 0.2 density 900 spacing 0.1 sphere_radius 0.05 position 0 0 0",
         "fix couple all couple/mps pressures every 3"},
        "5e7", [&](Solids& solids) {
          const auto* property =
              static_cast<LAMMPS_NS::FixPropertyAtom*>(solids.lammps()->modify->find_fix_id("waterPressure"));
          ASSERT_NE(property, nullptr);
          const auto* atom = solids.lammps()->atom;
          // The oracle: mean over the points that are nearer to this sphere than to any other, weighted by area.
          const FloeShape& shape = *floe_shapes(solids.lammps()).front();
          const auto points = shape.shape.points(0.02, 0.04);
          const auto expected = [&](const Vec3& place) {
            double sum = 0, area = 0;
            for (const auto& point : points) {
              double nearest = 1e9;
              for (const auto& sphere : shape.spheres)
                nearest = std::min(nearest, (sphere.centre - point.position).norm());
              if ((place - point.position).norm() > nearest * (1 + 1e-9)) continue;
              sum += point.area * pressure(point.position);
              area += point.area;
            }
            return sum / area;
          };
          int spheres = 0;
          for (int i = 0; i < atom->nlocal; ++i, ++spheres) {
            const Vec3 place = Eigen::Map<const Vec3>(atom->x[i]);
            EXPECT_NEAR(property->vector_atom[i], expected(place), 1e-6) << place.transpose();
          }
          MPI_Allreduce(MPI_IN_PLACE, &spheres, 1, MPI_INT, MPI_SUM, own_);
          EXPECT_GT(spheres, 20);
        });
}

TEST_F(Coupled, PlanarWaterNeedsBodiesOfUnitDepth) {
  // Only the solid side is asked: no fluid takes part in this test.
  if (fluid()) return;
  Solids solids(own_);
  solids.prepare();
  solids.run({"fix floes all floe/create shape box 0.1 0.1 0.3 density 900 spacing 0.05 position 0 0 0",
              "fix couple all couple/mps"});
  FluidTerms planar;
  planar.dimension = 2;
  EXPECT_THROW(find_couple_mps(solids.lammps())->prepare(planar), coupling::InputError);
}

}  // namespace
}  // namespace embacle::liggghts
