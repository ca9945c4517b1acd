// The lists of FloeContacts: near pairs, what crosses ranks, and what contacts remember when bodies change owners.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "contact/floe_contacts.hpp"
#include "contact/near_pairs.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::BodyTag;
using coupling::Vec3;

namespace {

constexpr int record_size = 3 + contact_memory_size;

template <typename Key>
void write_record(std::vector<double>& numbers, const Key& key, const ContactMemory& memory) {
  for (const BodyTag part : key) numbers.push_back(static_cast<double>(part));
  const auto values = std::bit_cast<std::array<double, contact_memory_size>>(memory);
  numbers.insert(numbers.end(), values.begin(), values.end());
}

}  // namespace

void FloeContacts::collect(std::map<Key, ContactMemory>& memories) const {
  for (const Pair& pair : pairs_) {
    if (pair.memory.touching > 0) memories[{bodies_[pair.first].tag, bodies_[pair.second].tag, 0}] = pair.memory;
  }
  for (const WallPair& pair : wall_pairs_) {
    for (int direction = 0; direction < 6; ++direction) {
      if (pair.memory[direction].touching == 0) continue;
      memories[{bodies_[pair.body].tag, -1 - pair.wall, direction}] = pair.memory[direction];
    }
  }
}

FloeContacts::Memory FloeContacts::memory() const {
  int rank = 0;
  MPI_Comm_rank(lammps_->world, &rank);
  std::map<Key, ContactMemory> memories;
  collect(memories);
  std::vector<double> mine;
  for (const auto& [key, memory] : memories) write_record(mine, key, memory);
  Memory all{gather_on_all(lammps_->world, mine), gather_on_all(lammps_->world, last_forces())};
  return rank == 0 ? all : Memory{};
}

std::vector<double> FloeContacts::last_forces() const {
  std::vector<double> numbers;
  for (std::size_t b = 0; b < last_.size(); ++b) {
    numbers.push_back(static_cast<double>(bodies_[b].tag));
    for (const Vec3* part : {&last_[b].place, &last_[b].force, &last_[b].torque}) {
      numbers.insert(numbers.end(), part->data(), part->data() + 3);
    }
  }
  return numbers;
}

void FloeContacts::take_up_forces(const std::vector<double>& records) {
  std::map<BodyTag, LastForce> known;
  for (std::size_t at = 0; at + 10 <= records.size(); at += 10) {
    const auto part = [&](int k) { return Vec3(records[at + k], records[at + k + 1], records[at + k + 2]); };
    known[static_cast<BodyTag>(records[at])] = {part(1), part(4), part(7)};
  }
  last_.assign(owned_, LastForce{});
  for (std::size_t b = 0; b < owned_; ++b) {
    const auto found = known.find(bodies_[b].tag);
    if (found != known.end()) last_[b] = found->second;
  }
}

void FloeContacts::build_lists() {
  gravity_ = gravity_of(lammps_).norm();  // known from the first set-up on
  std::map<Key, ContactMemory> memories;
  collect(memories);
  // Only a set-up asks for the forces of the step before.
  const bool setting_up = lammps_->update->setupflag != 0;
  std::vector<double> forces = setting_up ? gather_on_all(lammps_->world, last_forces()) : std::vector<double>{};
  forces.insert(forces.end(), remembered_.forces.begin(), remembered_.forces.end());
  std::map<BodyTag, int> old_owners;
  for (const Body& body : bodies_) old_owners[body.tag] = body.owner;

  find_owned();
  take_up_forces(forces);
  MPI_Comm world = lammps_->world;
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  std::vector<double> mine;
  for (Body& body : bodies_) {
    multisphere_->data().xcm(body.motion.position.data(), body.local);
    const Vec3& x = body.motion.position;
    mine.insert(mine.end(), {static_cast<double>(body.tag), static_cast<double>(body.shape), static_cast<double>(rank),
                             x.x(), x.y(), x.z()});
  }
  const std::vector<double> all = gather_on_all(world, mine);
  std::map<BodyTag, int> owners;
  std::vector<Body> others;
  for (std::size_t at = 0; at < all.size(); at += 6) {
    Body body;
    body.tag = static_cast<BodyTag>(all[at]);
    body.shape = static_cast<int>(all[at + 1]);
    body.owner = static_cast<int>(all[at + 2]);
    body.motion.position = Vec3(all[at + 3], all[at + 4], all[at + 5]);
    owners[body.tag] = body.owner;
    if (body.owner != rank) others.push_back(body);
  }
  std::sort(others.begin(), others.end(), [](const Body& a, const Body& b) { return a.tag < b.tag; });

  // Bodies move by at most about half a skin until the next lists.
  const double margin = 2 * lammps_->neighbor->skin;
  std::vector<Vec3> centres;
  std::vector<double> reaches;
  for (const auto* list : {&bodies_, &others}) {
    for (const Body& body : *list) {
      centres.push_back(body.motion.position);
      reaches.push_back(materials_[body.shape].shape.reach);
    }
  }
  const Domain* domain = lammps_->domain;
  Vec3 period = Vec3::Zero();
  const Vec3 extent(domain->xprd, domain->yprd, domain->zprd);
  for (int k = 0; k < 3; ++k) period[k] = domain->periodicity[k] ? extent[k] : 0;
  const auto near = near_pairs(centres, reaches, owned_, margin, period);

  // Of the others, those in a pair; both ranks of a pair find it, so each knows what the other needs.
  std::vector<int> place(others.size(), -1);
  std::map<int, std::pair<std::vector<int>, std::vector<int>>> traffic;  // by rank: to send, to receive
  for (const auto& [i, j] : near) {
    if (j < static_cast<int>(owned_)) continue;
    const std::size_t other = j - owned_;
    auto& [send, receive] = traffic[others[other].owner];
    send.push_back(i);
    if (place[other] < 0) place[other] = 0;
  }
  for (std::size_t other = 0; other < others.size(); ++other) {
    if (place[other] < 0) continue;
    place[other] = static_cast<int>(bodies_.size());
    traffic[others[other].owner].second.push_back(place[other]);
    bodies_.push_back(others[other]);
  }
  exchanges_.clear();
  for (auto& [other_rank, lists] : traffic) {
    auto& send = lists.first;
    std::sort(send.begin(), send.end());
    send.erase(std::unique(send.begin(), send.end()), send.end());
    exchanges_.push_back({other_rank, send, lists.second, {}, {}});
  }

  // Memories follow bodies to new owners.
  std::vector<double> moving;
  for (const auto& [key, memory] : memories) {
    const auto changed = [&](BodyTag tag) {
      const auto before = old_owners.find(tag), now = owners.find(tag);
      return before != old_owners.end() && now != owners.end() && before->second != now->second;
    };
    if (changed(key[0]) || changed(key[1])) write_record(moving, key, memory);
  }
  moving = gather_on_all(world, moving);
  moving.insert(moving.end(), remembered_.contacts.begin(), remembered_.contacts.end());
  remembered_ = Memory{};
  for (std::size_t at = 0; at < moving.size(); at += record_size) {
    Key key;
    for (int k = 0; k < 3; ++k) key[k] = static_cast<BodyTag>(moving[at + k]);
    std::array<double, contact_memory_size> values{};
    std::copy_n(moving.data() + at + 3, contact_memory_size, values.begin());
    memories[key] = std::bit_cast<ContactMemory>(values);
  }

  pairs_.clear();
  for (auto [i, j] : near) {
    if (j >= static_cast<int>(owned_)) j = place[j - owned_];
    if (bodies_[i].tag > bodies_[j].tag) std::swap(i, j);
    const auto known = memories.find({bodies_[i].tag, bodies_[j].tag, 0});
    pairs_.push_back({i, j, known == memories.end() ? ContactMemory{} : known->second, 0});
  }
  std::sort(pairs_.begin(), pairs_.end(), [this](const Pair& a, const Pair& b) {
    return std::pair(bodies_[a.first].tag, bodies_[a.second].tag) <
           std::pair(bodies_[b.first].tag, bodies_[b.second].tag);
  });
  find_wall_pairs(margin);
  for (WallPair& pair : wall_pairs_) {
    for (int direction = 0; direction < 6; ++direction) {
      const auto known = memories.find({bodies_[pair.body].tag, -1 - pair.wall, direction});
      if (known != memories.end()) pair.memory[direction] = known->second;
    }
  }
}

void FloeContacts::find_wall_pairs(double margin) {
  wall_pairs_.clear();
  // By place along x, to find the bodies near a triangle.
  std::vector<int> order(owned_);
  double widest = 0;
  for (std::size_t b = 0; b < owned_; ++b) {
    order[b] = static_cast<int>(b);
    widest = std::max(widest, materials_[bodies_[b].shape].shape.reach + margin);
  }
  const auto along_x = [this](int b) { return bodies_[b].motion.position.x(); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return along_x(a) < along_x(b); });
  for (int w = 0; w < static_cast<int>(walls_.size()); ++w) {
    const Wall& wall = walls_[w];
    if (!wall.mesh) {
      for (std::size_t b = 0; b < owned_; ++b) {
        const double height = bodies_[b].motion.position[wall.axis] - wall.place;
        if (std::abs(height) < materials_[bodies_[b].shape].shape.reach + margin) {
          wall_pairs_.push_back({static_cast<int>(b), w, {}, {}});
        }
      }
      continue;
    }
    std::vector<std::vector<int>> triangles(owned_);
    TriMesh* mesh = wall.mesh->triMesh();
    for (int t = 0; t < mesh->sizeLocal() + mesh->sizeGhost(); ++t) {
      coupling::Triangle triangle;
      for (int k = 0; k < 3; ++k) mesh->node(t, k, triangle[k].data());
      const coupling::Box box{triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]),
                              triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2])};
      auto at = std::lower_bound(order.begin(), order.end(), box.lower.x() - widest,
                                 [&](int b, double x) { return along_x(b) < x; });
      for (; at != order.end() && along_x(*at) <= box.upper.x() + widest; ++at) {
        const Body& body = bodies_[*at];
        if (box.distance(body.motion.position) < materials_[body.shape].shape.reach + margin) {
          triangles[*at].push_back(t);
        }
      }
    }
    for (std::size_t b = 0; b < owned_; ++b) {
      if (!triangles[b].empty()) wall_pairs_.push_back({static_cast<int>(b), w, std::move(triangles[b]), {}});
    }
  }
  std::sort(wall_pairs_.begin(), wall_pairs_.end(), [this](const WallPair& a, const WallPair& b) {
    return std::pair(bodies_[a.body].tag, a.wall) < std::pair(bodies_[b.body].tag, b.wall);
  });
}

}  // namespace embacle::liggghts
