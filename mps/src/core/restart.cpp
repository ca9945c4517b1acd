// What a checkpoint holds of the simulation and of the recorder, and how they continue from one.
#include <algorithm>
#include <cstring>
#include <sstream>
#include <unordered_map>

#include "core/filling.hpp"
#include "core/recorder.hpp"
#include "core/simulation.hpp"

namespace embacle::mps {

namespace {

constexpr std::size_t record_width = sizeof(Record) / sizeof(double);
static_assert(record_width == 8,
              "a particle's record has changed: is `record_columns` right, and does a checkpoint of "
              "an older version still say what it said? (format_version in checkpoint.cpp)");
constexpr const char* record_columns = "x y z [m], vx vy vz [m/s], p [Pa], rho/rho0 [-]";

/// The own water as tables `water_state` and `water_identity`.
void add_water(CheckpointContent& content, const Particles& particles) {
  std::vector<double> state;
  std::vector<std::int64_t> identity;
  state.reserve(record_width * particles.water);
  for (std::size_t i = 0; i < particles.water; ++i) {
    const auto* record = reinterpret_cast<const double*>(&particles.record[i]);
    state.insert(state.end(), record, record + record_width);
    identity.push_back(particles.identity[i].id);
  }
  content.tables.push_back({"water_state", record_columns, record_width, std::move(state)});
  content.tables.push_back({"water_identity", "id", 1, std::move(identity)});
}

std::vector<Traveller> read_water(const CheckpointReader& checkpoint, std::int64_t first, std::int64_t count) {
  std::vector<double> state(record_width * count);
  std::vector<std::int64_t> identity(count);
  checkpoint.read("water_state", first, count, state);
  checkpoint.read("water_identity", first, count, identity);
  std::vector<Traveller> result(count);
  for (std::int64_t i = 0; i < count; ++i) {
    std::copy_n(&state[record_width * i], record_width, reinterpret_cast<double*>(&result[i].record));
    result[i].identity.id = identity[i];
  }
  return result;
}

/// What the solids gave as a table of numbers of eight bytes each.
void add_solids(CheckpointContent& content, const std::vector<std::byte>& memory) {
  std::vector<std::int64_t> numbers((memory.size() + 7) / 8);
  if (!memory.empty()) std::memcpy(numbers.data(), memory.data(), memory.size());
  content.counts["solid_bytes"] = static_cast<std::int64_t>(memory.size());
  content.tables.push_back({"solids", "a restart file of LIGGGHTS, solid_bytes long", 1, std::move(numbers)});
}

std::vector<double> gathered(double value, MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  std::vector<double> all(size);
  MPI_Allgather(&value, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, comm);
  return all;
}

}  // namespace

/// The lists are made anew in the next step, here and after a restart: then all sums run in the same order. With bodies
/// an epoch begins then, which may share the water out anew, by the lists: here instead, where they still are those of
/// the last step.
void Simulation::save(CheckpointContent& content) {
  if (link_ != nullptr) {
    if (uneven()) decompose();
    add_solids(content, link_->checkpoint(decomposition_.own(), time_));
    double deepest = extremes_.body_penetration;
    MPI_Allreduce(MPI_IN_PLACE, &deepest, 1, MPI_DOUBLE, MPI_MAX, comm_);
    content.numbers["body_penetration"] = deepest;
  }
  just_saved_ = true;
  lists_valid_ = false;
  if (openings_) openings_->hasten();
  int size = 1;
  MPI_Comm_size(comm_, &size);
  content.numbers["time"] = time_;
  content.numbers["imbalance"] = imbalance_;
  content.numbers["imbalance_evened"] = evened_imbalance_;
  content.numbers["audit_reaction_mismatch"] = worst_audit_.reaction_mismatch;
  content.numbers["audit_momentum_residual"] = worst_audit_.momentum_residual;
  double energies[3] = {energy_in_solids_, power_into_solids_, work_on_bodies_};
  MPI_Allreduce(MPI_IN_PLACE, energies, 3, MPI_DOUBLE, MPI_SUM, comm_);
  content.numbers["energy_in_solids"] = energies[0];
  content.numbers["power_into_solids"] = energies[1];
  content.numbers["work_on_bodies"] = energies[2];
  double extremes[3] = {extremes_.speed, extremes_.compression, extremes_.pressure};
  MPI_Allreduce(MPI_IN_PLACE, extremes, 3, MPI_DOUBLE, MPI_MAX, comm_);
  content.numbers["extreme_speed"] = extremes[0];
  content.numbers["extreme_compression"] = extremes[1];
  content.numbers["extreme_pressure"] = extremes[2];
  double motions[3] = {own_motions_.water, own_motions_.bodies, own_motions_.acceleration};
  MPI_Allreduce(MPI_IN_PLACE, motions, 3, MPI_DOUBLE, MPI_MAX, comm_);
  content.lists["motions"].assign(motions, motions + 3);
  content.numbers["shortest_step"] = extremes_.shortest_step;
  content.numbers["imbalance_largest"] = extremes_.imbalance;
  content.numbers["imbalance_met"] = extremes_.imbalance_met;
  content.lists["limited_steps"].assign(counters_.limited_steps.begin(), counters_.limited_steps.end());
  content.counts["windows"] = counters_.windows;
  content.counts["steps"] = counters_.steps;
  content.counts["builds"] = counters_.builds;
  content.counts["decompositions"] = counters_.decompositions;
  content.counts["removed_at_start"] = removed_at_start_;
  content.counts["displaced_by_arrivals"] = displaced_by_arrivals_;
  content.counts["newest_tag"] = newest_tag_;
  std::int64_t sums[3] = {counters_.water_updates, counters_.particle_updates, counters_.pair_sweeps};
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_INT64_T, MPI_SUM, comm_);
  content.counts["water_updates"] = sums[0];
  content.counts["particle_updates"] = sums[1];
  content.counts["pair_sweeps"] = sums[2];
  auto seconds = phases_.all();
  MPI_Allreduce(MPI_IN_PLACE, seconds.data(), static_cast<int>(seconds.size()), MPI_DOUBLE, MPI_SUM, comm_);
  for (double& value : seconds) value /= size;
  content.lists["phase_seconds_mean_per_rank"].assign(seconds.begin(), seconds.end());
  std::string warnings;
  for (const std::string& warning : warnings_) warnings += warning + "\n";
  content.texts["warnings"] = warnings;

  auto& boxes = content.lists["boxes"];
  for (const Box& box : decomposition_.boxes()) {
    boxes.insert(boxes.end(), box.lower.begin(), box.lower.end());
    boxes.insert(boxes.end(), box.upper.begin(), box.upper.end());
  }
  if (openings_) content.lists["openings"] = openings_->save();
  content.lists["water_of_rank"] = gathered(static_cast<double>(particles_.water), comm_);
  add_water(content, particles_);
  if (!wall_density_) return;
  wall_density_->keep(particles_);
  content.counts["wall_density_started"] = wall_density_->started() ? 1 : 0;
  std::vector<double> rows;
  for (std::size_t k = 0; k < wall_points_.size(); ++k) {
    if (wall_density_->of(k) == 1) continue;
    rows.push_back(static_cast<double>(wall_points_[k].identity.id));
    rows.push_back(wall_density_->of(k));
  }
  content.tables.push_back({"wall_density", "id, rho/rho0 [-] of wall points where it is not 1", 2, std::move(rows)});
}

std::vector<std::byte> solid_memory(const CheckpointReader& checkpoint) {
  const std::int64_t count = checkpoint.rows("solids");
  std::vector<std::int64_t> numbers(count);
  checkpoint.read("solids", 0, count, numbers);
  std::vector<std::byte> memory(checkpoint.count("solid_bytes"));
  if (memory.size() > 8 * numbers.size())
    throw coupling::InputError(checkpoint.path().string() + ": is damaged: the solids are incomplete");
  if (!memory.empty()) std::memcpy(memory.data(), numbers.data(), memory.size());
  return memory;
}

/// Every rank reads the densities of all wall points, and takes those of its own.
void Simulation::restore_wall_density(const CheckpointReader& checkpoint) {
  const std::int64_t count = checkpoint.rows("wall_density");
  std::vector<double> rows(2 * count);
  checkpoint.read("wall_density", 0, count, rows);
  std::unordered_map<std::int64_t, double> density;
  for (std::int64_t i = 0; i < count; ++i) density[static_cast<std::int64_t>(rows[2 * i])] = rows[2 * i + 1];
  std::vector<double> stored(wall_points_.size(), 1.0);
  for (std::size_t k = 0; k < stored.size(); ++k) {
    const auto found = density.find(wall_points_[k].identity.id);
    if (found != density.end()) stored[k] = found->second;
  }
  wall_density_->restart(std::move(stored), checkpoint.count("wall_density_started") != 0);
}

/// On as many ranks as before, each takes its own part of space and its own water; on another number of ranks the water
/// is shared out anew. Walls come from the scene.
void Simulation::restore(const CheckpointReader& checkpoint) {
  int size = 1;
  MPI_Comm_size(comm_, &size);
  const std::vector<double> water_of_rank = checkpoint.list("water_of_rank");
  const bool same_ranks = static_cast<int>(water_of_rank.size()) == size;
  const std::int64_t rows = checkpoint.rows("water_state");
  std::int64_t first = rows * rank_ / size, end = rows * (rank_ + 1) / size;
  if (same_ranks) {
    first = 0;
    for (int r = 0; r < rank_; ++r) first += static_cast<std::int64_t>(water_of_rank[r]);
    end = first + static_cast<std::int64_t>(water_of_rank[rank_]);
  }
  time_ = checkpoint.number("time");
  particles_.assign(read_water(checkpoint, first, end - first));
  adopt_walls(wall_points_of(walls_, rank_, size));
  if (wall_density_) restore_wall_density(checkpoint);
  if (same_ranks) {
    const std::vector<double> numbers = checkpoint.list("boxes");
    std::vector<Box> boxes(size);
    if (numbers.size() != 6 * boxes.size())
      throw coupling::InputError(checkpoint.path().string() + ": is damaged: the ranks' boxes are incomplete");
    for (int r = 0; r < size; ++r) {
      std::copy_n(&numbers[6 * r], 3, boxes[r].lower.begin());
      std::copy_n(&numbers[6 * r + 3], 3, boxes[r].upper.begin());
    }
    decomposition_.adopt(std::move(boxes));
  } else {
    place_wall_points(time_);
    decompose();
  }
  anywhere_ = true;
  find_neighbours(time_);
  lists_valid_ = false;            // as after the checkpoint
  if (!scene_.openings.empty()) {  // not before: what has to enter or leave does so in the next step
    openings_.emplace(scene_, constants_, walls_, comm_);
    openings_->restore(checkpoint.list("openings"));
  }
  started_ = true;
  just_saved_ = true;

  imbalance_ = checkpoint.number("imbalance");
  evened_imbalance_ = checkpoint.number("imbalance_evened");
  worst_audit_ = {checkpoint.number("audit_reaction_mismatch"), checkpoint.number("audit_momentum_residual")};
  if (rank_ == 0) {
    energy_in_solids_ = checkpoint.number("energy_in_solids");
    power_into_solids_ = checkpoint.number("power_into_solids");
    work_on_bodies_ = checkpoint.number("work_on_bodies");
  }
  extremes_.speed = checkpoint.number("extreme_speed");
  extremes_.compression = checkpoint.number("extreme_compression");
  extremes_.pressure = checkpoint.number("extreme_pressure");
  if (link_ != nullptr) extremes_.body_penetration = checkpoint.number("body_penetration");
  const std::vector<double> motions = checkpoint.list("motions");
  if (motions.size() == 3) own_motions_ = motions_ = {motions[0], motions[1], motions[2]};
  extremes_.shortest_step = checkpoint.number("shortest_step");
  extremes_.imbalance = checkpoint.number("imbalance_largest");
  extremes_.imbalance_met = checkpoint.number("imbalance_met");
  const std::vector<double> limited = checkpoint.list("limited_steps");
  for (std::size_t k = 0; k < std::min(limited.size(), counters_.limited_steps.size()); ++k)
    counters_.limited_steps[k] = static_cast<std::int64_t>(limited[k]);
  counters_.windows = checkpoint.count("windows");
  counters_.steps = earlier_steps_ = checkpoint.count("steps");
  counters_.builds = checkpoint.count("builds");
  counters_.decompositions = checkpoint.count("decompositions") + (same_ranks ? 0 : 1);
  removed_at_start_ = checkpoint.count("removed_at_start");
  displaced_by_arrivals_ = checkpoint.count("displaced_by_arrivals");
  newest_tag_ = checkpoint.count("newest_tag");
  if (rank_ == 0) {  // sums over the ranks
    counters_.water_updates = checkpoint.count("water_updates");
    counters_.particle_updates = checkpoint.count("particle_updates");
    counters_.pair_sweeps = checkpoint.count("pair_sweeps");
  }
  const std::vector<double> seconds = checkpoint.list("phase_seconds_mean_per_rank");
  for (std::size_t k = 0; k < std::min(seconds.size(), phases_.all().size()); ++k) phases_.add(k, seconds[k]);
  std::istringstream warnings(checkpoint.text("warnings"));
  for (std::string line; std::getline(warnings, line);) warnings_.push_back(line);
}

// ---------------------------------------------------------------------------------------------------------------------

void Recorder::save(CheckpointContent& content) const {
  content.counts["start_particles"] = start_.particles;
  content.counts["most_outside"] = most_outside_;
  content.counts["most_inside"] = most_inside_;
  content.numbers["start_mass"] = start_.mass;
  content.numbers["start_kinetic"] = start_.energy.kinetic;
  content.numbers["start_potential"] = start_.energy.potential;
  content.numbers["start_elastic"] = start_.energy.elastic;
  content.numbers["start_bodies"] = start_.energy.bodies;
  content.numbers["start_volume_ratio"] = start_.volume_ratio;
  content.numbers["largest_energy_gain"] = largest_energy_gain_;
  content.numbers["lowest_energy"] = lowest_energy_;
  content.numbers["largest_energy_rise"] = largest_energy_rise_;
  content.numbers["compressed_share"] = compressed_share_;
  content.numbers["compressed_at"] = compressed_at_;
  content.numbers["deepest_in_body"] = deepest_;
  content.numbers["wall_seconds"] = earlier_seconds_ + MPI_Wtime() - began_;
  content.numbers["newest_listed"] = newest_listed_;
  content.lists["restart_times"] = restart_times_;
  auto& times = content.lists["frame_times"];
  auto& steps = content.lists["frame_steps"];
  auto& particles = content.lists["frame_particles"];
  if (!fields_) return;
  for (const FrameRecord& frame : fields_->records()) {
    times.push_back(frame.time);
    steps.push_back(static_cast<double>(frame.step));
    particles.push_back(static_cast<double>(frame.particles));
  }
}

void Recorder::restore(const CheckpointReader& checkpoint) {
  std::error_code ignored;
  const bool same_folder =
      std::filesystem::equivalent(folder_, std::filesystem::absolute(checkpoint.path()).parent_path(), ignored);
  const double time = simulation_.time();
  const double tolerance = 0.5 * simulation_.window_length();
  std::vector<FrameRecord> frames;
  const auto times = checkpoint.list("frame_times"), steps = checkpoint.list("frame_steps"),
             particles = checkpoint.list("frame_particles");
  if (same_folder) {
    for (std::size_t i = 0; i < times.size(); ++i)
      frames.push_back({times[i], static_cast<std::int64_t>(steps[i]), static_cast<std::int64_t>(particles[i])});
  }
  open_files(same_folder ? std::optional(time) : std::nullopt, std::move(frames));
  for (Clock* clock :
       {&fields_clock_, &bodies_clock_, &gauges_clock_, &structures_clock_, &openings_clock_, &energies_clock_})
    clock->skip(time, tolerance);
  if (simulation_.openings() != nullptr) {
    for (const Openings::Passage& passage : simulation_.openings()->passages()) passed_.push_back(passage.volume);
    passed_at_ = time;
  }
  const auto& pictures = scene_.output.pictures;
  while (next_picture_ < pictures.size() && time + tolerance >= pictures[next_picture_]) ++next_picture_;

  start_.particles = checkpoint.count("start_particles");
  start_.mass = checkpoint.number("start_mass");
  start_.energy = {checkpoint.number("start_kinetic"), checkpoint.number("start_potential"),
                   checkpoint.number("start_elastic"), 0,
                   checkpoint.number("start_bodies"),  0};
  start_.volume_ratio = checkpoint.number("start_volume_ratio");
  most_outside_ = checkpoint.count("most_outside");
  most_inside_ = checkpoint.count("most_inside");
  deepest_ = checkpoint.number("deepest_in_body");
  newest_listed_ = checkpoint.number("newest_listed");
  largest_energy_gain_ = checkpoint.number("largest_energy_gain");
  lowest_energy_ = checkpoint.number("lowest_energy");
  largest_energy_rise_ = checkpoint.number("largest_energy_rise");
  compressed_share_ = checkpoint.number("compressed_share");
  compressed_at_ = checkpoint.number("compressed_at");
  earlier_seconds_ = checkpoint.number("wall_seconds");
  restart_times_ = checkpoint.list("restart_times");
  restart_times_.push_back(time);
  began_at_ = time;
  measure_end();
  write_stage();
}

void Recorder::measure_end() { now_ = measure(simulation_, scene_); }

}  // namespace embacle::mps
