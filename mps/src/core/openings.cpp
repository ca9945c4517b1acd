#include "core/openings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/filling.hpp"
#include "embacle/coupling/types.hpp"

namespace embacle::mps {

namespace {

/// Length [l0], beyond a zone, over which the level there is measured: sums over a lattice then do not depend on where
/// it stands.
constexpr double window_length = 8;
/// Time [sqrt(depth/g)] over which a measured level is smoothed.
constexpr double smoothing = 2;
/// Least velocity in the zone of an outflow, of its mean: slower water would stay.
constexpr double least_share = 0.2;
/// Between two exchanges the fastest water goes this part of a particle distance, unless so many steps are fewer. Odd,
/// so that no number of steps meets it and rounding decides.
constexpr double part_of_distance = 0.2437, fastest_of_profile = 1.5;
constexpr int most_steps = 50;
/// By which the density ratio of water that enters the zone of an outflow may differ from 1.
constexpr double largest_change = 0.03;
double kept(double density_ratio) { return std::clamp(density_ratio, 1 - largest_change, 1 + largest_change); }

}  // namespace

Openings::Openings(const Scene& scene, const Constants& constants, const Walls& walls, MPI_Comm comm)
    : scene_(scene), constants_(constants), comm_(comm), up_(scene.upright()), states_(scene.openings.size()) {
  for (std::size_t k = 0; k < count(); ++k) {
    if (scene.openings[k].kind != Opening::Kind::drain) lay_rows(k, walls);
  }
}

double Openings::into(std::size_t k, const double* x) const {
  const BoxRegion& region = scene_.openings[k].region;
  const int c = axis(k);
  return sign(k) > 0 ? x[c] - region.lower[c] : region.upper[c] - x[c];
}

bool Openings::within_section(std::size_t k, const double* x) const {
  const Opening& opening = scene_.openings[k];
  for (int c = 0; c < constants_.dimension; ++c) {
    if (opening.kind != Opening::Kind::drain && c == axis(k)) continue;
    if (x[c] < opening.region.lower[c] || x[c] > opening.region.upper[c]) return false;
  }
  return true;
}

bool Openings::in_zone(std::size_t k, const double* x) const {
  const double way = into(k, x);
  return way >= 0 && way < scene_.openings[k].region.upper[axis(k)] - scene_.openings[k].region.lower[axis(k)] &&
         within_section(k, x);
}

/// The lattice of the cross-section at the reach's end of the zone, less what is in walls.
void Openings::lay_rows(std::size_t k, const Walls& walls) {
  const Opening& opening = scene_.openings[k];
  State& state = states_[k];
  const double l0 = constants_.particle_distance;
  const int along = axis(k), across = 3 - along - up_;
  const auto count_in = [&](int c) {
    if (c >= constants_.dimension) return 1;
    return static_cast<int>(std::floor((opening.region.upper[c] - opening.region.lower[c]) / l0 + 1e-6));
  };
  const int layers = count_in(up_), columns = count_in(across);
  const double area = l0 * (constants_.dimension == 3 ? l0 : scene_.thickness);
  const bool inflow = opening.kind == Opening::Kind::inflow;
  const double outer = sign(k) > 0 ? opening.region.lower[along] : opening.region.upper[along];
  const double inner = sign(k) > 0 ? opening.region.upper[along] : opening.region.lower[along];
  state.of_layer.assign(layers, 0.0);
  state.bed_of.assign(inflow ? static_cast<std::size_t>(layers) * columns : 0, opening.region.lower[up_]);
  for (int column = 0; column < columns; ++column) {
    double bed = 0;
    bool open = false;
    for (int layer = 0; layer < layers; ++layer) {
      Row row{};
      row.place[up_] = opening.region.lower[up_] + (layer + 0.5) * l0;
      if (across < constants_.dimension) row.place[across] = opening.region.lower[across] + (column + 0.5) * l0;
      row.place[along] = inflow ? inner : outer;
      if (near_wall(scene_, walls, row.place, 0.25 * l0)) {
        open = false;
        continue;
      }
      if (!open) bed = row.place[up_] - 0.5 * l0;
      open = true;
      state.of_layer[layer] += area;
      row.place[along] = outer;
      if (inflow) state.rows.push_back(row);
      if (inflow) state.bed_of[layer + static_cast<std::size_t>(layers) * column] = bed;
    }
  }
  if (std::all_of(state.of_layer.begin(), state.of_layer.end(), [](double a) { return a == 0; })) {
    throw coupling::InputError(scene_.file.string() + ":" + std::to_string(opening.line) + ": opening." + opening.name +
                               ": the zone is full of walls; allowed: a zone with room for water");
  }
}

double Openings::area_below(std::size_t k, double level) const {
  const double l0 = constants_.particle_distance;
  const double layers = (level - scene_.openings[k].region.lower[up_]) / l0;
  double area = 0;
  for (std::size_t n = 0; n < states_[k].of_layer.size(); ++n) {
    area += std::clamp(layers - static_cast<double>(n), 0.0, 1.0) * states_[k].of_layer[n];
  }
  return area;
}

double Openings::level_of(std::size_t k, double area) const {
  double level = scene_.openings[k].region.lower[up_];
  for (const double layer : states_[k].of_layer) {
    if (layer > 0 && area < layer) return level + constants_.particle_distance * area / layer;
    area -= layer;
    level += constants_.particle_distance;
  }
  return level;
}

/// Of a row that is below the level.
double Openings::share(std::size_t k, const Row& row) const {
  const double l0 = constants_.particle_distance;
  return std::clamp((states_[k].level - row.place[up_]) / l0 + 0.5, 0.0, 1.0);
}

double Openings::profile(std::size_t k, const double* x) const {
  const State& state = states_[k];
  const BoxRegion& region = scene_.openings[k].region;
  const auto layers = static_cast<int>(state.of_layer.size());
  const auto index = [&](int c, int end) {
    return std::clamp(static_cast<int>((x[c] - region.lower[c]) / constants_.particle_distance), 0, end - 1);
  };
  const int across = 3 - axis(k) - up_, columns = static_cast<int>(state.bed_of.size()) / layers;
  const int column = across < constants_.dimension ? index(across, columns) : 0;
  const double bed = state.bed_of[index(up_, layers) + static_cast<std::size_t>(layers) * column];
  const double height = std::clamp((x[up_] - bed) / std::max(state.level - bed, 1e-300), 0.0, 1.0);
  switch (scene_.openings[k].profile) {
    case Profile::power:
      return std::pow(height, 1.0 / 7.0);
    case Profile::parabolic:
      return height * (2 - height);
    case Profile::uniform:
      break;
  }
  return 1;
}

Traveller Openings::particle_of(std::size_t k, const Row& row, double way) {
  Traveller traveller;
  std::copy_n(row.place, 3, traveller.record.x);
  traveller.record.x[axis(k)] += sign(k) * way;
  traveller.record.v[axis(k)] = sign(k) * states_[k].speed * profile(k, row.place);
  const double depth = std::max(0.0, states_[k].level - row.place[up_]);
  traveller.record.p = constants_.density * std::abs(constants_.gravity[up_]) * depth;
  traveller.record.s = density_ratio_of(traveller.record.p, constants_);
  traveller.identity.id = next_id_++;
  return traveller;
}

void Openings::start(std::vector<Traveller>& water, std::int64_t next_id, int rank, int size) {
  next_id_ = next_id;
  const double l0 = constants_.particle_distance;
  const auto inflow = [&](std::size_t k) { return scene_.openings[k].kind == Opening::Kind::inflow; };
  std::erase_if(water, [&](const Traveller& traveller) {
    for (std::size_t k = 0; k < count(); ++k) {
      if (inflow(k) && in_zone(k, traveller.record.x)) return true;
    }
    return false;
  });
  measure(water, 0);
  int turn = 0;
  for (std::size_t k = 0; k < count(); ++k) {
    if (!inflow(k)) continue;
    const Opening& opening = scene_.openings[k];
    const int length = static_cast<int>((opening.region.upper[axis(k)] - opening.region.lower[axis(k)]) / l0 + 1e-6);
    for (const Row& row : states_[k].rows) {
      if (share(k, row) < 0.5) continue;
      for (int n = 0; n < length; ++n) {
        const Traveller particle = particle_of(k, row, (n + 0.5) * l0);
        if (turn++ % size == rank) water.push_back(particle);
      }
    }
  }
}

/// The area of the cross-section beside each zone, on its side of the reach, and the mean velocity there; then the
/// velocities of the zones.
void Openings::measure(const std::vector<Traveller>& water, double passed_time) {
  const double reach = window_length * constants_.particle_distance;
  const double volume = constants_.particle_mass / constants_.density;
  std::vector<double> sums(2 * count());
  for (const Traveller& traveller : water) {
    const double* x = traveller.record.x;
    for (std::size_t k = 0; k < count(); ++k) {
      const Opening& opening = scene_.openings[k];
      if (opening.kind == Opening::Kind::drain) continue;
      const double length = opening.region.upper[axis(k)] - opening.region.lower[axis(k)];
      const double along = into(k, x);
      const double distance = opening.kind == Opening::Kind::inflow ? along - length : -along;
      if (distance >= 0 && distance <= reach && within_section(k, x)) {
        const double weight = (1 - std::cos(2 * std::numbers::pi * distance / reach)) / reach;
        sums[2 * k] += weight * volume;
        sums[2 * k + 1] += weight * volume * sign(k) * traveller.record.v[axis(k)];
      }
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  for (std::size_t k = 0; k < count(); ++k) {
    const double area = sums[2 * k], mean_speed = area > 0 ? sums[2 * k + 1] / area : 0;
    if (scene_.openings[k].kind == Opening::Kind::inflow) set_inflow(k, level_of(k, area), passed_time);
    if (scene_.openings[k].kind == Opening::Kind::outflow) set_outflow(k, level_of(k, area), mean_speed, passed_time);
  }
}

void Openings::set_inflow(std::size_t k, double measured, double passed_time) {
  const Opening& opening = scene_.openings[k];
  State& state = states_[k];
  const double bed = opening.region.lower[up_], gravity = std::abs(constants_.gravity[up_]);
  const double l0 = constants_.particle_distance;
  if (opening.level) {
    state.level = *opening.level;
  } else if (!state.known) {
    state.level = measured;
  } else {
    const double delay = smoothing * std::sqrt(std::max(l0, state.level - bed) / gravity);
    state.level += (1 - std::exp(-passed_time / delay)) * (measured - state.level);
  }
  const double top = opening.region.upper[up_];
  state.level = std::clamp(state.level, bed + l0, top);
  state.known = true;
  const double discharge = opening.discharge_at(time_);
  const auto too_low = [&] {  // for flow slower than its waves: Q^2 B > g A^3
    const double area = area_below(k, state.level), width = (area - area_below(k, state.level - l0)) / l0;
    return area == 0 || discharge * discharge * width > gravity * area * area * area;
  };
  while (!opening.level && state.level < top && too_low()) state.level = std::min(top, state.level + 0.1 * l0);
  double area = 0;  // as the profile weighs it
  const double cell = l0 * (constants_.dimension == 3 ? l0 : scene_.thickness);
  for (const Row& row : state.rows) area += share(k, row) * profile(k, row.place) * cell;
  state.speed = area > 0 ? discharge / area : 0;
}

/// Long waves leave if nothing comes back along the other characteristic: u - 2 sqrt(g A/B) is that of the stated level
/// and its velocity u0. Where it is not stated either, it follows the velocity slowly enough for the reach to answer
/// without oscillation: only at the stated level it then comes to rest. Water faster than its waves leaves as it comes.
void Openings::set_outflow(std::size_t k, double measured, double mean_speed, double passed_time) {
  const Opening& opening = scene_.openings[k];
  State& state = states_[k];
  const double l0 = constants_.particle_distance;
  state.level = measured;
  const double stated = area_below(k, *opening.level), area = area_below(k, measured);
  const double width = (area_below(k, *opening.level + 0.5 * l0) - area_below(k, *opening.level - 0.5 * l0)) / l0;
  const auto celerity_of = [&](double section) {
    return std::sqrt(std::abs(constants_.gravity[up_]) * section / std::max(width, 1e-3 * l0));
  };
  const double celerity = celerity_of(stated);
  const bool discharge = opening.discharge || !opening.hydrograph.rows.empty();
  if (discharge) {
    state.slow = opening.discharge_at(time_) / stated;
  } else if (!state.known) {
    state.slow = mean_speed;
  } else {
    const double reach = scene_.domain.upper[axis(k)] - scene_.domain.lower[axis(k)];
    state.slow += (1 - std::exp(-passed_time * celerity / (4 * reach))) * (state.speed - state.slow);
  }
  state.known = true;
  if (mean_speed > celerity_of(area)) {  // faster than waves: what is behind the zone cannot be felt before it
    state.slow = state.speed = mean_speed;
    return;
  }
  state.speed = std::max(0.0, state.slow + 2 * (celerity_of(area) - celerity));
}

void Openings::exchange(std::vector<Traveller>& water, double time, const Decomposition& decomposition) {
  const double passed = time - time_;
  const double l0 = constants_.particle_distance;
  for (std::size_t k = 0; k < count(); ++k) {  // at the velocities since the last call
    State& state = states_[k];
    for (Row& row : state.rows) {
      const double part = share(k, row);
      const double speed = state.speed * profile(k, row.place);
      row.owed += part * speed * passed / l0;
      for (; row.owed >= 1; --row.owed) {
        const Traveller particle = particle_of(k, row, (row.owed - 1) * l0 / std::max(part, 1e-3));
        ++state.passed;
        if (decomposition.owns(particle.record.x)) water.push_back(particle);
      }
    }
  }
  std::erase_if(water, [&](const Traveller& traveller) {
    for (std::size_t k = 0; k < count(); ++k) {
      const Opening& opening = scene_.openings[k];
      if (opening.kind == Opening::Kind::inflow || !within_section(k, traveller.record.x)) continue;
      if (opening.kind == Opening::Kind::outflow &&
          into(k, traveller.record.x) < opening.region.upper[axis(k)] - opening.region.lower[axis(k)])
        continue;
      ++states_[k].passed;
      return true;
    }
    return false;
  });
  time_ = time;
  measure(water, passed);
  choose_interval();
}

/// Until the water has gone a part of its distance, or for some steps.
void Openings::choose_interval() {
  double fastest = 0;
  for (const State& state : states_) fastest = std::max(fastest, fastest_of_profile * state.speed);
  const double longest = most_steps * constants_.step;
  const double way = part_of_distance * constants_.particle_distance;
  interval_ = fastest * longest > way ? way / fastest : longest;
}

void Openings::list(Particles& particles, bool exchanged) {
  driven_.clear();
  list_ghosts(particles, exchanged);
  if (!exchanged) {
    for (std::uint32_t i = 0; i < particles.water; ++i) {
      if (particles.identity[i].point == 0) continue;
      const std::int32_t opening = particles.identity[i].point - 1;
      const Record& record = particles.record[i];  // as drive() left it
      driven_.push_back({i, opening, sign(opening) * record.v[axis(opening)], record.s});
    }
    return;
  }
  std::vector<double> sums(2 * count());
  for (std::uint32_t i = 0; i < particles.water; ++i) {
    const Record& record = particles.record[i];
    particles.identity[i].point = 0;
    for (std::size_t k = 0; k < count(); ++k) {
      if (scene_.openings[k].kind == Opening::Kind::drain || !in_zone(k, record.x)) continue;
      const double own = sign(k) * record.v[axis(k)];
      driven_.push_back({i, static_cast<std::int32_t>(k), own, kept(record.s)});
      particles.identity[i].point = static_cast<std::int32_t>(k) + 1;
      sums[2 * k] += own;
      sums[2 * k + 1] += 1;
      break;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  for (Driven& driven : driven_) {
    const auto k = static_cast<std::size_t>(driven.opening);
    const State& state = states_[k];
    if (scene_.openings[k].kind == Opening::Kind::outflow) {
      const double mean = sums[2 * k] / sums[2 * k + 1];
      driven.speed = std::max(driven.speed + state.speed - mean, least_share * state.speed);
      continue;
    }
    driven.speed = state.speed * profile(k, particles.record[driven.particle].x);
  }
}

/// As their own ranks list them.
void Openings::list_ghosts(const Particles& particles, bool exchanged) {
  driven_ghosts_.clear();
  const auto outflow = [&](std::size_t k) { return scene_.openings[k].kind == Opening::Kind::outflow; };
  for (std::size_t i = particles.own(); i < particles.ghost_solid_begin(); ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    const Record& record = particles.record[i];
    if (!exchanged) {
      const std::int32_t point = particles.identity[i].point;
      if (point > 0 && outflow(static_cast<std::size_t>(point) - 1)) driven_ghosts_.push_back({number, record.s});
      continue;
    }
    for (std::size_t k = 0; k < count(); ++k) {
      if (scene_.openings[k].kind == Opening::Kind::drain || !in_zone(k, record.x)) continue;
      if (outflow(k)) driven_ghosts_.push_back({number, kept(record.s)});
      break;
    }
  }
}

void Openings::drive(Particles& particles) const {
  for (const Driven& driven : driven_) {
    const auto k = static_cast<std::size_t>(driven.opening);
    Record& record = particles.record[driven.particle];
    std::fill_n(record.v, 3, 0.0);
    record.v[axis(k)] = sign(k) * driven.speed;
    if (scene_.openings[k].kind == Opening::Kind::outflow) record.s = driven.density_ratio;
  }
  for (const DrivenGhost& ghost : driven_ghosts_) particles.record[ghost.particle].s = ghost.density_ratio;
}

std::vector<Openings::Passage> Openings::passages() const {
  std::vector<double> passed(count());
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  for (std::size_t k = 0; k < count(); ++k) {
    const bool mine = scene_.openings[k].kind != Opening::Kind::inflow || rank == 0;
    passed[k] = mine ? static_cast<double>(states_[k].passed) : 0;
  }
  MPI_Allreduce(MPI_IN_PLACE, passed.data(), static_cast<int>(count()), MPI_DOUBLE, MPI_SUM, comm_);
  std::vector<Passage> result(count());
  for (std::size_t k = 0; k < count(); ++k) {
    result[k] = {passed[k] * constants_.particle_mass / constants_.density, states_[k].level, states_[k].speed};
  }
  return result;
}

std::vector<double> Openings::save() const {
  std::vector<double> numbers{time_, static_cast<double>(next_id_)};
  const double particle = constants_.particle_mass / constants_.density;
  const std::vector<Passage> passed = passages();
  for (std::size_t k = 0; k < count(); ++k) {
    const State& state = states_[k];
    numbers.insert(numbers.end(), {state.known ? 1.0 : 0.0, state.level, state.slow, state.speed,
                                   std::round(passed[k].volume / particle)});
    for (const Row& row : state.rows) numbers.push_back(row.owed);
  }
  return numbers;
}

void Openings::restore(const std::vector<double>& numbers) {
  std::size_t needed = 2;
  for (const State& state : states_) needed += 5 + state.rows.size();
  if (numbers.size() != needed) {
    throw coupling::InputError(scene_.file.string() +
                               ": the openings are not those of the checkpoint: their cross-sections differ");
  }
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  auto next = numbers.begin();
  time_ = *next++;
  next_id_ = static_cast<std::int64_t>(*next++);
  for (std::size_t k = 0; k < count(); ++k) {
    State& state = states_[k];
    state.known = *next++ != 0;
    state.level = *next++;
    state.slow = *next++;
    state.speed = *next++;
    const auto passed = static_cast<std::int64_t>(*next++);
    state.passed = scene_.openings[k].kind == Opening::Kind::inflow || rank == 0 ? passed : 0;
    for (Row& row : state.rows) row.owed = *next++;
  }
}

}  // namespace embacle::mps
