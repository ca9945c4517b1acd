#include "coupled_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "fix_floe_create.hpp"
#include "floe_traffic.hpp"
#include "solid_memory.hpp"
#include "stock_access.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::Epoch;
using coupling::SolidLink;

namespace {

/// One open-ended LIGGGHTS run: `run` with a number of steps that is only known as the windows come. Thermo output,
/// dumps and averages work as in one long run.
class OpenEndedRun {
 public:
  explicit OpenEndedRun(LAMMPS* lammps) : lammps_(lammps) {
    Update* update = lammps->update;
    update->whichflag = 1;
    update->nsteps = std::numeric_limits<int>::max();
    update->firststep = update->beginstep = update->ntimestep;
    update->laststep = update->endstep = update->ntimestep + update->nsteps;
    lammps->init();  // the fixes check the script; gravity becomes known
  }

  void start() {
    lammps_->update->integrate->setup();
    lammps_->timer->init();
    lammps_->timer->barrier_start(TIME_LOOP);
  }

  /// Sets up anew amid the run.
  void set_up() { lammps_->update->integrate->setup(); }

  void advance(int steps) { lammps_->update->integrate->run(steps); }

  void finish() {
    Update* update = lammps_->update;
    update->nsteps = static_cast<int>(update->ntimestep - update->firststep);
    update->laststep = update->endstep = update->ntimestep;
    lammps_->timer->barrier_stop(TIME_LOOP);
    update->integrate->cleanup();
    Finish(lammps_).end(1);
    update->whichflag = 0;
    update->firststep = update->laststep = 0;
    update->beginstep = update->endstep = 0;
  }

 private:
  LAMMPS* lammps_;
};

/// This rank's part of space: its subdomain, to infinity where it borders the outside.
coupling::Box own_region(const Domain* domain) {
  coupling::Box box;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    box.lower[k] = domain->sublo[k] <= domain->boxlo[k] ? -infinity : domain->sublo[k];
    box.upper[k] = domain->subhi[k] >= domain->boxhi[k] ? infinity : domain->subhi[k];
  }
  return box;
}

/// Two-dimensional water moves bodies in the plane z = const only.
void keep_in_plane(FixMultisphere* multisphere) {
  bool in_plane[3] = {true, true, false}, about_z[3] = {false, false, true};
  Multisphere& data = multisphere->data();
  for (int i = 0; i < data.n_body(); ++i) {
    data.set_fflag(i, in_plane);
    data.set_tflag(i, about_z);
  }
}

/// Who was there at the last plan. LIGGGHTS drops a body that leaves its box (`boundary f`) without a word.
class RollCall {
 public:
  explicit RollCall(MPI_Comm own) : own_(own) {}

  /// What is to be expected at the next call.
  void expect(const FloeTraffic::Change& change) {
    all_ += change.entered - static_cast<std::int64_t>(change.left.size());
    for (const coupling::BodyTag tag : change.left) last_.erase(tag);
  }

  /// Warns of bodies that are gone since the last call, each by the rank that had it. Collective.
  void check(const std::vector<coupling::SolidBody>& bodies, double time) {
    std::int64_t here = static_cast<std::int64_t>(bodies.size()), all = 0;
    MPI_Allreduce(&here, &all, 1, MPI_INT64_T, MPI_SUM, own_);
    if (all < all_) {
      const std::vector<std::int64_t> present = tags_of_all(bodies);
      for (const auto& [tag, place] : last_) {
        if (std::ranges::find(present, tag) != present.end()) continue;
        fmt::print(
            stderr,
            "liggghts-mps: warning: by t = {:.6g} s body {}, last planned at ({:.5g}, {:.5g}, {:.5g}) m, has left "
            "the solids; the water no longer feels it. Where it was not meant to leave, make the region of "
            "create_box larger, or look for what threw it\n",
            time, tag, place[0], place[1], place[2]);
      }
    }
    all_ = all;
    last_.clear();
    for (const coupling::SolidBody& body : bodies) last_[body.tag] = body.state.position;
  }

 private:
  [[nodiscard]] std::vector<std::int64_t> tags_of_all(const std::vector<coupling::SolidBody>& bodies) const {
    std::vector<std::int64_t> mine(bodies.size());
    std::ranges::transform(bodies, mine.begin(), &coupling::SolidBody::tag);
    int ranks = 1, count = static_cast<int>(mine.size());
    MPI_Comm_size(own_, &ranks);
    std::vector<int> counts(ranks), first(ranks + 1);
    MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, own_);
    for (int r = 0; r < ranks; ++r) first[r + 1] = first[r] + counts[r];
    std::vector<std::int64_t> result(first[ranks]);
    MPI_Allgatherv(mine.data(), count, MPI_INT64_T, result.data(), counts.data(), first.data(), MPI_INT64_T, own_);
    return result;
  }

  MPI_Comm own_;
  std::int64_t all_ = 0;
  std::map<coupling::BodyTag, coupling::Vec3> last_;  ///< of this rank's bodies [m]
};

void count_window(SolidReport& report, const SubSteps& chosen, double window) {
  report.fewest_sub_steps =
      report.windows == 0 ? chosen.count : std::min<std::int64_t>(report.fewest_sub_steps, chosen.count);
  report.most_sub_steps = std::max<std::int64_t>(report.most_sub_steps, chosen.count);
  report.sub_steps += chosen.count;
  report.simulated_seconds += window;
  report.resolved_windows += chosen.count > 1 ? 1 : 0;
  report.skin_limited_windows += chosen.skin_limited ? 1 : 0;
  ++report.windows;
}

/// Of the report, what counts from the first start on.
std::vector<double> progress_of(const SolidReport& report) {
  return {static_cast<double>(report.windows),
          static_cast<double>(report.sub_steps),
          static_cast<double>(report.fewest_sub_steps),
          static_cast<double>(report.most_sub_steps),
          static_cast<double>(report.resolved_windows),
          static_cast<double>(report.skin_limited_windows),
          report.simulated_seconds,
          report.step_seconds};
}

void recall_progress(SolidReport& report, const std::vector<double>& numbers) {
  if (numbers.size() != progress_of(report).size()) return;
  const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(numbers[k]); };
  report.windows = count(0);
  report.sub_steps = count(1);
  report.fewest_sub_steps = count(2);
  report.most_sub_steps = count(3);
  report.resolved_windows = count(4);
  report.skin_limited_windows = count(5);
  report.simulated_seconds = numbers[6];
  report.step_seconds = numbers[7];
}

}  // namespace

void run_coupled(LAMMPS* lammps, FixCoupleMps* fix, const coupling::Participants& participants, MPI_Comm own,
                 const std::string& folder, const coupling::YieldHook& yield, SolidReport& report) {
  if (fix->continues()) {
    fix->check_taken_up();
    recall_progress(report, fix->progress);
  }
  OpenEndedRun run(lammps);
  SolidLink link(participants, own, fix->terms(), yield);
  fix->prepare(link.fluid());
  if (link.fluid().dimension == 2) keep_in_plane(fix->multisphere());

  std::optional<ContactOutlook> outlook;
  // Where a run goes on after a checkpoint, it must go the way of one that continues from it.
  const auto go_on = [&] {
    fix->take_up_forces();
    link.take_up_loads(fix->kept_loads());
    outlook.emplace(lammps, fix->multisphere(), fix->rule());
  };
  if (fix->continues()) {
    fix->take_up_state();
    run.start();
    go_on();
  } else {
    run.start();
    outlook.emplace(lammps, fix->multisphere(), fix->rule());
  }
  const bool parallel = link.fluid().scheme == coupling::Scheme::parallel;
  bool first = !fix->continues();
  RollCall roll_call(own);
  FloeTraffic traffic(lammps, fix->multisphere(), folder, fix->continues(), report.simulated_seconds);
  while (true) {
    if (const auto change = traffic.renew(report.simulated_seconds); change.any()) {
      if (link.fluid().dimension == 2) keep_in_plane(fix->multisphere());
      run.set_up();
      outlook.emplace(lammps, fix->multisphere(), fix->rule());
      roll_call.expect(change);
    }
    const std::vector<coupling::SolidBody> bodies = fix->bodies();
    const Epoch epoch = link.plan(own_region(lammps->domain), bodies);
    roll_call.check(bodies, epoch.time);
    if (epoch.checkpoint) {
      fix->progress = progress_of(report);
      lammps->update->update_time();
      link.give_memory(memory_of(lammps));
      run.set_up();
      go_on();
      continue;
    }
    if (epoch.windows == 0) break;
    if (parallel && first) {  // the load at the start; later windows use the loads of the window before
      link.receive_loads();
      fix->take_loads(link);
    }
    first = false;
    for (int w = 0; w < epoch.windows; ++w) {
      if (!parallel) {
        link.receive_loads();
        fix->take_loads(link);
      }
      const double start = MPI_Wtime();
      fix->begin_window();
      const SubSteps chosen = outlook->choose(epoch.window);
      set_time_step(lammps, epoch.window / chosen.count);
      if (outlook->rebuild_advisable()) fix->request_rebuild(lammps->update->ntimestep + chosen.count);
      run.advance(chosen.count);
      outlook->window_done(epoch.window);
      fix->end_window(epoch.window);
      count_window(report, chosen, epoch.window);
      report.step_seconds += MPI_Wtime() - start;
      link.send_states(fix->bodies());
      if (parallel) {
        link.receive_loads();
        fix->take_loads(link);
      }
    }
  }
  run.finish();
  report.counters = link.counters();
  report.waiting_seconds = report.counters.waiting_seconds;
}

}  // namespace embacle::liggghts
