#include "core/halo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace embacle::mps {

namespace {

constexpr int count_tag = 100;
constexpr int particle_tag = 200;
constexpr int update_tag = 300;

/// Tells the messages between the same two ranks apart: added to the tag of what is displaced by `image`.
int tag_of(const std::array<int, 3>& image, int sign) { return sign * (image[0] + 3 * image[1] + 9 * image[2]) + 13; }
int sent(const Nearby& partner) { return tag_of(partner.image, 1); }
int received(const Nearby& partner) { return tag_of(partner.image, -1); }

static_assert(sizeof(Record) == 8 * sizeof(double));
static_assert(std::is_trivially_copyable_v<Traveller>);

/// Exchanges vectors of travellers with the partners; returns what was received, in the order of the partners.
std::vector<std::vector<Traveller>> exchange(MPI_Comm comm, const std::vector<Nearby>& partners,
                                             const std::vector<std::vector<Traveller>>& outgoing) {
  const std::size_t n = partners.size();
  std::vector<int> send_count(n), receive_count(n);
  std::vector<MPI_Request> requests(2 * n);
  for (std::size_t k = 0; k < n; ++k) {
    send_count[k] = static_cast<int>(outgoing[k].size());
    const Nearby& partner = partners[k];
    MPI_Irecv(&receive_count[k], 1, MPI_INT, partner.rank, count_tag + received(partner), comm, &requests[2 * k]);
    MPI_Isend(&send_count[k], 1, MPI_INT, partner.rank, count_tag + sent(partner), comm, &requests[2 * k + 1]);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  std::vector<std::vector<Traveller>> incoming(n);
  requests.clear();
  for (std::size_t k = 0; k < n; ++k) {
    incoming[k].resize(receive_count[k]);
    if (receive_count[k] > 0) {
      MPI_Irecv(incoming[k].data(), static_cast<int>(receive_count[k] * sizeof(Traveller)), MPI_BYTE, partners[k].rank,
                particle_tag + received(partners[k]), comm, &requests.emplace_back());
    }
    if (send_count[k] > 0) {
      MPI_Isend(outgoing[k].data(), static_cast<int>(send_count[k] * sizeof(Traveller)), MPI_BYTE, partners[k].rank,
                particle_tag + sent(partners[k]), comm, &requests.emplace_back());
    }
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

std::vector<Traveller> joined(const std::vector<std::vector<Traveller>>& groups) {
  std::vector<Traveller> result;
  for (const auto& group : groups) result.insert(result.end(), group.begin(), group.end());
  return result;
}

double distance_to_box(const Box& box, const double* x) {
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    const double outside = std::max({0.0, box.lower[c] - x[c], x[c] - box.upper[c]});
    square += outside * outside;
  }
  return std::sqrt(square);
}

}  // namespace

void Halo::migrate(const Decomposition& decomposition, double reach, bool anywhere,
                   std::vector<Traveller>& travellers) const {
  int rank = 0, size = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &size);
  if (size == 1) return;
  std::vector<Nearby> partners;
  if (anywhere) {
    for (int r = 0; r < size; ++r) {
      if (r != rank) partners.push_back({r, {}});
    }
  } else {
    for (const int r : decomposition.neighbours(reach)) partners.push_back({r, {}});
  }
  std::vector<int> slot(size, -1);
  for (std::size_t k = 0; k < partners.size(); ++k) slot[partners[k].rank] = static_cast<int>(k);
  std::vector<std::vector<Traveller>> outgoing(partners.size());
  std::vector<Traveller> kept;
  kept.reserve(travellers.size());
  for (const Traveller& traveller : travellers) {
    const double* x = traveller.record.x;
    const int owner = decomposition.owner(x, rank);
    if (owner == rank) {
      kept.push_back(traveller);
    } else if (owner >= 0 && slot[owner] >= 0) {
      outgoing[slot[owner]].push_back(traveller);
    } else {
      throw coupling::InstabilityError(
          fmt::format("particle {} jumped to ({:.4g}, {:.4g}, {:.4g}) m, beyond the neighbouring ranks",
                      traveller.identity.id, x[0], x[1], x[2]));
    }
  }
  for (const auto& incoming : exchange(comm_, partners, outgoing)) {
    kept.insert(kept.end(), incoming.begin(), incoming.end());
  }
  travellers = std::move(kept);
}

std::vector<Traveller> Halo::exchange_water(const Decomposition& decomposition, double reach,
                                            const Particles& particles) {
  links_.clear();
  partners_ = decomposition.nearby(reach);
  std::vector<std::vector<Traveller>> outgoing(partners_.size());
  for (std::size_t k = 0; k < partners_.size(); ++k) {
    Link link;
    link.partner = partners_[k];
    link.displaced = link.partner.image != std::array<int, 3>{};
    for (int c = 0; c < 3; ++c) link.shift[c] = link.partner.image[c] * decomposition.periodic().length[c];
    const Box& box = decomposition.boxes()[link.partner.rank];
    for (std::uint32_t i = 0; i < particles.water; ++i) {
      if (!add_if_near(link, box, reach, {particles.record[i], particles.identity[i]}, outgoing[k])) continue;
      link.send_water.push_back(i);
    }
    links_.push_back(std::move(link));
  }
  const auto incoming = exchange(comm_, partners_, outgoing);
  for (std::size_t k = 0; k < links_.size(); ++k) links_[k].receive_water = incoming[k].size();
  return joined(incoming);
}

std::vector<Traveller> Halo::exchange_solid(const Decomposition& decomposition, double reach,
                                            const std::vector<Traveller>& solid, std::size_t first_index) {
  std::vector<std::vector<Traveller>> outgoing(links_.size());
  for (std::size_t k = 0; k < links_.size(); ++k) {
    const Box& box = decomposition.boxes()[links_[k].partner.rank];
    for (std::size_t j = 0; j < solid.size(); ++j) {
      if (!add_if_near(links_[k], box, reach, solid[j], outgoing[k])) continue;
      links_[k].send_solid.push_back(static_cast<std::uint32_t>(first_index + j));
    }
  }
  const auto incoming = exchange(comm_, partners_, outgoing);
  for (std::size_t k = 0; k < links_.size(); ++k) links_[k].receive_solid = incoming[k].size();
  return joined(incoming);
}

bool Halo::add_if_near(const Link& link, const Box& box, double reach, Traveller traveller,
                       std::vector<Traveller>& outgoing) {
  for (int c = 0; c < 3; ++c) traveller.record.x[c] += link.shift[c];
  if (distance_to_box(box, traveller.record.x) > reach) return false;
  outgoing.push_back(traveller);
  return true;
}

void Halo::assemble(const Particles& particles) {
  std::size_t next_water = particles.ghosts_begin();
  std::size_t next_solid = particles.ghost_solid_begin();
  for (Link& link : links_) {
    link.receive_water_begin = next_water;
    link.receive_solid_begin = next_solid;
    next_water += link.receive_water;
    next_solid += link.receive_solid;
  }
}

void Halo::update_motion(Particles& particles) {
  start({particles.record.front().x, 8, 6, true, true, true});
  finish();
}
void Halo::start_water_state(Particles& particles) { start({&particles.record.front().p, 8, 2, true, false, false}); }
void Halo::start_solid_pressure(Particles& particles) {
  start({&particles.record.front().p, 8, 1, false, true, false});
}

void Halo::start(const Columns& columns) {
  columns_ = columns;
  const int width = columns.width;
  const bool water = columns.water, solid = columns.solid;
  requests_.clear();
  const std::size_t bytes = width * sizeof(double);
  const auto field = [&columns](std::size_t i) { return columns.first + i * columns.stride; };
  for (Link& link : links_) {
    const std::size_t incoming = (water ? link.receive_water : 0) + (solid ? link.receive_solid : 0);
    link.receive_buffer.resize(incoming * width);
    if (incoming > 0) {
      MPI_Irecv(link.receive_buffer.data(), static_cast<int>(incoming * width), MPI_DOUBLE, link.partner.rank,
                update_tag + received(link.partner), comm_, &requests_.emplace_back());
    }
  }
  for (Link& link : links_) {
    const std::size_t outgoing = (water ? link.send_water.size() : 0) + (solid ? link.send_solid.size() : 0);
    link.send_buffer.resize(outgoing * width);
    double* out = link.send_buffer.data();
    const auto pack = [&, displaced = columns.positions && link.displaced](const std::vector<std::uint32_t>& list) {
      for (const std::uint32_t i : list) {
        std::memcpy(out, field(i), bytes);
        if (displaced) {
          for (int c = 0; c < 3; ++c) out[c] += link.shift[c];
        }
        out += width;
      }
    };
    if (water) pack(link.send_water);
    if (solid) pack(link.send_solid);
    if (outgoing > 0) {
      MPI_Isend(link.send_buffer.data(), static_cast<int>(outgoing * width), MPI_DOUBLE, link.partner.rank,
                update_tag + sent(link.partner), comm_, &requests_.emplace_back());
      ++messages_sent_;
      bytes_sent_ += static_cast<std::int64_t>(outgoing * bytes);
    }
  }
}

void Halo::finish() {
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  const std::size_t width = columns_.width;
  for (const Link& link : links_) {
    const double* in = link.receive_buffer.data();
    const auto unpack = [&](std::size_t begin, std::size_t count) {
      for (std::size_t i = begin; i < begin + count; ++i, in += width)
        std::memcpy(columns_.first + i * columns_.stride, in, width * sizeof(double));
    };
    if (columns_.water) unpack(link.receive_water_begin, link.receive_water);
    if (columns_.solid) unpack(link.receive_solid_begin, link.receive_solid);
  }
}

}  // namespace embacle::mps
