// Checkpoints and restarts: bit for bit on as many ranks, the same water on others, and never a damaged file.
#include <gtest/gtest.h>
#include <mpi.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>

#include "core/simulation.hpp"
#include "output/checkpoint.hpp"
#include "output/csv.hpp"
#include "scene/settings.hpp"
#include "small_scenes.hpp"

namespace embacle::mps {
namespace {

namespace fs = std::filesystem;

constexpr int epoch = 20;

int size_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// A fresh folder, the same on every rank, gone at the end of the test.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "embacle-restart-XXXXXX").string();
    if (rank_of(MPI_COMM_WORLD) == 0 && ::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create it");
    MPI_Bcast(name.data(), static_cast<int>(name.size()), MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name;
  }
  ~Folder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank_of(MPI_COMM_WORLD) == 0) fs::remove_all(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path file() const { return checkpoint_path(path_); }

 private:
  fs::path path_;
};

/// Epochs begin at multiples of their length, as in a run.
void run_until(Simulation& simulation, std::int64_t step) {
  while (simulation.counters().steps < step) {
    const int into = static_cast<int>(simulation.counters().steps % epoch);
    int windows = std::min(epoch - into, static_cast<int>(step - simulation.counters().steps));
    if (into == 0) windows = simulation.begin_epoch(windows);
    for (int w = 0; w < windows; ++w) simulation.window();
  }
}

void write(Simulation& simulation, const fs::path& path) {
  CheckpointContent content;
  simulation.confirm();
  simulation.save(content);
  write_checkpoint(simulation.comm(), path, content);
}

/// A collapsing column in 2-D; in 3-D a column behind a thin gate that rises, and a paddle that follows a table.
Scene lively_scene(int dimension) {
  Scene scene = test::collapsing_column(dimension, dimension == 3 ? 8 : 20);
  scene.numerics.rebalance_imbalance = 1.005;
  if (dimension == 2) return scene;
  Wall gate;
  gate.name = "gate";
  gate.region = {{0.08, 0, 0}, {0.09, 0.08, 0.12}};
  gate.motion.emplace();
  gate.motion->velocity = {0, 0, 1};
  Wall paddle;
  paddle.name = "paddle";
  paddle.region = {{-0.03, 0, 0}, {0, 0.08, 0.12}};
  paddle.motion.emplace();
  paddle.motion->table = {{0, {0, 0, 0}}, {0.02, {0.004, 0, 0}}, {0.05, {0, 0, 0}}};
  scene.walls.front().open = {"z+", "x-"};
  scene.walls.push_back(gate);
  scene.walls.push_back(paddle);
  return scene;
}

/// Water by id, on every rank.
std::map<std::int64_t, Record> all_water(const Simulation& simulation) {
  const MPI_Comm comm = simulation.comm();
  const Particles& particles = simulation.particles();
  std::vector<Traveller> mine(particles.water);
  for (std::size_t i = 0; i < mine.size(); ++i) mine[i] = {particles.record[i], particles.identity[i]};
  const int bytes = static_cast<int>(mine.size() * sizeof(Traveller));
  std::vector<int> counts(size_of(comm)), offsets(size_of(comm));
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  std::vector<Traveller> all((offsets.back() + counts.back()) / sizeof(Traveller));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), counts.data(), offsets.data(), MPI_BYTE, comm);
  std::map<std::int64_t, Record> result;
  for (const Traveller& traveller : all) result[traveller.identity.id] = traveller.record;
  return result;
}

bool same_bits(const Simulation& a, const Simulation& b) {
  const Particles &p = a.particles(), &q = b.particles();
  if (p.water != q.water || p.own() != q.own() || p.all() != q.all() || a.time() != b.time()) return false;
  for (std::size_t i = 0; i < p.own(); ++i) {
    if (std::memcmp(&p.record[i], &q.record[i], sizeof(Record)) != 0) return false;
    if (p.identity[i].id != q.identity[i].id || p.identity[i].owner != q.identity[i].owner) return false;
  }
  return true;
}

/// The same records, bit for bit, in whatever order they stand.
bool same_water(const Simulation& a, const Simulation& b) {
  const auto p = all_water(a), q = all_water(b);
  return std::equal(p.begin(), p.end(), q.begin(), q.end(), [](const auto& one, const auto& other) {
    return one.first == other.first && std::memcmp(&one.second, &other.second, sizeof(Record)) == 0;
  });
}

TEST(Restart, OnAsManyRanksItContinuesBitForBit) {
  for (const int dimension : {2, 3}) {
    const Folder folder;
    const Scene scene = lively_scene(dimension);
    Simulation whole(scene, MPI_COMM_WORLD, nullptr);
    run_until(whole, 153);  // amid an epoch and, as a rule, between two builds of the lists
    write(whole, folder.file());
    const CheckpointReader checkpoint(folder.file());
    Simulation continued(scene, MPI_COMM_WORLD, nullptr, &checkpoint);
    EXPECT_TRUE(same_water(whole, continued));
    for (const int step : {154, 170, 300}) {
      run_until(whole, step);
      run_until(continued, step);
      EXPECT_TRUE(same_bits(whole, continued)) << dimension << "-D, step " << step;
    }
    EXPECT_GT(whole.counters().builds, 10);
    if (size_of(MPI_COMM_WORLD) > 1) {
      EXPECT_GT(whole.counters().decompositions, 2);
    }
    EXPECT_EQ(whole.counters().builds, continued.counters().builds);
    EXPECT_EQ(whole.counters().decompositions, continued.counters().decompositions);
    EXPECT_EQ(continued.earlier_steps(), 153);
    EXPECT_EQ(whole.worst_audit().momentum_residual, continued.worst_audit().momentum_residual);
    const auto in_solids = [](const Simulation& simulation) {
      double sum = simulation.energy_in_solids();
      MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
      return sum;
    };
    EXPECT_NE(in_solids(whole), 0);
    EXPECT_NEAR(in_solids(whole), in_solids(continued), 1e-12 * std::abs(in_solids(whole)));
    const auto total = [](std::int64_t value) {
      MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
      return value;
    };
    EXPECT_EQ(total(whole.counters().pair_sweeps), total(continued.counters().pair_sweeps));
  }
}

TEST(Restart, DensitiesOfWallsContinueBitForBit) {
  const Folder folder;
  Scene scene = lively_scene(3);  // also of walls that move, and with a new decomposition now and then
  scene.numerics.wall_pressure = WallPressure::continuity;
  Simulation whole(scene, MPI_COMM_WORLD, nullptr);
  run_until(whole, 93);
  write(whole, folder.file());
  const CheckpointReader checkpoint(folder.file());
  EXPECT_GT(checkpoint.rows("wall_density"), 50);
  Simulation continued(scene, MPI_COMM_WORLD, nullptr, &checkpoint);
  for (const int step : {94, 110, 200}) {
    run_until(whole, step);
    run_until(continued, step);
    EXPECT_TRUE(same_bits(whole, continued)) << "step " << step;
  }
}

TEST(Restart, TheSymplecticIntegratorContinuesBitForBit) {
  const Folder folder;
  Scene scene = lively_scene(3);
  scene.numerics.integrator = Integrator::symplectic;
  Simulation whole(scene, MPI_COMM_WORLD, nullptr);
  run_until(whole, 93);
  write(whole, folder.file());
  const CheckpointReader checkpoint(folder.file());
  Simulation continued(scene, MPI_COMM_WORLD, nullptr, &checkpoint);
  for (const int step : {94, 200}) {
    run_until(whole, step);
    run_until(continued, step);
    EXPECT_TRUE(same_bits(whole, continued)) << "step " << step;
  }
}

TEST(Restart, WaterThatEntersAndLeavesContinuesBitForBit) {
  for (const int dimension : {2, 3}) {
    const Folder folder;
    const Scene scene = test::reach(dimension);
    Simulation whole(scene, MPI_COMM_WORLD, nullptr);
    run_until(whole, 153);
    write(whole, folder.file());
    const CheckpointReader checkpoint(folder.file());
    Simulation continued(scene, MPI_COMM_WORLD, nullptr, &checkpoint);
    for (const int step : {154, 250, 400}) {
      run_until(whole, step);
      run_until(continued, step);
      EXPECT_TRUE(same_bits(whole, continued)) << dimension << "-D, step " << step;
    }
    const auto passed = whole.openings()->passages(), again = continued.openings()->passages();
    EXPECT_GT(passed[1].volume, 0);
    for (std::size_t k = 0; k < passed.size(); ++k) EXPECT_EQ(passed[k].volume, again[k].volume);
  }
}

/// Writes on `from`, continues by one step on `from` and on `to`, which must hold the same water. A rank that is in
/// neither looks on.
void compare_after_a_step(const Scene& scene, MPI_Comm from, MPI_Comm to) {
  const Folder folder;
  std::map<std::int64_t, Record> expected;
  if (from != MPI_COMM_NULL) {
    Simulation whole(scene, from, nullptr);
    run_until(whole, 153);
    write(whole, folder.file());
    run_until(whole, 154);
    expected = all_water(whole);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  if (to == MPI_COMM_NULL || from == MPI_COMM_NULL) {
    if (to == MPI_COMM_NULL) return;
    const CheckpointReader checkpoint(folder.file());
    Simulation continued(scene, to, nullptr, &checkpoint);
    run_until(continued, 154);
    (void)all_water(continued);
    return;
  }
  const CheckpointReader checkpoint(folder.file());
  Simulation continued(scene, to, nullptr, &checkpoint);
  run_until(continued, 154);
  const auto found = all_water(continued);
  ASSERT_EQ(found.size(), expected.size());
  double largest[3] = {}, difference[3] = {};  // of places, velocities and pressures
  for (const auto& [id, record] : expected) {
    ASSERT_TRUE(found.contains(id));
    const Record& other = found.at(id);
    const auto compare = [&](int what, double a, double b) {
      largest[what] = std::max(largest[what], std::abs(a));
      difference[what] = std::max(difference[what], std::abs(a - b));
    };
    for (int c = 0; c < 3; ++c) {
      compare(0, record.x[c], other.x[c]);
      compare(1, record.v[c], other.v[c]);
    }
    compare(2, record.p, other.p);
  }
  for (int what = 0; what < 3; ++what) {
    EXPECT_GT(largest[what], 0);
    EXPECT_LE(difference[what], 1e-12 * largest[what]) << what;
  }
}

TEST(Restart, OnOtherRanksTheWaterIsTheSame) {
  const int size = size_of(MPI_COMM_WORLD), rank = rank_of(MPI_COMM_WORLD);
  MPI_Comm fewer = MPI_COMM_NULL, alone = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, rank < size - 1 ? 0 : MPI_UNDEFINED, rank, &fewer);
  MPI_Comm_split(MPI_COMM_WORLD, rank == 0 ? 0 : MPI_UNDEFINED, rank, &alone);
  for (const int dimension : {2, 3}) {
    for (const Scene& scene : {lively_scene(dimension), test::reach(dimension)}) {
      compare_after_a_step(scene, MPI_COMM_WORLD, alone);                // 3 -> 1, 2 -> 1
      if (size > 1) compare_after_a_step(scene, fewer, MPI_COMM_WORLD);  // 2 -> 3, 1 -> 2
    }
  }
  for (MPI_Comm comm : {fewer, alone}) {
    if (comm != MPI_COMM_NULL) MPI_Comm_free(&comm);
  }
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Checkpoint, TheOneBeforeIsKept) {
  const Folder folder;
  const Scene scene = test::collapsing_column(2, 10);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  std::vector<double> times;
  for (const int step : {5, 10, 15}) {
    run_until(simulation, step);
    write(simulation, folder.file());
    times.push_back(simulation.time());
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(CheckpointReader(folder.file()).number("time"), times[2]);
  EXPECT_EQ(CheckpointReader(folder.file().parent_path()).number("time"), times[2]);
  EXPECT_EQ(CheckpointReader(previous_checkpoint(folder.file())).number("time"), times[1]);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank_of(MPI_COMM_WORLD) == 0) fs::remove(folder.file());
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(CheckpointReader(folder.file().parent_path()).number("time"), times[1]);
}

TEST(Checkpoint, AWriteThatFailsLeavesTheOneBefore) {
  const Folder folder;
  const Scene scene = test::collapsing_column(2, 20);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run_until(simulation, 5);
  write(simulation, folder.file());
  const std::string before = bytes_of(folder.file());
  run_until(simulation, 10);
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit narrow{before.size() / 2, unlimited.rlim_max};
  const int size = size_of(MPI_COMM_WORLD);
  if (rank_of(MPI_COMM_WORLD) == size - 1) setrlimit(RLIMIT_FSIZE, &narrow);
  try {
    write(simulation, folder.file());
    ADD_FAILURE() << "a write beyond the limit went unnoticed";
  } catch (const coupling::SystemError& error) {
    EXPECT_NE(std::string(error.what()).find("checkpoint.h5"), std::string::npos) << error.what();
  }
  setrlimit(RLIMIT_FSIZE, &unlimited);
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_EQ(bytes_of(folder.file()), before);
  EXPECT_FALSE(fs::exists(folder.file().string() + ".part"));
  MPI_Barrier(MPI_COMM_WORLD);
  write(simulation, folder.file());
  EXPECT_EQ(CheckpointReader(folder.file()).count("steps"), 10);
}

TEST(Checkpoint, WhatIsNoWholeCheckpointIsRefused) {
  const Folder folder;
  const Scene scene = test::collapsing_column(2, 10);
  EXPECT_THROW(CheckpointReader(folder.file()), coupling::InputError);
  EXPECT_THROW(CheckpointReader(folder.file().parent_path()), coupling::InputError);
  Simulation simulation(scene, MPI_COMM_WORLD, nullptr);
  run_until(simulation, 5);
  write(simulation, folder.file());
  MPI_Barrier(MPI_COMM_WORLD);
  const std::string whole = bytes_of(folder.file());
  MPI_Barrier(MPI_COMM_WORLD);
  for (const std::size_t length : {std::size_t{0}, std::size_t{100}, whole.size() / 2, whole.size() * 3 / 4}) {
    if (rank_of(MPI_COMM_WORLD) == 0) std::ofstream(folder.file(), std::ios::binary) << whole.substr(0, length);
    MPI_Barrier(MPI_COMM_WORLD);
    EXPECT_THROW(CheckpointReader(folder.file()), coupling::InputError) << length;
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

TEST(Settings, WhatDiffersIsNamed) {
  const Scene before = lively_scene(3);
  const auto message = [&](const Scene& now) -> std::string {
    try {
      compare_settings(now, lasting_settings(now), lasting_settings(before), "run/checkpoint.h5");
    } catch (const coupling::InputError& error) {
      return error.what();
    }
    return {};
  };
  const auto expect = [&](const Scene& now, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      EXPECT_NE(message(now).find(word), std::string::npos) << word << " is not in: " << message(now);
  };
  Scene now = before;
  now.title = "another";
  now.end_time = 7;
  now.output.fields_every = 0.1;
  now.numerics.rebalance_imbalance = 2;
  now.gauges.emplace_back();
  EXPECT_EQ(message(now), "");
  now.numerics.particle_distance = 0.02;
  now.numerics.kernel = KernelKind::rational;
  expect(now, {"run/checkpoint.h5", "numerics.particle_distance = 0.02 (then: 0.01)",
               "numerics.kernel = rational (then: wendland)"});
  now = before;
  now.walls[2].motion->table[1].second[0] = 0.005;
  expect(now, {"wall.paddle.motion.table = 3 rows, checksum", "then: 3 rows"});
  now = before;
  now.walls.pop_back();
  expect(now, {"wall.paddle.lower: not there (then: [-0.03, 0, 0])"});
  now = before;
  std::swap(now.walls[1], now.walls[2]);
  expect(now, {"order"});
}

TEST(Csv, ATableIsContinuedFromATime) {
  const Folder folder;
  if (rank_of(MPI_COMM_WORLD) != 0) return;
  const fs::path path = folder.file().parent_path() / "table.csv";
  const std::vector<std::string> columns{"t [s]", "x [m]"};
  {
    CsvWriter table(path, columns);
    for (const double t : {0.0, 0.1, 0.2, 0.3}) table.row(std::vector<double>{t, 2 * t});
  }
  std::ofstream(path, std::ios::app) << "0.4,0.";  // cut by the end of the run
  CsvWriter(path, columns, 0.2).row(std::vector<double>{0.25, 7});
  EXPECT_EQ(bytes_of(path), "t [s],x [m]\n0,0\n0.1,0.2\n0.2,0.4\n0.25,7\n");
  std::ofstream(path, std::ios::app) << "0.3";
  CsvWriter(path, columns, 5).row(std::vector<double>{6, 7});
  EXPECT_EQ(bytes_of(path), "t [s],x [m]\n0,0\n0.1,0.2\n0.2,0.4\n0.25,7\n6,7\n");
  EXPECT_THROW(CsvWriter(path, {"t [s]", "level [m]"}, 0.2), coupling::InputError);
  CsvWriter(path.parent_path() / "new.csv", columns, 0.2).row(std::vector<double>{0.3, 1});
  EXPECT_EQ(bytes_of(path.parent_path() / "new.csv"), "t [s],x [m]\n0.3,1\n");
}

}  // namespace
}  // namespace embacle::mps
