// The exchange, end to end, on every division of the ranks: fake participants against a loop without messages.
#include <gtest/gtest.h>
#include <mpi.h>

#include <limits>
#include <map>
#include <numeric>

#include "fake_run.hpp"

namespace embacle::coupling {
namespace {

using fake::Result;
using fake::Scenario;

SolidBody body(BodyTag tag, const Vec3& position, const Vec3& velocity) {
  SolidBody result{tag, 1, {}};
  result.state.position = position;
  result.state.velocity = velocity;
  return result;
}

/// Bodies that cross the borders of all divisions, from both sides; some at rest; some slow.
Scenario crossing() {
  Scenario scenario;
  for (int i = 0; i < 12; ++i) {
    const double x = 0.6 * i + 0.4;
    scenario.bodies.push_back(
        body(10 + 7 * i, Vec3(x, 0.05 * i, 0.3), Vec3(i % 3 == 0 ? 2.5 : -1.0 * (i % 3), 0.1, 0)));
  }
  return scenario;
}

/// Divisions of the world to try: 0 is the shared layout, otherwise the number of solid ranks.
std::vector<int> divisions() {
  const int size = fake::size_of(MPI_COMM_WORLD);
  std::vector<int> result{0};
  if (size >= 2) result.push_back(1);
  if (size >= 3) result.push_back(2);
  return result;
}

void expect_same(const fake::Record& seen, const fake::Record& expected) {
  SCOPED_TRACE(testing::Message() << "window " << seen.window << ", body " << seen.tag);
  EXPECT_EQ(seen.state.position, expected.state.position);
  EXPECT_EQ(seen.state.velocity, expected.state.velocity);
  EXPECT_EQ(seen.state.angular_velocity, expected.state.angular_velocity);
  EXPECT_EQ(seen.state.contact_force, expected.state.contact_force);
  EXPECT_EQ(seen.applied.force, expected.applied.force);
  EXPECT_EQ(seen.applied.torque, expected.applied.torque);
}

/// Compares all that this rank saw; returns the number of solid records on all ranks.
int expect_follows(const Scenario& scenario, const Result& result, int fluid_ranks) {
  const std::vector<int>& epochs = result.has_fluid ? result.fluid.epochs : result.solid.epochs;
  EXPECT_EQ(std::accumulate(epochs.begin(), epochs.end(), 0), scenario.windows);
  const auto expected = fake::follow(scenario, epochs, fluid_ranks);
  for (const fake::Seen* seen : {&result.fluid, &result.solid}) {
    for (const fake::Record& record : seen->records) {
      const auto place = expected.find({record.window, record.tag});
      if (place == expected.end()) {
        ADD_FAILURE() << "body " << record.tag << " should not exist after window " << record.window;
        continue;
      }
      expect_same(record, place->second);
    }
  }
  int solid_records = static_cast<int>(result.solid.records.size());
  MPI_Allreduce(MPI_IN_PLACE, &solid_records, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_EQ(solid_records, static_cast<int>(expected.size()));
  return solid_records;
}

class Exchange : public testing::TestWithParam<Scheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, Exchange, testing::Values(Scheme::serial, Scheme::parallel),
                         [](const auto& parameter) {
                           return parameter.param == Scheme::serial ? "serial" : "parallel";
                         });

int fluid_ranks_of(int division) { return fake::size_of(MPI_COMM_WORLD) - division; }

TEST_P(Exchange, CrossingBodiesFollowTheLoopBitForBit) {
  Scenario scenario = crossing();
  scenario.scheme = GetParam();
  for (const int division : divisions()) {
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks_of(division));
    if (result.has_fluid) {
      EXPECT_EQ(result.fluid.counters.windows, scenario.windows);
      EXPECT_GT(result.fluid.epochs.size(), 8u) << "plans must follow the moving bodies";
    }
    int arrived = result.solid.arrived;
    MPI_Allreduce(MPI_IN_PLACE, &arrived, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    const int solid_ranks = division == 0 ? fake::size_of(MPI_COMM_WORLD) : division;
    EXPECT_EQ(arrived > 0, solid_ranks > 1) << "bodies must migrate between solid ranks for this test to say anything";
  }
}

TEST_P(Exchange, BodiesAppearAndVanishWithinAnEpoch) {
  Scenario scenario = crossing();
  scenario.scheme = GetParam();
  scenario.events.push_back({3, body(500, Vec3(3.9, 0.2, 0.3), Vec3(1, 0, 0)), true});
  scenario.events.push_back({31, body(501, Vec3(5.5, 0.2, 0.3), Vec3(-1, 0, 0)), true});
  for (const int window : {9, 23})
    scenario.events.push_back({window, scenario.bodies[static_cast<std::size_t>(window / 5)], false});
  scenario.events.push_back({40, body(500, Vec3::Zero(), Vec3::Zero()), false});
  for (const int division : divisions()) {
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks_of(division));
    int vanished = result.fluid.vanished;
    MPI_Allreduce(MPI_IN_PLACE, &vanished, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    EXPECT_GT(vanished, 0) << "the fluid must be told of a body deleted within an epoch";
  }
}

TEST_P(Exchange, SurfacePressuresComeWhenDue) {
  Scenario scenario = crossing();
  scenario.scheme = GetParam();
  scenario.windows = 20;
  scenario.pressures_every = 3;
  for (const int division : divisions()) {
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks_of(division));
  }
}

TEST_P(Exchange, CheckpointsBetweenEpochsChangeNothing) {
  Scenario scenario = crossing();
  scenario.scheme = GetParam();
  scenario.checkpoints = true;
  scenario.memory = 3000000;
  for (const int division : divisions()) {
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks_of(division));
  }
}

TEST(Checkpoint, SolidsThatCannotContinueAreRefused) {
  if (fake::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "one rank finds it, and ends the run";
  Scenario scenario;
  scenario.memory = 10;
  const auto without_memory = [](const Scenario& all, const Participants& who, MPI_Comm own, const YieldHook& yield,
                                 fake::Seen&) { SolidLink(who, own, fake::solid_terms(all), yield); };
  EXPECT_THROW(fake::run(scenario, 0, fake::run_fluid, without_memory), InputError);
}

TEST_P(Exchange, NoBodiesNoMessages) {
  Scenario scenario;
  scenario.scheme = GetParam();
  for (const int division : divisions()) {
    const Result result = fake::run(scenario, division);
    for (const fake::Seen* seen : {&result.fluid, &result.solid}) {
      EXPECT_EQ(seen->counters.messages_sent, 0);
      EXPECT_EQ(seen->counters.bytes_sent, 0);
      EXPECT_EQ(seen->counters.plan_messages_sent, 0);
      EXPECT_EQ(seen->counters.predictor_messages_sent, 0);
    }
  }
}

TEST(Messages, OnlyBetweenRanksThatTouchTheBody) {
  Scenario scenario;
  scenario.windows = 10;
  // At rest far from all borders except where the single body meets the first fluid border.
  scenario.bodies = {body(1, Vec3(0.5, 0.2, 0.3), Vec3::Zero()), body(2, Vec3(0.7, 0.2, 0.3), Vec3::Zero())};
  for (const int division : divisions()) {
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    const Result result = fake::run(scenario, division);
    const int rank = fake::rank_of(MPI_COMM_WORLD);
    if (result.has_fluid) {
      EXPECT_EQ(result.fluid.counters.messages_sent, rank == 0 ? 10 : 0);
      EXPECT_EQ(result.fluid.counters.predictor_messages_sent, 0);
      EXPECT_EQ(result.fluid.counters.bytes_sent, rank == 0 ? 10 * (8 + 2 * 7 * 8) : 0);
    }
    const int first_solid = division == 0 ? 0 : fluid_ranks_of(division);
    if (result.has_solid) {
      EXPECT_EQ(result.solid.counters.messages_sent, rank == first_solid ? 10 : 0);
    }
  }
}

TEST(Messages, ABodyAcrossABorderIsSharedByTwoFluidRanks) {
  for (const int division : divisions()) {
    const int fluid_ranks = fluid_ranks_of(division);
    if (fluid_ranks < 2) continue;
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    Scenario scenario;
    scenario.windows = 10;
    scenario.bodies = {body(1, Vec3(fake::length / fluid_ranks, 0.2, 0.3), Vec3::Zero())};
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks);
    if (!result.has_fluid) continue;
    const bool shares = fake::rank_of(MPI_COMM_WORLD) < 2;
    const std::int64_t solid_partners = result.fluid.counters.messages_sent / 10;
    EXPECT_EQ(result.fluid.counters.messages_sent % 10, 0);
    EXPECT_EQ(solid_partners > 0, shares);
    EXPECT_EQ(result.fluid.counters.predictor_messages_sent, shares ? 30 : 0) << "three sums a window, one neighbour";
  }
}

TEST(Messages, BodiesSharedByAllFluidRanksHaveTheSameSumsOnAll) {
  Scenario scenario = crossing();
  scenario.windows = 10;
  scenario.stated_reach = 2 * fake::length;
  for (const int division : divisions()) {
    SCOPED_TRACE(testing::Message() << "solid ranks " << division);
    const int fluid_ranks = fluid_ranks_of(division);
    const Result result = fake::run(scenario, division);
    expect_follows(scenario, result, fluid_ranks);
    if (!result.has_fluid) continue;
    EXPECT_EQ(result.fluid.counters.predictor_messages_sent, 3 * 10 * (fluid_ranks - 1));
  }
}

/// Runs the handshake with changed solid terms and returns the error's text of every side this rank carries.
std::vector<std::string> refused(int division, const std::function<void(SolidTerms&, int rank)>& change) {
  std::vector<std::string> errors;
  const auto catching = [&](const auto& construct) {
    try {
      construct();
    } catch (const InputError& error) {
      errors.emplace_back(error.what());
    }
  };
  fake::run(
      {}, division,
      [&](const Scenario& scenario, const Participants& who, MPI_Comm own, const YieldHook& yield, fake::Seen&) {
        catching([&] { FluidLink(who, own, fake::fluid_terms(scenario), yield); });
      },
      [&](const Scenario& scenario, const Participants& who, MPI_Comm own, const YieldHook& yield, fake::Seen&) {
        SolidTerms terms = fake::solid_terms(scenario);
        change(terms, fake::rank_of(own));
        catching([&] { SolidLink(who, own, terms, yield); });
      });
  return errors;
}

void expect_refused_everywhere(const std::function<void(SolidTerms&, int rank)>& change, const std::string& words) {
  for (const int division : divisions()) {
    const std::vector<std::string> errors = refused(division, change);
    ASSERT_EQ(errors.size(), division == 0 ? 2u : 1u);
    for (const std::string& error : errors) EXPECT_NE(error.find(words), std::string::npos) << error;
  }
}

TEST(Handshake, DifferentGravityIsRefusedOnAllRanks) {
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.gravity.z() = -9.80665; },
                            "gravity differs: the water has (0, 0, -9.81), the solids have (0, 0, -9.80665) m/s2");
}

TEST(Handshake, UnitsShapesAndSubscriptionAreChecked) {
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.units = "cgs"; }, "the solids use cgs");
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.shapes[0].size.y() = 0; }, "shape 'cube' has the size");
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.shapes[1].density = -1; },
                            "shape 'ball' has the density");
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.shapes[1].name = "cube"; },
                            "two shapes are called 'cube'");
  expect_refused_everywhere([](SolidTerms& terms, int) { terms.surface_pressure_every = -2; }, "every -2 windows");
}

TEST(Handshake, SolidRanksWithDifferentTermsAreRefused) {
  const auto change = [](SolidTerms& terms, int rank) { terms.shapes[0].density += rank; };
  for (const int division : divisions()) {
    if (division == 1 || (division == 0 && fake::size_of(MPI_COMM_WORLD) == 1)) continue;
    for (const std::string& error : refused(division, change))
      EXPECT_NE(error.find("different scripts"), std::string::npos);
  }
}

TEST(Handshake, SolidsWithoutWaterAreRefused) {
  MPI_Comm own = MPI_COMM_NULL;
  EXPECT_THROW((void)split_world(Role::solid, own), InputError);
}

TEST(Handshake, WaterAloneHasNoSolidRanks) {
  MPI_Comm own = MPI_COMM_NULL;
  Participants who = split_world(Role::fluid, own);
  EXPECT_TRUE(who.solid_ranks.empty());
  EXPECT_EQ(static_cast<int>(who.fluid_ranks.size()), fake::size_of(MPI_COMM_WORLD));
  EXPECT_THROW(FluidLink(who, own, fake::fluid_terms({})), InputError);
  release(who);
  MPI_Comm_free(&own);
}

/// The message of the InstabilityError of a run on one rank in which `disturb` changes the body after some windows.
std::string broken_by(const std::function<void(SolidBody&)>& disturb) {
  if (fake::size_of(MPI_COMM_WORLD) > 1) return {};
  const auto solid = [&](const Scenario& scenario, const Participants& who, MPI_Comm own, const YieldHook& yield,
                         fake::Seen&) {
    SolidLink link(who, own, fake::solid_terms(scenario), yield);
    std::vector<SolidBody> owned = scenario.bodies;
    while (true) {
      const Epoch epoch = link.plan(fake::slab(0, 1), owned);
      for (int i = 0; i < epoch.windows; ++i) {
        link.receive_loads();
        disturb(owned[0]);
        link.send_states(owned);
      }
    }
  };
  Scenario scenario;
  scenario.bodies = {body(3, Vec3(1, 0.2, 0.3), Vec3(0.5, 0, 0))};
  try {
    fake::run(scenario, 0, fake::run_fluid, solid);
  } catch (const InstabilityError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Instability, ABodyFasterThanTheMarginAllowsIsNamed) {
  if (fake::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "an error of one rank ends the program: on one rank";
  const std::string error = broken_by([](SolidBody& it) { it.state.position.x() += 0.07; });
  EXPECT_NE(error.find("body 3 moved 0.21 m within 3 windows"), std::string::npos) << error;
}

TEST(Instability, AStateThatIsNotANumberIsNamed) {
  if (fake::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "an error of one rank ends the program: on one rank";
  const std::string error =
      broken_by([](SolidBody& it) { it.state.position.x() = std::numeric_limits<double>::quiet_NaN(); });
  EXPECT_NE(error.find("body 3 has a state that is not a number"), std::string::npos) << error;
}

}  // namespace
}  // namespace embacle::coupling
