// The program `mps`: the water of a scene, alone or coupled with LIGGGHTS on other ranks of the same mpirun.
#include <fmt/format.h>
#include <mpi.h>

#include "core/application.hpp"
#include "scene/reader.hpp"

namespace {

using embacle::mps::Options;

/// Returns the status of the program.
int run(const Options& options, int rank) {
  namespace coupling = embacle::coupling;
  const embacle::mps::Scene scene = embacle::mps::read_scene(options.scene, options.overrides);
  embacle::mps::check_restart(scene, options);
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  switch (options.task) {
    case Options::Task::check:
      if (rank == 0)
        fmt::print("{}", embacle::mps::check_report(scene, options.planned_ranks > 0 ? options.planned_ranks : ranks));
      return 0;
    case Options::Task::explain:
      if (rank == 0) fmt::print("{}", embacle::mps::explain_report(scene));
      return 0;
    case Options::Task::launch:
      if (rank == 0) fmt::print("{}", embacle::mps::launch_report(scene));
      return 0;
    default:
      break;
  }
  MPI_Comm own = MPI_COMM_NULL;
  coupling::Participants participants;
  participants = coupling::split_world(coupling::Role::fluid, own);
  if (scene.coupled() && participants.solid_ranks.empty()) {
    throw coupling::InputError(
        fmt::format("{} has solids ({}), but no liggghts-mps runs in this mpirun; start it with './embacle run' or as "
                    "'mpirun -n F mps ... : -n S liggghts-mps -in {}'",
                    scene.file.string(), scene.coupling.script.filename().string(), scene.coupling.script.string()));
  }
  embacle::mps::Outcome outcome =
      embacle::mps::run_water(scene, options, scene.coupled() ? &participants : nullptr, own);
  embacle::mps::Json& summary = outcome.summary;
  int own_rank = 0;
  MPI_Comm_rank(own, &own_rank);
  if (own_rank == 0) {
    summary.set("layout", scene.coupled() ? "separate" : "fluid only");
    if (scene.coupled()) {
      embacle::mps::Json& link = summary.object("coupling");
      link.set("waiting_share_of_wall_time",
               link.number("waiting_seconds_mean_per_rank") / summary.number("wall_seconds"));
    }
    summary.set("solid_ranks", static_cast<std::int64_t>(participants.solid_ranks.size()));
    embacle::mps::write_json(options.out / "summary.json", summary);
    fmt::print("{}", outcome.farewell);
  }
  return own_rank == 0 ? outcome.status : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = embacle::mps::parse_options(
        argc, argv, "mps", "Weakly compressible MPS: free-surface water, alone or coupled with LIGGGHTS bodies");
    if (options.task == Options::Task::leave) return 0;
    if (options.task == Options::Task::reference) {
      fmt::print("{}", embacle::mps::scene_reference());
      return 0;
    }
    int provided = 0;  // a rank's threads share its loops; only its first one speaks to others
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    const int status = run(options, rank);
    MPI_Finalize();
    return status;
  } catch (const std::exception& error) {
    embacle::mps::end_run("mps", error);
  }
}
