#include "core/recorder.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace embacle::mps {

namespace {

/// Share of the water whose density may be off by more than 1 % before the summary warns.
constexpr double most_compressed = 0.05;

double or_else(double value, double fallback) { return value > 0 ? value : fallback; }

/// All ranks' values one after the other, on the first rank; empty on the others. Collective.
std::vector<double> gather_on_first(const std::vector<double>& values, MPI_Comm comm) {
  int rank = 0, size = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  std::vector<int> counts(size), offsets(size);
  const int mine = static_cast<int>(values.size());
  MPI_Gather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, comm);
  for (int r = 1; r < size; ++r) offsets[r] = offsets[r - 1] + counts[r - 1];
  std::vector<double> all(rank == 0 ? offsets[size - 1] + counts[size - 1] : 0);
  MPI_Gatherv(values.data(), mine, MPI_DOUBLE, all.data(), counts.data(), offsets.data(), MPI_DOUBLE, 0, comm);
  return all;
}

Json::Array array_of(const Vec3d& v) { return {v[0], v[1], v[2]}; }

/// Of a wall, for pictures: beyond, the box around it has to do.
constexpr std::size_t most_triangles = 50000;

/// Nine numbers.
template <class Corners>
void append(Json::Array& numbers, const Corners& triangle) {
  for (const auto& corner : triangle) numbers.insert(numbers.end(), corner.begin(), corner.end());
}

}  // namespace

Recorder::Recorder(const Scene& scene, Simulation& simulation, std::filesystem::path folder,
                   const CheckpointReader* restart)
    : scene_(scene), simulation_(simulation), folder_(std::move(folder)), began_(MPI_Wtime()) {
  MPI_Comm_rank(simulation.comm(), &rank_);
  const double end = scene.end_time;
  fields_clock_.every = or_else(scene.output.fields_every, end);
  bodies_clock_.every = or_else(scene.output.bodies_every, end / 1500);
  gauges_clock_.every = or_else(scene.output.gauges_every, end / 1000);
  openings_clock_.every = structures_clock_.every = gauges_clock_.every;
  energies_clock_.every = or_else(scene.output.energies_every, end / 100);
  if (restart != nullptr) {
    restore(*restart);
  } else {
    open_files(std::nullopt, {});
  }
}

void Recorder::open_files(std::optional<double> keep_until, std::vector<FrameRecord> earlier_frames) {
  const Simulation& simulation = simulation_;
  if (scene_.output.fields) {
    fields_ = std::make_unique<FieldWriter>(simulation.comm(), folder_, std::move(earlier_frames));
  }
  if (rank_ == 0) {
    std::vector<std::string> columns = {"t [s]",
                                        "kinetic [J]",
                                        "potential [J]",
                                        "elastic [J]",
                                        "total [J]",
                                        "mass [kg]",
                                        "px [N s]",
                                        "py [N s]",
                                        "pz [N s]",
                                        "volume ratio [-]",
                                        "outside tank [-]",
                                        "inside bodies [-]",
                                        "deepest in body [m]",
                                        "farthest outside tank [m]"};
    if (simulation.bodies() != nullptr) columns.insert(columns.end(), {"bodies [J]", "work on bodies [J]"});
    if (scene_.output.audit) columns.emplace_back("in solids [J]");
    energies_ = std::make_unique<CsvWriter>(folder_ / "energies.csv", columns, keep_until);
    if (simulation.bodies() != nullptr) {
      bodies_ = std::make_unique<CsvWriter>(
          folder_ / "bodies.csv",
          std::vector<std::string>{"t [s]",      "tag [-]",    "x [m]",      "y [m]",    "z [m]",    "qw [-]",
                                   "qx [-]",     "qy [-]",     "qz [-]",     "vx [m/s]", "vy [m/s]", "vz [m/s]",
                                   "wx [rad/s]", "wy [rad/s]", "wz [rad/s]", "fx [N]",   "fy [N]",   "fz [N]",
                                   "tx [N m]",   "ty [N m]",   "tz [N m]"},
          keep_until);
    }
    if (simulation.bodies() != nullptr) {
      arrivals_ = std::make_unique<CsvWriter>(folder_ / "arrivals.csv",
                                              std::vector<std::string>{"t [s]", "tag [-]", "shape [-]"}, keep_until);
    }
    for (const Wall& wall : scene_.walls) {
      if (!wall.forces) continue;
      structures_.push_back(std::make_unique<CsvWriter>(
          folder_ / "structures" / (wall.name + ".csv"),
          std::vector<std::string>{"t [s]", "fx [N]", "fy [N]", "fz [N]", "tx [N m]", "ty [N m]", "tz [N m]"},
          keep_until));
    }
    for (const Opening& opening : scene_.openings) {
      openings_.push_back(std::make_unique<CsvWriter>(
          folder_ / "openings" / (opening.name + ".csv"),
          std::vector<std::string>{"t [s]", "discharge [m3/s]", "level [m]", "speed [m/s]", "volume [m3]"},
          keep_until));
    }
    for (const Gauge& gauge : scene_.gauges) {
      const char* column = gauge.kind == GaugeKind::pressure ? "pressure [Pa]"
                           : gauge.kind == GaugeKind::level  ? "level [m]"
                                                             : "front [m]";
      gauges_.push_back(std::make_unique<CsvWriter>(folder_ / "gauges" / (gauge.name + ".csv"),
                                                    std::vector<std::string>{"t [s]", column}, keep_until));
    }
  }
}

void Recorder::record(bool last) {
  const Phases::Timer timer(simulation_.phases(), Phase::output);
  const double time = simulation_.time();
  const double tolerance = 0.5 * simulation_.window_length();
  const auto& pictures = scene_.output.pictures;
  bool picture = false;
  while (next_picture_ < pictures.size() && time + tolerance >= pictures[next_picture_]) {
    picture = true;
    ++next_picture_;
  }
  if (fields_ && (fields_clock_.due(time, tolerance) || picture || last)) write_fields();
  if (simulation_.bodies() != nullptr && (bodies_clock_.due(time, tolerance) || last)) write_bodies();
  if (simulation_.structures() != nullptr && (structures_clock_.due(time, tolerance) || last)) write_structures();
  if (!scene_.openings.empty() && (openings_clock_.due(time, tolerance) || last)) write_openings();
  if (!scene_.gauges.empty() && (gauges_clock_.due(time, tolerance) || last)) write_gauges();
  if (energies_clock_.due(time, tolerance) || last) write_energies();
  show_progress(last);
}

void Recorder::write_fields() {
  const Particles& particles = simulation_.particles();
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t i = 0; i < particles.water; ++i) chosen.push_back(i);
  const auto& wet = simulation_.neighbours().wet_points();
  chosen.insert(chosen.end(), wet.begin(), wet.end());
  std::vector<float> position, velocity, pressure;
  std::vector<std::int8_t> type;
  std::vector<std::int32_t> tag;
  for (const std::uint32_t i : chosen) {
    const Record& record = particles.record[i];
    for (int c = 0; c < 3; ++c) {
      position.push_back(static_cast<float>(record.x[c]));
      velocity.push_back(static_cast<float>(record.v[c]));
    }
    pressure.push_back(static_cast<float>(record.p));
    const Identity& identity = particles.identity[i];
    const bool body = identity.owner >= simulation_.walls().count();
    type.push_back(static_cast<std::int8_t>(i < particles.water ? 0 : body ? 2 : 1));
    tag.push_back(body ? static_cast<std::int32_t>(identity.id) : -1);
  }
  fields_->write({simulation_.time(), simulation_.counters().steps, position, velocity, pressure, type, tag});
}

void Recorder::write_bodies() {
  constexpr int width = 20;  // and the shape behind them
  std::vector<double> rows;
  for (const auto& body : simulation_.bodies()->all()) {
    if (!speaks_for(rank_, body)) continue;
    const auto& s = body.state;
    rows.push_back(static_cast<double>(body.tag));
    for (int c = 0; c < 3; ++c) rows.push_back(s.position[c]);
    for (const double q : {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()})
      rows.push_back(q);
    for (const auto* v : {&s.velocity, &s.angular_velocity, &body.applied.force, &body.applied.torque}) {
      for (int c = 0; c < 3; ++c) rows.push_back((*v)[c]);
    }
    rows.push_back(body.shape);
  }
  const std::vector<double> all = gather_on_first(rows, simulation_.comm());
  std::vector<const double*> sorted;
  for (std::size_t k = 0; k + width < all.size(); k += width + 1) sorted.push_back(&all[k]);
  std::sort(sorted.begin(), sorted.end(), [](const double* a, const double* b) { return a[0] < b[0]; });
  for (const double* row : sorted) {
    std::vector<double> values{simulation_.time()};
    values.insert(values.end(), row, row + width);
    bodies_->row(values);
    if (row[0] <= newest_listed_) continue;  // in shapes.json, or listed before
    newest_listed_ = row[0];
    arrivals_->row(std::vector<double>{simulation_.time(), row[0], row[width]});
    arrivals_->flush();
  }
  if (rank_ == 0) bodies_->flush();
}

void Recorder::write_structures() {
  const std::vector<coupling::Load> means = simulation_.structures()->take_means(simulation_.comm());
  if (rank_ != 0) return;
  for (std::size_t k = 0; k < means.size(); ++k) {
    const auto& [f, t] = means[k];
    structures_[k]->row(std::vector<double>{simulation_.time(), f[0], f[1], f[2], t[0], t[1], t[2]});
    structures_[k]->flush();
  }
}

void Recorder::write_openings() {
  const std::vector<Openings::Passage> passed = simulation_.openings()->passages();
  const double time = simulation_.time();
  passed_.resize(passed.size());
  for (std::size_t k = 0; k < passed.size(); ++k) {
    const double discharge = time > passed_at_ ? (passed[k].volume - passed_[k]) / (time - passed_at_) : 0;
    passed_[k] = passed[k].volume;
    if (rank_ != 0) continue;
    openings_[k]->row(std::vector<double>{time, discharge, passed[k].level, passed[k].speed, passed[k].volume});
    openings_[k]->flush();
  }
  passed_at_ = time;
}

void Recorder::write_gauges() {
  for (std::size_t g = 0; g < scene_.gauges.size(); ++g) {
    const Gauge& gauge = scene_.gauges[g];
    const double value = gauge.kind == GaugeKind::pressure ? pressure_at(simulation_, gauge)
                         : gauge.kind == GaugeKind::level  ? water_level(simulation_, scene_, gauge)
                                                           : front_position(simulation_, gauge);
    if (rank_ == 0) {
      gauges_[g]->row(std::vector<double>{simulation_.time(), value});
      gauges_[g]->flush();
    }
  }
}

void Recorder::write_energies() {
  now_ = measure(simulation_, scene_);
  interactions_ += interactions(simulation_.particles(), simulation_.neighbours(), simulation_.constants().support);
  listed_ += static_cast<std::int64_t>(2 * simulation_.neighbours().pairs());  // as Counters::pair_sweeps
  if (start_.particles == 0) {
    start_ = now_;
    lowest_energy_ = start_.energy.balance();
    write_stage();
  }
  most_outside_ = std::max(most_outside_, now_.outside_tank);
  most_inside_ = std::max(most_inside_, now_.inside_bodies);
  deepest_ = std::max(deepest_, now_.deepest_in_body);
  farthest_outside_ = std::max(farthest_outside_, now_.farthest_outside_tank);
  const double balance = now_.energy.balance();
  largest_energy_gain_ = std::max(largest_energy_gain_, balance - start_.energy.balance());
  lowest_energy_ = std::min(lowest_energy_, balance);
  largest_energy_rise_ = std::max(largest_energy_rise_, balance - lowest_energy_);
  if (now_.compressed_share > compressed_share_) {
    compressed_share_ = now_.compressed_share;
    compressed_at_ = simulation_.time();
  }
  largest_energy_ = std::max({largest_energy_, now_.energy.kinetic + now_.kinetic_of_bodies, now_.energy.elastic});
  if (rank_ != 0) return;
  std::vector<double> row = {simulation_.time(),
                             now_.energy.kinetic,
                             now_.energy.potential,
                             now_.energy.elastic,
                             now_.energy.total(),
                             now_.mass,
                             now_.momentum[0],
                             now_.momentum[1],
                             now_.momentum[2],
                             now_.volume_ratio,
                             static_cast<double>(now_.outside_tank),
                             static_cast<double>(now_.inside_bodies),
                             now_.deepest_in_body,
                             now_.farthest_outside_tank};
  if (simulation_.bodies() != nullptr) row.insert(row.end(), {now_.energy.bodies, now_.energy.work});
  if (scene_.output.audit) row.push_back(now_.energy.in_solids);
  energies_->row(row);
  energies_->flush();
}

void Recorder::write_stage() {
  std::vector<double> packed;
  if (simulation_.bodies() != nullptr) {
    for (const auto& body : simulation_.bodies()->all()) {
      if (!speaks_for(rank_, body)) continue;
      packed.push_back(static_cast<double>(body.tag));
      packed.push_back(body.shape);
    }
  }
  const std::vector<double> all = gather_on_first(packed, simulation_.comm());
  if (rank_ != 0) return;
  Json json;
  json.set("title", scene_.title);
  json.set("dimension", scene_.dimension);
  json.set("gravity", array_of(scene_.fluid.gravity));
  json.set("particle_distance", scene_.numerics.particle_distance);
  json.set("pictures", Json::Array(scene_.output.pictures));
  for (const auto& [name, value] : scene_.parameters) json.object("parameters").set(name, value);
  Json& domain = json.object("domain");
  domain.set("lower", array_of(scene_.domain.lower));
  domain.set("upper", array_of(scene_.domain.upper));
  for (const Wall& wall : scene_.walls) {
    Json& entry = json.append("walls");
    entry.set("name", wall.name);
    static constexpr const char* kinds[] = {"tank", "box", "cylinder", "sphere", "prism", "stl"};
    entry.set("kind", kinds[static_cast<int>(wall.kind)]);
    if (wall.kind > Wall::Kind::box) entry.set("axis", static_cast<int>(wall.form.axis));
    for (const Vec3d& corner : wall.form.polygon) {
      entry.append("polygon").set("point", Json::Array{corner[0], corner[1]});
    }
    entry.set("lower", array_of(wall.region.lower));
    entry.set("upper", array_of(wall.region.upper));
    if (wall.form.surface && wall.form.surface->triangles.size() <= most_triangles) {
      Json::Array corners;
      for (const Triangle& triangle : wall.form.surface->triangles) append(corners, triangle.corner);
      entry.set("triangles", corners);
    }
    const Motion motion = wall.motion.value_or(Motion{});
    entry.set("velocity", array_of(motion.velocity));
    entry.set("start", motion.start);
    entry.set("stop", std::min(motion.stop, 1e30));
    entry.set("open", wall.open);
    for (const auto& [time, moved] : motion.table) {
      entry.append("table").set("row", Json::Array{time, moved[0], moved[1], moved[2]});
    }
    if (!motion.turns()) continue;
    entry.set("pivot", Json::Array{motion.pivot[0], motion.pivot[1], motion.pivot[2]});
    entry.set("turn_axis", Json::Array{motion.axis[0], motion.axis[1], motion.axis[2]});
    entry.set("angular_velocity", motion.angular_velocity);
    for (const auto& [time, angle] : motion.angle_table) {
      entry.append("angles").set("row", Json::Array{time, angle});
    }
  }
  if (simulation_.bodies() != nullptr) {
    for (const auto& shape : simulation_.bodies()->shapes()) {
      Json& entry = json.append("shapes");
      static constexpr const char* kinds[] = {"box", "sphere", "cylinder", "prism", "surface"};
      entry.set("kind", kinds[static_cast<int>(shape.kind)]);
      entry.set("size", Json::Array{shape.size[0], shape.size[1], shape.size[2]});
      entry.set("density", shape.density);
      if (!shape.polyhedron) continue;
      Json::Array corners;  // in the body frame
      for (const auto& triangle : shape.polyhedron->surface.triangles()) append(corners, triangle);
      entry.set("triangles", corners);
    }
  }
  for (std::size_t k = 0; k + 1 < all.size(); k += 2) {
    newest_listed_ = std::max(newest_listed_, all[k]);
    Json& entry = json.append("bodies");
    entry.set("tag", static_cast<std::int64_t>(all[k]));
    entry.set("shape", static_cast<std::int64_t>(all[k + 1]));
  }
  write_json(folder_ / "shapes.json", json);
}

void Recorder::show_progress(bool last) {
  if (rank_ != 0) return;
  const double now = MPI_Wtime();
  // mpirun gives every rank a pseudo-terminal, so the front door says whether the user sits at one.
  const char* const told = std::getenv("EMBACLE_TERMINAL");
  const bool terminal = told != nullptr && std::string(told) == "1";
  if (!last && now - last_shown_ < (terminal ? 0.5 : 15.0)) return;
  last_shown_ = now;
  const double time = simulation_.time();
  const double share = std::min(1.0, time / scene_.end_time);
  const double spent = now - began_;
  const double steps = static_cast<double>(simulation_.counters().steps - simulation_.earlier_steps());
  const double done = time - began_at_;
  const double left = done > 0.005 * scene_.end_time ? spent * (scene_.end_time - time) / done : NAN;
  const std::string line = fmt::format("{:5.1f} %  t = {:.4f} s of {:g} s  {} steps  {:.2f} M particle updates/s  {}",
                                       100 * share, time, scene_.end_time, simulation_.counters().steps,
                                       spent > 0 ? 1e-6 * static_cast<double>(now_.particles) * steps / spent : 0.0,
                                       last                  ? fmt::format("{:.0f} s in all", spent)
                                       : std::isfinite(left) ? fmt::format("{:.0f} s left", left)
                                                             : std::string());
  fmt::print("{}{}{}", terminal ? "\r" : "", line, terminal && !last ? "\033[K" : "\n");
  std::fflush(stdout);
}

Json Recorder::summary(const coupling::FluidLink* link, double wall_seconds) {
  const Constants& c = simulation_.constants();
  int size = 1;
  MPI_Comm_size(simulation_.comm(), &size);
  const Counters& counters = simulation_.counters();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  std::int64_t sums[10] = {counters.water_updates,
                           counters.particle_updates,
                           counters.pair_sweeps,
                           static_cast<std::int64_t>(simulation_.bytes()),
                           simulation_.halo().bytes_sent(),
                           simulation_.halo().messages_sent(),
                           static_cast<std::int64_t>(simulation_.particles().own()),
                           interactions_,
                           listed_,
                           1024 * static_cast<std::int64_t>(usage.ru_maxrss)};
  std::int64_t totals[10];
  MPI_Allreduce(sums, totals, 10, MPI_INT64_T, MPI_SUM, simulation_.comm());
  double extremes[4] = {simulation_.extremes().speed, simulation_.extremes().compression,
                        simulation_.extremes().pressure, simulation_.extremes().body_penetration};
  MPI_Allreduce(MPI_IN_PLACE, extremes, 4, MPI_DOUBLE, MPI_MAX, simulation_.comm());
  auto seconds = simulation_.phases().all();
  MPI_Allreduce(MPI_IN_PLACE, seconds.data(), static_cast<int>(seconds.size()), MPI_DOUBLE, MPI_SUM,
                simulation_.comm());

  wall_seconds += earlier_seconds_;
  const double own_steps =  // the halo's counters are not kept over a restart
      static_cast<double>(std::max<std::int64_t>(1, counters.steps - simulation_.earlier_steps()));
  Json json;
  json.set("title", scene_.title).set("scene", scene_.file.filename().string()).set("version", EMBACLE_VERSION);
  json.set("fluid_ranks", size);
  json.set("threads_per_rank", threads());
  json.set("dimension", c.dimension);
  json.set("simulated_seconds", simulation_.time()).set("wall_seconds", wall_seconds);
  if (!restart_times_.empty()) json.set("restarted_at", restart_times_);
  json.set("steps", counters.steps)
      .set("time_step", simulation_.longest_step())
      .set("time_step_limit", name_of(c.step_limit));
  if (scene_.numerics.adaptive_step) {
    Json& adapted = json.object("adaptive_step");
    adapted.set("shortest", simulation_.extremes().shortest_step);
    for (std::size_t k = 0; k < step_limit_names.size(); ++k)
      adapted.set(std::string("steps_limited_") + step_limit_names[k], counters.limited_steps[k]);
  }
  json.set("particle_distance", c.particle_distance).set("support", c.support).set("sound_speed", c.sound_speed);
  json.set("water_particles", now_.particles).set("particles", totals[6]);
  json.set("removed_at_start", simulation_.removed_at_start());
  if (simulation_.bodies() != nullptr) json.set("displaced_by_arrivals", simulation_.displaced_by_arrivals());
  json.set("neighbour_list_builds", counters.builds).set("decompositions", counters.decompositions);
  json.set("imbalance", simulation_.imbalance())
      .set("imbalance_largest", simulation_.extremes().imbalance)
      .set("imbalance_met", simulation_.extremes().imbalance_met);
  json.set("water_updates_per_second", static_cast<double>(totals[0]) / wall_seconds);
  json.set("particle_updates_per_second", static_cast<double>(totals[1]) / wall_seconds);
  json.set("listed_pairs_per_second", static_cast<double>(totals[2]) / wall_seconds);
  json.set("bytes_per_particle", totals[6] > 0 ? static_cast<double>(totals[3]) / static_cast<double>(totals[6]) : 0.0);
  json.set("bytes_per_water_particle",
           now_.particles > 0 ? static_cast<double>(totals[3]) / static_cast<double>(now_.particles) : 0.0);
  json.set("peak_resident_bytes", totals[9]);
  // Pairs within the support, of those listed: as at the times of energies.csv.
  const double within = totals[8] > 0 ? static_cast<double>(totals[7]) / static_cast<double>(totals[8]) : 0.0;
  json.set("interactions_per_second", within * static_cast<double>(totals[2]) / wall_seconds);
  Json& phases = json.object("phase_seconds_mean_per_rank");
  for (std::size_t k = 0; k < seconds.size(); ++k) phases.set(phase_names[k], seconds[k] / size);
  Json& halo = json.object("halo");
  halo.set("bytes_per_rank_and_step", static_cast<double>(totals[4]) / size / own_steps);
  halo.set("messages_per_rank_and_step", static_cast<double>(totals[5]) / size / own_steps);
  Json& energy = json.object("energy");
  energy.set("start_total", start_.energy.total()).set("end_total", now_.energy.total());
  energy.set("kinetic", now_.energy.kinetic)
      .set("potential", now_.energy.potential)
      .set("elastic", now_.energy.elastic)
      .set("in_solids", now_.energy.in_solids);
  if (simulation_.bodies() != nullptr) energy.set("bodies", now_.energy.bodies).set("work_on_bodies", now_.energy.work);
  energy.set("largest_gain", largest_energy_gain_).set("largest_rise", largest_energy_rise_);
  json.set("mass", now_.mass);
  json.set("momentum", Json::Array{now_.momentum[0], now_.momentum[1], now_.momentum[2]});
  json.set("volume_ratio_start", start_.volume_ratio).set("volume_ratio_end", now_.volume_ratio);
  json.set("volume_drift", now_.volume_ratio / start_.volume_ratio - 1.0);
  Json& extreme = json.object("extremes");
  extreme.set("speed", extremes[0]).set("compression", extremes[1]).set("pressure", extremes[2]);
  extreme.set("share_with_density_off_by_1_percent", compressed_share_);
  extreme.set("water_outside_tank", most_outside_).set("water_inside_bodies", most_inside_);
  extreme.set("farthest_outside_tank", farthest_outside_);
  extreme.set("deepest_in_body", std::max(deepest_, std::max(0.0, extremes[3])));
  if (scene_.output.audit) {
    Json& audit = json.object("audit");
    audit.set("reaction_mismatch", simulation_.worst_audit().reaction_mismatch);
    audit.set("momentum_residual", simulation_.worst_audit().momentum_residual);
  }
  if (link != nullptr) {
    const coupling::LinkCounters& mine = link->counters();
    std::int64_t link_sums[4] = {mine.messages_sent, mine.bytes_sent, mine.predictor_messages_sent,
                                 mine.plan_messages_sent};
    std::int64_t link_most = mine.messages_sent;
    double waiting = mine.waiting_seconds;
    MPI_Allreduce(MPI_IN_PLACE, link_sums, 4, MPI_INT64_T, MPI_SUM, simulation_.comm());
    MPI_Allreduce(MPI_IN_PLACE, &link_most, 1, MPI_INT64_T, MPI_MAX, simulation_.comm());
    MPI_Allreduce(MPI_IN_PLACE, &waiting, 1, MPI_DOUBLE, MPI_SUM, simulation_.comm());
    const double windows = static_cast<double>(std::max<std::int64_t>(1, mine.windows));
    Json& coupling = json.object("coupling");
    coupling.set("scheme", scene_.coupling.scheme == Scheme::serial ? "serial" : "parallel");
    coupling.set("steps_per_window", scene_.coupling.steps_per_window).set("predictor", scene_.coupling.predictor);
    coupling.set("windows", mine.windows);
    coupling.set("messages_per_rank_and_window_mean", static_cast<double>(link_sums[0]) / size / windows);
    coupling.set("messages_per_rank_and_window_most", static_cast<double>(link_most) / windows);
    coupling.set("bytes_per_rank_and_window", static_cast<double>(link_sums[1]) / size / windows);
    coupling.set("predictor_messages_per_rank_and_window", static_cast<double>(link_sums[2]) / size / windows);
    coupling.set("waiting_seconds_mean_per_rank", waiting / size);
  } else {
    json.object("coupling").set("windows", 0).set("messages_per_rank_and_window_mean", 0.0).set("body_bytes", 0);
  }
  std::vector<std::string> warnings = simulation_.warnings();
  for (std::string& doubt : doubts(extremes[0], extremes[1])) {
    if (rank_ == 0) fmt::print("warning: {}\n", doubt);
    warnings.push_back(std::move(doubt));
  }
  json.set("warnings", warnings);
  return json;
}

std::vector<std::string> Recorder::doubts(double speed, double compression) const {
  const Constants& c = simulation_.constants();
  std::vector<std::string> found;
  if (speed > 0.3 * c.sound_speed || compression > 0.15) {
    found.push_back(fmt::format(
        "the water was not weakly compressible: speed up to {:.3g} m/s (sound speed {:.3g}), density off by up to "
        "{:.0f} %; give a larger numerics.reference_speed",
        speed, c.sound_speed, 100 * compression));
  }
  if (compressed_share_ > most_compressed) {
    found.push_back(
        fmt::format("the density was off by more than 1 % in {:.0f} % of the water at t = {:.4g} s: sound is too slow "
                    "for this flow; "
                    "a larger numerics.reference_speed (now {:.3g} m/s) makes it stiffer",
                    100 * compressed_share_, compressed_at_, c.reference_speed));
  }
  const bool driven = !std::equal(c.gravity, c.gravity + 3, c.static_gravity);
  const double allowed = (simulation_.bodies() != nullptr ? 0.05 : 0.01) * largest_energy_;
  if (!driven && scene_.openings.empty() && !simulation_.walls().any_moves() && largest_energy_gain_ > allowed) {
    found.push_back(fmt::format(
        "{} gained up to {:.3g} J with no work done ({:.1f} % of the largest kinetic or elastic energy): do "
        "not trust this run; a smaller numerics.cfl{} may help{}",
        simulation_.bodies() != nullptr ? "water and bodies" : "the water", largest_energy_gain_,
        100 * largest_energy_gain_ / largest_energy_, simulation_.bodies() != nullptr ? " or shorter windows" : "",
        scene_.output.audit ? "" : "; with output.audit what solid points had stored is counted, too"));
  }
  return found;
}

}  // namespace embacle::mps
