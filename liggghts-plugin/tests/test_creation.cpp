// Bodies in LIGGGHTS are exactly the described ones, on any number of ranks, and move as rigid bodies.
#include <gtest/gtest.h>

#include "fix_floe_create.hpp"
#include "solids.hpp"
#include "stock_access.hpp"

namespace embacle::liggghts {
namespace {

using coupling::Quaternion;
using coupling::SolidBody;
using coupling::Vec3;

constexpr double exact = 1e-12;

const std::string three_shapes =
    "fix floes all floe/create "
    "shape box 0.3 0.2 0.1 density 900 spacing 0.05 "
    "position 0 0 0 rotate 1 2 3 40 velocity 0.1 -0.2 0.3 omega 1 2 -3 "  // straddles every subdomain
    "position -0.5 0.4 0.6 velocity 0 0 -1 "
    "shape cylinder 0.1 0.3 mass 4.2 spacing 0.06 position 0.5 -0.5 0.5 rotate 0 1 0 30 omega 0 5 0 "
    "shape sphere 0.12 density 500 position -0.6 -0.6 -0.6 velocity 1 1 1";

/// A disc, an L that straddles every subdomain, and a wedge with principal axes of its own.
const std::string more_shapes =
    "fix floes all floe/create shape disc 0.2 0.1 density 900 spheres 20 position -0.5 0.5 -0.5 rotate 1 0 0 30 "
    "shape prism 0.1 6 0 0 0.6 0 0.6 0.2 0.2 0.2 0.2 0.5 0 0.5 density 917 spacing 0.1 "
    "position 0 0 0 rotate 3 2 1 50 velocity 0.1 -0.2 0.3 omega 1 2 -3 "
    "shape prism 0.2 3 0 0 0.6 0 0 0.4 mass 7 spheres 30 position 0.5 0.5 0.5 omega 0 0 4";

double angle_between(const Quaternion& a, const Quaternion& b) { return 2 * (a.conjugate() * b).vec().norm(); }

void expect_state(const SolidBody& body, const coupling::State& expected, double tolerance) {
  EXPECT_LT((body.state.position - expected.position).norm(), tolerance) << "body " << body.tag;
  EXPECT_LT(angle_between(body.state.orientation, expected.orientation), tolerance) << "body " << body.tag;
  EXPECT_LT((body.state.velocity - expected.velocity).norm(), tolerance) << "body " << body.tag;
  EXPECT_LT((body.state.angular_velocity - expected.angular_velocity).norm(), tolerance) << "body " << body.tag;
}

TEST(Creation, IsExact) {
  Solids solids;
  solids.prepare();
  solids.run({three_shapes});
  const auto* fix = dynamic_cast<FixFloeCreate*>(solids.lammps()->modify->find_fix_id("floes"));
  ASSERT_NE(fix, nullptr);
  for (int pass = 0; pass < 2; ++pass) {  // as created, and after LIGGGHTS' own set-up
    const auto bodies = solids.bodies();
    ASSERT_EQ(bodies.size(), 4U);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      EXPECT_EQ(bodies[b].tag, static_cast<coupling::BodyTag>(b + 1));
      EXPECT_EQ(bodies[b].shape, fix->list().floes[b].shape);
      expect_state(bodies[b], fix->list().floes[b].state, exact);
    }
    solids.run({"run 0"});
  }
}

TEST(Creation, MassAndInertiaAreTheShapes) {
  Solids solids;
  solids.prepare();
  solids.run({three_shapes, "run 0"});
  auto* multisphere = find_multisphere(solids.lammps(), "test");
  const auto shapes = floe_shapes(solids.lammps());
  const auto owned = owned_bodies(solids.lammps(), multisphere);
  for (int i = 0; i < multisphere->n_body(); ++i) {
    const auto expected = shapes[owned[i].shape]->shape.mass_properties();
    EXPECT_NEAR(multisphere->data().mass(i) / expected.mass, 1, exact);
    const Vec3 inertia = Eigen::Map<Vec3>(multisphere->data().extract_double_vector("inertia")[i]);
    EXPECT_LT((inertia - expected.inertia).norm(), exact * expected.inertia.norm());
    if (owned[i].shape == 1) {
      EXPECT_NEAR(multisphere->data().mass(i), 4.2, exact);
    }
  }
  int bodies = multisphere->n_body();
  MPI_Allreduce(MPI_IN_PLACE, &bodies, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(bodies, 4);
}

TEST(Creation, PrismsAndDiscsAreExactToo) {
  Solids solids;
  solids.prepare();
  solids.run({more_shapes, "run 0"});
  const auto* fix = dynamic_cast<FixFloeCreate*>(solids.lammps()->modify->find_fix_id("floes"));
  const auto bodies = solids.bodies();
  ASSERT_EQ(bodies.size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) expect_state(bodies[b], fix->list().floes[b].state, exact);
  auto* multisphere = find_multisphere(solids.lammps(), "test");
  const auto shapes = floe_shapes(solids.lammps());
  const auto owned = owned_bodies(solids.lammps(), multisphere);
  for (int i = 0; i < multisphere->n_body(); ++i) {
    const auto expected = shapes[owned[i].shape]->shape.mass_properties();
    EXPECT_NEAR(multisphere->data().mass(i) / expected.mass, 1, exact);
    const Vec3 inertia = Eigen::Map<Vec3>(multisphere->data().extract_double_vector("inertia")[i]);
    EXPECT_LT((inertia - expected.inertia).norm(), exact * expected.inertia.norm());
  }
  // The tensor in space of the turned wedge is that of the textbook: the polygon's frame is the frame of the script.
  const double a = 0.6, b = 0.4, mass = 7;
  const auto moments = shapes[2]->shape.mass_properties().inertia;
  const auto axes = bodies[2].state.orientation.toRotationMatrix();
  const auto tensor = coupling::Mat3(axes * moments.asDiagonal() * axes.transpose());
  EXPECT_NEAR(tensor(0, 0), mass * (b * b / 18 + 0.04 / 12), exact);
  EXPECT_NEAR(tensor(1, 1), mass * (a * a / 18 + 0.04 / 12), exact);
  EXPECT_NEAR(tensor(0, 1), mass * a * b / 36, exact);
}

TEST(Creation, APrismTumblesWithoutTorque) {
  Solids solids;
  solids.prepare();
  solids.run({more_shapes});
  const auto shapes = floe_shapes(solids.lammps());
  const auto momentum = [&](const SolidBody& body) {
    const auto axes = body.state.orientation.toRotationMatrix();
    const Vec3 moments = shapes[body.shape]->shape.mass_properties().inertia;
    return Vec3(axes * moments.cwiseProduct(axes.transpose() * body.state.angular_velocity));
  };
  const Vec3 before = momentum(solids.bodies()[1]);
  solids.run({"timestep 1e-4", "run 1000"});
  const SolidBody after = solids.bodies()[1];
  EXPECT_LT((momentum(after) - before).norm(), 1e-6 * before.norm());
  EXPECT_LT((after.state.position - Vec3(0.01, -0.02, 0.03)).norm(), 1e-10);
  EXPECT_GT((after.state.angular_velocity - Vec3(1, 2, -3)).norm(), 0.01);  // it does tumble
}

TEST(Creation, FreeFallIsExact) {
  Solids solids;
  solids.prepare();
  solids.run({"fix gravity all gravity 9.81 vector 0 0 -1", three_shapes});
  const auto before = solids.bodies();
  solids.run({"timestep 1e-3", "run 100"});  // 5 cm: bodies cross subdomains
  const double time = 0.1;
  const auto after = solids.bodies();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t b = 0; b < after.size(); ++b) {
    const Vec3 fall(0, 0, -9.81);
    const auto& start = before[b].state;
    const Vec3 place = start.position + start.velocity * time + 0.5 * fall * time * time;
    EXPECT_LT((after[b].state.position - place).norm(), exact);
    EXPECT_LT((after[b].state.velocity - start.velocity - fall * time).norm(), exact);
  }
}

TEST(Creation, SphereCentresBelongToTheBody) {
  Solids solids;
  solids.prepare();
  solids.run({three_shapes, "run 50"});
  const auto bodies = solids.bodies();
  const auto shapes = floe_shapes(solids.lammps());
  auto* multisphere = find_multisphere(solids.lammps(), "test");
  const auto* index = static_cast<LAMMPS_NS::FixPropertyAtom*>(solids.lammps()->modify->find_fix_id("floeSphere"));
  const auto* atom = solids.lammps()->atom;
  int spheres = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const auto& body = bodies.at(multisphere->belongs_to(i) - 1);
    const auto& sphere = shapes[body.shape]->spheres.at(static_cast<std::size_t>(index->vector_atom[i]));
    const Vec3 place = body.state.position + body.state.orientation * sphere.centre;
    EXPECT_LT((Eigen::Map<const Vec3>(atom->x[i]) - place).norm(), 1e-9);
    EXPECT_DOUBLE_EQ(atom->radius[i], sphere.radius);
    ++spheres;
  }
  MPI_Allreduce(MPI_IN_PLACE, &spheres, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(static_cast<std::size_t>(spheres),
            2 * shapes[0]->spheres.size() + shapes[1]->spheres.size() + shapes[2]->spheres.size());
}

TEST(Creation, ASecondFixContinuesTagsAndSeesTheFirst) {
  Solids solids;
  solids.prepare();
  solids.run({three_shapes, "run 10", "fix more all floe/create shape sphere 0.1 density 900 position 0.5 0.5 -0.5"});
  const auto bodies = solids.bodies();
  ASSERT_EQ(bodies.size(), 5U);
  EXPECT_EQ(bodies.back().tag, 5);
  EXPECT_EQ(bodies.back().shape, 3);
  EXPECT_LT((bodies.back().state.position - Vec3(0.5, 0.5, -0.5)).norm(), exact);
  solids.run({"run 10"});
  EXPECT_EQ(solids.bodies().size(), 5U);
}

/// The message of the RunError that the lines must raise.
std::string failure_of(const std::vector<std::string>& lines, coupling::ExitStatus status) {
  auto* solids = new Solids;  // never destroyed: LIGGGHTS cannot clean up after an error
  solids->prepare();
  try {
    solids->run(lines);
  } catch (const coupling::RunError& error) {
    EXPECT_EQ(error.status(), status);
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return "";
}

FloeList prisms(const std::vector<double>& lengths, double sphere_radius) {
  FloeList list;
  for (const double length : lengths) {
    FloeShape shape;
    shape.shape = coupling::make_prism({{0, 0}, {length, 0}, {0, 0.3}}, 0.1, 900);
    shape.spacing = 0.05;
    shape.sphere_radius = sphere_radius;
    list.add_shape(shape);
  }
  return list;
}

TEST(Creation, RanksShareOutTheCoverings) {
  for (const std::vector<double>& lengths : {std::vector{0.4}, {0.4, 0.45, 0.5, 0.55, 0.6}}) {
    FloeList shared = prisms(lengths, 0), alone = prisms(lengths, 0);
    shared.cover(MPI_COMM_WORLD);
    for (std::size_t i = 0; i < lengths.size(); ++i) {
      alone.shapes[i].cover();
      EXPECT_EQ(shared.shapes[i].shape.name, alone.shapes[i].shape.name);
      const auto &mine = shared.shapes[i].spheres, &expected = alone.shapes[i].spheres;
      ASSERT_EQ(mine.size(), expected.size());
      for (std::size_t s = 0; s < mine.size(); ++s) {
        EXPECT_EQ(mine[s].centre, expected[s].centre);
        EXPECT_EQ(mine[s].radius, expected[s].radius);
      }
    }
  }
  // The shapes of which some have no room for spheres of 4 cm: every rank names the first, 6 cm long.
  FloeList narrow = prisms({0.5, 0.6, 0.06, 0.05}, 0.04);
  try {
    narrow.cover(MPI_COMM_WORLD);
    ADD_FAILURE() << "no error";
  } catch (const coupling::InputError& error) {
    FloeList first = prisms({0.06}, 0.04);
    std::string expected;
    try {
      first.cover(MPI_COMM_SELF);
    } catch (const coupling::InputError& alone) {
      expected = alone.what();
    }
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(error.what(), expected);
  }
}

TEST(Creation, ErrorsNameBodyAndPlace) {
  const auto input = coupling::ExitStatus::input;
  const std::string unit = "fix f all floe/create shape box 0.2 0.2 0.2 density 900 spacing 0.1 ";
  EXPECT_NE(failure_of({unit + "position 0 0 0 position 0.15 0 0"}, input).find("overlap is 0.05 m, between body 1"),
            std::string::npos);
  EXPECT_NE(
      failure_of({unit + "position 0 0 0", "fix g all floe/create shape sphere 0.1 density 900 position 0.15 0 0"},
                 input)
          .find("existing body with tag 1"),
      std::string::npos);
  EXPECT_NE(failure_of({unit + "position 0.95 0 0"}, input).find("reaches from x = 0.85 to 1.05 m"), std::string::npos);
  EXPECT_NE(failure_of({unit + "position 0 0 0", "unfix f"}, input).find("may not be unfixed"), std::string::npos);
  EXPECT_NE(failure_of({"pair_styl gran"}, input).find("nknown command"), std::string::npos);
  EXPECT_NE(failure_of({"fix x all wall/gran model hertz primitive type 1 nothing 0"}, input).find("fix x wall/gran"),
            std::string::npos);
}

}  // namespace
}  // namespace embacle::liggghts
