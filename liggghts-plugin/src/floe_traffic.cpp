#include "floe_traffic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "bodies.hpp"
#include "floe_checks.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

namespace {

/// Drops the rows of a table that are later than a time.
void drop_rows_after(const std::filesystem::path& path, double time) {
  std::ifstream in(path);
  std::string kept, line;
  while (std::getline(in, line)) {
    char* end = nullptr;
    const double at = std::strtod(line.c_str(), &end);
    if (end == line.c_str() || at <= time + 1e-8 * (1 + time)) kept += line + "\n";
  }
  in.close();
  std::ofstream(path) << kept;
}

}  // namespace

FloeTraffic::FloeTraffic(LAMMPS* lammps, FixMultisphere* multisphere, const std::filesystem::path& folder,
                         bool continues, double time)
    : lammps_(lammps), multisphere_(multisphere) {
  for (int i = 0; i < lammps->modify->nfix; ++i) {
    Fix* fix = lammps->modify->fix[i];
    if (auto* source = dynamic_cast<FixFloeCreate*>(fix)) sources_.push_back(source);
    if (const auto* outlet = dynamic_cast<const FixFloeOutlet*>(fix)) outlets_.push_back(outlet);
  }
  const bool scheduled = std::ranges::any_of(sources_, [](auto* source) { return !source->schedule().empty(); });
  if (!scheduled && outlets_.empty()) {
    sources_.clear();
    return;
  }
  at_start_ = multisphere->n_body_all();
  last_tag_ = std::max(0, multisphere->data().tag_max_body());
  if (const auto& kept = sources_.front()->traffic; continues && kept.size() == 4) {
    at_start_ = static_cast<std::int64_t>(kept[0]);
    entered_ = static_cast<std::int64_t>(kept[1]);
    left_ = static_cast<std::int64_t>(kept[2]);
    last_tag_ = static_cast<int>(kept[3]);
  }
  if (folder.empty() || lammps->comm->me != 0) return;
  file_ = folder / "floes.csv";
  if (continues && std::filesystem::exists(file_)) {
    drop_rows_after(file_, time);
  } else {
    std::ofstream(file_) << "t [s], at start [-], entered [-], present [-], left [-], waiting [-]\n";
    write(time);
  }
}

std::vector<coupling::BodyTag> FloeTraffic::beyond_outlets() const {
  std::vector<double> mine;
  for (const auto& body : owned_bodies(lammps_, multisphere_)) {
    if (std::ranges::any_of(outlets_, [&](auto* outlet) { return outlet->beyond(body.state.position); }))
      mine.push_back(static_cast<double>(body.tag));
  }
  std::vector<coupling::BodyTag> all;
  for (const double tag : gather_on_all(lammps_->world, mine)) all.push_back(static_cast<coupling::BodyTag>(tag));
  return all;
}

/// Histories of contacts are in the neighbour lists, by the places of atoms there: before those change they must be
/// moved to the atoms, and the set-up that follows finds them there.
void FloeTraffic::keep_histories() { lammps_->modify->setup_pre_exchange(); }

/// Who finds the place taken, by a body that is there or by one that enters at the same time, waits.
int FloeTraffic::admit(double time) {
  std::vector<PlacedFloe> present;
  bool gathered = false;
  int count = 0;
  for (FixFloeCreate* source : sources_) {
    const std::vector<std::int64_t> due = source->schedule().due(time);
    if (due.empty()) continue;
    if (!gathered) {
      const auto shapes = floe_shapes(lammps_);
      for (const auto& body : gather_bodies(lammps_, multisphere_)) {
        if (body.shape >= 0) present.push_back({shapes[body.shape], body.state, ""});
      }
      gathered = true;
    }
    std::vector<Floe> entering;
    for (const std::int64_t entry : due) {
      const Floe& floe = source->list().floes[source->schedule().floe(entry)];
      const PlacedFloe candidate{&source->list().shapes[floe.shape], floe.state, ""};
      if (std::ranges::any_of(present, [&](const PlacedFloe& other) { return overlap_depth(candidate, other) > 0; }))
        continue;
      present.push_back(candidate);
      entering.push_back(floe);
      source->schedule().entered(entry);
    }
    if (entering.empty()) continue;
    keep_histories();
    last_tag_ = source->add(entering, last_tag_);
    count += static_cast<int>(entering.size());
  }
  return count;
}

FloeTraffic::Change FloeTraffic::renew(double time) {
  Change change;
  if (sources_.empty()) return change;
  std::size_t waiting_before = 0, waiting = 0;
  for (FixFloeCreate* source : sources_) waiting_before += source->schedule().waiting();
  change.left = beyond_outlets();
  if (!change.left.empty()) {
    keep_histories();
    remove_bodies(lammps_, multisphere_, change.left);
  }
  change.entered = admit(time);
  entered_ += change.entered;
  left_ += static_cast<std::int64_t>(change.left.size());
  sources_.front()->traffic = {static_cast<double>(at_start_), static_cast<double>(entered_),
                               static_cast<double>(left_), static_cast<double>(last_tag_)};
  for (FixFloeCreate* source : sources_) waiting += source->schedule().waiting();
  if (change.any() || waiting != waiting_before) write(time);
  return change;
}

void FloeTraffic::write(double time) const {
  if (file_.empty()) return;
  std::size_t waiting = 0;
  for (FixFloeCreate* source : sources_) waiting += source->schedule().waiting();
  std::ofstream(file_, std::ios::app) << fmt::format("{:.9g}, {}, {}, {}, {}, {}\n", time, at_start_, entered_,
                                                     multisphere_->n_body_all(), left_, waiting);
}

}  // namespace embacle::liggghts
