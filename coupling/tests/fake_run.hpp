// A fake water and fake solids that exercise the links: bodies move under loads that depend on their state in a way
// that every rank can follow, so that a run on any ranks must agree bit for bit with `follow`, a plain loop without
// messages.
#pragma once

#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "embacle/coupling/link.hpp"
#include "embacle/coupling/turnstile.hpp"

namespace embacle::coupling::fake {

inline constexpr double radius = 0.1;   // of every body [m]
inline constexpr double reach = 0.15;   // [m]
inline constexpr double length = 8.0;   // of the domain along x [m]
inline constexpr double window = 0.01;  // [s]

struct Event {
  int window = 0;  ///< number of windows completed before it happens
  SolidBody body;
  bool appears = true;
};

struct Scenario {
  Scheme scheme = Scheme::serial;
  int windows = 60;
  int pressures_every = 0;
  bool checkpoints = false;     ///< between all epochs
  int memory = 0;               ///< bytes of the checkpoint from which the run continues
  double stated_reach = reach;  ///< larger than `reach`: bodies are shared by more fluid ranks than feel them [m]
  std::vector<SolidBody> bodies;
  std::vector<Event> events;
};

/// Slab `rank` of `count` along x; the outermost are unbounded.
inline Box slab(int rank, int count) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Box box{Vec3::Constant(-infinite), Vec3::Constant(infinite)};
  if (rank > 0) box.lower.x() = length * rank / count;
  if (rank < count - 1) box.upper.x() = length * (rank + 1) / count;
  return box;
}

/// Does the water of that region feel the body?
inline bool touches(const Box& region, const State& state) { return region.distance(state.position) <= radius + reach; }

/// Partial load of fluid rank `rank` on a body: zero unless its region touches the body.
inline Load partial_load(int rank, const Box& region, const State& state, BodyTag tag) {
  if (!touches(region, state)) return {};
  Load load;
  load.force = (0.4 / (1.0 + rank)) * (Vec3(4.0, 0.1, 0.2) - state.position) - 0.01 * state.velocity;
  load.torque = Vec3(0.1 * static_cast<double>(tag), 1.0 / (3.0 + rank), 1e-3 * state.position.x());
  return load;
}

/// One window of a body's motion (unit mass and inertia).
inline void move(State& state, const Load& load) {
  state.velocity += window * load.force;
  state.angular_velocity += window * load.torque;
  state.position += window * state.velocity;
  state.contact_force = 2.0 * load.force;
}

inline void apply(const Event& event, std::map<BodyTag, SolidBody>& bodies) {
  if (event.appears) {
    bodies[event.body.tag] = event.body;
  } else {
    bodies.erase(event.body.tag);
  }
}

struct Record {
  int window = 0;  ///< windows completed
  BodyTag tag = 0;
  State state;
  Load applied;
};

/// What a side of a rank saw.
struct Seen {
  std::vector<Record> records;
  std::vector<int> epochs;  ///< windows of each epoch
  LinkCounters counters;
  int vanished = 0;
  int arrived = 0;  ///< bodies that came from another solid rank within an epoch
};

/// (windows completed, tag) -> state and load applied, without any message. `epochs`: from a run.
inline std::map<std::pair<int, BodyTag>, Record> follow(const Scenario& scenario, const std::vector<int>& epochs,
                                                        int fluid_ranks) {
  std::map<BodyTag, SolidBody> bodies;
  for (const SolidBody& body : scenario.bodies) bodies[body.tag] = body;
  std::map<std::pair<int, BodyTag>, Record> result;
  const auto loads_on = [&](const std::map<BodyTag, State>& known) {
    std::map<BodyTag, Load> loads;
    for (const auto& [tag, state] : known) {
      for (int rank = 0; rank < fluid_ranks; ++rank)
        loads[tag] += partial_load(rank, slab(rank, fluid_ranks), state, tag);
    }
    return loads;
  };
  std::map<BodyTag, Load> previous;
  int done = 0;
  for (const int windows : epochs) {
    std::map<BodyTag, State> known;  // to the water: planned, and not deleted since
    for (const auto& [tag, body] : bodies) known[tag] = body.state;
    if (done == 0) previous = loads_on(known);
    for (int i = 0; i < windows; ++i) {
      std::map<BodyTag, Load> loads = loads_on(known);
      std::map<BodyTag, Load>& used = scenario.scheme == Scheme::serial ? loads : previous;
      ++done;
      for (auto& [tag, body] : bodies) {
        move(body.state, used[tag]);
        if (known.contains(tag)) known[tag] = body.state;
        result[{done, tag}] = {done, tag, body.state, used[tag]};
      }
      previous = loads;
      for (const Event& event : scenario.events) {
        if (event.window != done) continue;
        apply(event, bodies);
        if (!event.appears) known.erase(event.body.tag);
      }
    }
  }
  return result;
}

inline FluidTerms fluid_terms(const Scenario& scenario) {
  FluidTerms terms;
  terms.gravity = Vec3(0, 0, -9.81);
  terms.scheme = scenario.scheme;
  terms.particle_distance = 0.05;
  terms.point_depth = 0.1;
  terms.reach = scenario.stated_reach;
  terms.reference_speed = 1.0;
  terms.fluid_density = 1000;
  return terms;
}

inline SolidTerms solid_terms(const Scenario& scenario) {
  SolidTerms terms;
  terms.gravity = Vec3(0, 0, -9.81);
  terms.domain = {Vec3::Zero(), Vec3(length, 1, 1)};
  terms.surface_pressure_every = scenario.pressures_every;
  terms.shapes = {{"cube", ShapeKind::box, Vec3::Constant(0.1), 900},
                  {"ball", ShapeKind::sphere, Vec3(radius, 0, 0), 900},
                  make_prism({{0, 0}, {0.3, 0}, {0.1, 0.2}}, 0.1, 900)};
  terms.shapes.back().name = "wedge";
  return terms;
}

/// What the solids give in a checkpoint, on rank 0.
inline std::vector<std::byte> memory_of(int rank, int size) {
  std::vector<std::byte> bytes(rank == 0 ? static_cast<std::size_t>(size) : 0);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::byte>(k * k + bytes.size());
  return bytes;
}

inline int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

inline int size_of(MPI_Comm comm) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  return size;
}

/// An irrational partial load, for sums whose result depends on their order.
inline Load rough_load(int rank, BodyTag tag) {
  return {Vec3(0.1, 1e9, -1e-9) / (rank + 3.0), Vec3::Constant(static_cast<double>(tag) / (rank + 7.0))};
}

/// Every rank that shares a body gets the sum in ascending rank order, bit for bit.
inline void check_sums(FluidLink& link, int rank) {
  std::vector<Load> loads;
  for (const FluidBody& body : link.bodies()) loads.push_back(rough_load(rank, body.tag));
  link.sum_over_sharers(loads);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const FluidBody& body = link.bodies()[i];
    Load expected;
    for (const int sharer : body.sharers) expected += rough_load(sharer, body.tag);
    EXPECT_EQ(loads[i].force, expected.force) << "body " << body.tag;
    EXPECT_EQ(loads[i].torque, expected.torque) << "body " << body.tag;
  }
}

inline void run_fluid(const Scenario& scenario, const Participants& who, MPI_Comm own, const YieldHook& yield,
                      Seen& seen) {
  FluidLink link(who, own, fluid_terms(scenario), yield, memory_of(rank_of(own), scenario.memory));
  EXPECT_EQ(link.solid().shapes.size(), 3u);
  EXPECT_EQ(link.solid().shapes.at(1).name, "ball");
  const Shape &wedge = link.solid().shapes.at(2), stated = solid_terms(scenario).shapes.at(2);
  EXPECT_EQ(wedge.name, "wedge");
  EXPECT_EQ(wedge.kind, ShapeKind::prism);
  EXPECT_EQ(wedge.size, stated.size);
  EXPECT_EQ(wedge.polyhedron->polygon, stated.polyhedron->polygon);
  EXPECT_EQ(wedge.polyhedron->surface.triangles(), stated.polyhedron->surface.triangles());
  EXPECT_EQ(wedge.mass_properties().inertia, stated.mass_properties().inertia);
  const int rank = rank_of(own);
  const Box region = slab(rank, size_of(own));

  const auto send = [&] {
    std::vector<Load> loads;
    std::vector<BodyPressures> pressures;
    for (const FluidBody& body : link.bodies()) {
      loads.push_back(body.vanished ? Load{} : partial_load(rank, region, body.state, body.tag));
      if (link.surface_pressures_due() && touches(region, body.state)) {
        pressures.push_back({body.tag, {10 * rank, 10 * rank + 1}, {1.0 * rank, static_cast<double>(body.tag)}});
      }
    }
    link.send_loads(loads, pressures);
  };
  int done = 0;
  for (bool first = true;; first = false) {
    const int wanted = std::min(7, scenario.windows - done);
    const Epoch epoch = link.plan(region, {.windows = wanted, .window = window, .time = done * window});
    if (epoch.windows == 0) break;
    EXPECT_FALSE(epoch.checkpoint);
    EXPECT_LE(epoch.windows, wanted);
    EXPECT_GE(link.margin(), 4 * 0.05);
    seen.epochs.push_back(epoch.windows);
    if (first && scenario.scheme == Scheme::parallel) send();
    for (int i = 0; i < epoch.windows; ++i) {
      for (int step = 0; step < 3; ++step) {  // collectives and predictor sums of the water itself
        int one = 1;
        MPI_Allreduce(MPI_IN_PLACE, &one, 1, MPI_INT, MPI_SUM, own);
        EXPECT_EQ(one, size_of(own));
        check_sums(link, rank);
      }
      send();
      link.receive_states();
      ++done;
      for (const FluidBody& body : link.bodies()) {
        if (body.vanished) {
          ++seen.vanished;
          EXPECT_EQ(body.state.velocity, Vec3::Zero().eval());
        } else {
          seen.records.push_back({done, body.tag, body.state, body.applied});
        }
      }
    }
    if (!scenario.checkpoints) continue;
    MPI_Barrier(own);
    EXPECT_EQ(link.checkpoint(region, done * window), memory_of(rank, 100000 * done));
    MPI_Barrier(own);  // as writing it
  }
  EXPECT_EQ(done, scenario.windows);
  MPI_Barrier(own);  // work after the end, as writing results
  seen.counters = link.counters();
}

/// The surface pressures of a body are the parts of all regions that touched it, in ascending rank order.
inline void check_pressures(const SolidLink& link, const std::map<BodyTag, State>& seen_by_fluid, int fluid_ranks,
                            bool due) {
  if (!due) {
    EXPECT_TRUE(link.surface_pressures().empty());
    return;
  }
  std::map<BodyTag, const BodyPressures*> received;
  for (const BodyPressures& body : link.surface_pressures()) received[body.tag] = &body;
  for (const auto& [tag, state] : seen_by_fluid) {
    ASSERT_TRUE(received.contains(tag)) << "body " << tag;
    std::vector<int> points;
    std::vector<double> pressures;
    for (int rank = 0; rank < fluid_ranks; ++rank) {
      if (!touches(slab(rank, fluid_ranks), state)) continue;
      points.insert(points.end(), {10 * rank, 10 * rank + 1});
      pressures.insert(pressures.end(), {1.0 * rank, static_cast<double>(tag)});
    }
    EXPECT_EQ(received[tag]->point, points);
    EXPECT_EQ(received[tag]->pressure, pressures);
  }
}

inline void run_solid(const Scenario& scenario, const Participants& who, MPI_Comm own, const YieldHook& yield,
                      Seen& seen) {
  if (scenario.memory > 0) {
    const SolidMemory memory = receive_memory(who, own, yield);
    EXPECT_TRUE(memory.there);
    EXPECT_EQ(memory.bytes, memory_of(rank_of(own), scenario.memory));
    MPI_Barrier(own);
  }
  SolidLink link(who, own, solid_terms(scenario), yield);
  const Box region = slab(rank_of(own), size_of(own));
  const int fluid_ranks = static_cast<int>(who.fluid_ranks.size());

  // All solid ranks exchange all bodies (by collectives of their own), and each moves those with their centre in its
  // region.
  std::map<BodyTag, SolidBody> all;
  for (const SolidBody& body : scenario.bodies) all[body.tag] = body;
  const auto owned = [&] {
    std::vector<SolidBody> here;
    for (const auto& [tag, body] : all) {
      if (region.contains(body.state.position)) here.push_back(body);
    }
    return here;
  };
  const auto migrate = [&](const std::vector<SolidBody>& moved) {
    for (auto& [tag, body] : all) {
      double numbers[13] = {};
      for (const SolidBody& mine : moved) {
        if (mine.tag != tag) continue;
        Eigen::Map<Eigen::Matrix<double, 13, 1>>(numbers) << 1.0, mine.state.position, mine.state.velocity,
            mine.state.angular_velocity, mine.state.contact_force;
      }
      MPI_Allreduce(MPI_IN_PLACE, numbers, 13, MPI_DOUBLE, MPI_SUM, own);
      ASSERT_EQ(numbers[0], 1.0) << "owners of body " << tag;
      body.state.position = Vec3(numbers + 1);
      body.state.velocity = Vec3(numbers + 4);
      body.state.angular_velocity = Vec3(numbers + 7);
      body.state.contact_force = Vec3(numbers + 10);
    }
  };

  int done = 0;
  int receptions = 0;
  std::map<BodyTag, State> seen_by_fluid;
  const auto receive = [&] {
    link.receive_loads();
    const bool due = scenario.pressures_every > 0 && receptions++ % scenario.pressures_every == 0;
    check_pressures(link, seen_by_fluid, fluid_ranks, due);
  };
  const auto advance = [&] {
    std::vector<SolidBody> moved = owned();
    ++done;
    for (SolidBody& body : moved) {
      const Load load = link.load(body.tag);
      move(body.state, load);
      seen.records.push_back({done, body.tag, body.state, load});
    }
    migrate(moved);
    for (const Event& event : scenario.events) {
      if (event.window == done) apply(event, all);
    }
    const std::vector<SolidBody> now = owned();
    for (const SolidBody& body : now) {
      const auto same = [&](const SolidBody& other) { return other.tag == body.tag; };
      if (std::none_of(moved.begin(), moved.end(), same)) ++seen.arrived;
    }
    link.send_states(now);
  };
  const auto note_states = [&] {
    seen_by_fluid.clear();
    for (const SolidBody& body : owned()) seen_by_fluid[body.tag] = body.state;
  };

  for (bool first = true;; first = false) {
    const Epoch epoch = link.plan(region, owned());
    if (epoch.checkpoint) {
      EXPECT_EQ(epoch.windows, 0);
      EXPECT_THROW((void)link.plan(region, owned()), std::logic_error);
      MPI_Barrier(own);
      link.give_memory(memory_of(rank_of(own), 100000 * done));
      EXPECT_THROW(link.give_memory({}), std::logic_error);
      std::vector<std::pair<BodyTag, Load>> loads;
      for (const auto& [tag, body] : all) {
        double numbers[6] = {};
        if (region.contains(body.state.position)) {
          const Load load = link.load(tag);
          Eigen::Map<Eigen::Matrix<double, 6, 1>>(numbers) << load.force, load.torque;
        }
        MPI_Allreduce(MPI_IN_PLACE, numbers, 6, MPI_DOUBLE, MPI_SUM, own);
        loads.push_back({tag, {Vec3(numbers), Vec3(numbers + 3)}});
      }
      link.take_up_loads(loads);
      continue;
    }
    if (epoch.windows == 0) break;
    seen.epochs.push_back(epoch.windows);
    note_states();
    if (first && scenario.scheme == Scheme::parallel) receive();
    for (int i = 0; i < epoch.windows; ++i) {
      if (scenario.scheme == Scheme::serial) {
        receive();
        advance();
      } else {
        advance();
        receive();
      }
      note_states();
    }
  }
  MPI_Barrier(own);
  seen.counters = link.counters();
}

struct Result {
  bool has_fluid = false;
  bool has_solid = false;
  Seen fluid;
  Seen solid;
};

using Run = std::function<void(const Scenario&, const Participants&, MPI_Comm, const YieldHook&, Seen&)>;

/// Runs both sides: the last `solid_ranks` ranks are solid, or, with 0, every rank carries both sides.
inline Result run(const Scenario& scenario, int solid_ranks, const Run& fluid = run_fluid,
                  const Run& solid = run_solid) {
  Result result;
  MPI_Barrier(MPI_COMM_WORLD);
  if (solid_ranks == 0) {
    MPI_Comm fluid_comm = MPI_COMM_NULL;
    MPI_Comm solid_comm = MPI_COMM_NULL;
    Participants who = share_world(fluid_comm, solid_comm);
    result.has_fluid = result.has_solid = true;
    Turnstile turnstile;
    const YieldHook yield = [&] { turnstile.yield(); };
    turnstile.run([&] { fluid(scenario, who, fluid_comm, yield, result.fluid); },
                  [&] { solid(scenario, who, solid_comm, yield, result.solid); });
    release(who);
    MPI_Comm_free(&fluid_comm);
    MPI_Comm_free(&solid_comm);
    return result;
  }
  result.has_solid = rank_of(MPI_COMM_WORLD) >= size_of(MPI_COMM_WORLD) - solid_ranks;
  result.has_fluid = !result.has_solid;
  MPI_Comm own = MPI_COMM_NULL;
  Participants who = split_world(result.has_solid ? Role::solid : Role::fluid, own);
  if (result.has_fluid) fluid(scenario, who, own, {}, result.fluid);
  if (result.has_solid) solid(scenario, who, own, {}, result.solid);
  release(who);
  MPI_Comm_free(&own);
  return result;
}

}  // namespace embacle::coupling::fake
