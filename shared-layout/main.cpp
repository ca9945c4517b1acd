// embacle-shared: the shared layout. Every rank carries a piece of the water and a piece of the solids, which take
// turns (coupling/turnstile.hpp), so that no rank waits for ranks of the other kind.
#include <fmt/format.h>
#include <mpi.h>

#include <algorithm>
#include <filesystem>

#include "core/application.hpp"
#include "embacle/coupling/turnstile.hpp"
#include "embacle/liggghts/driver.hpp"
#include "scene/reader.hpp"

namespace {

using namespace embacle;
namespace fs = std::filesystem;

std::vector<std::string> liggghts_arguments(const mps::Scene& scene, const fs::path& folder) {
  std::vector<std::string> arguments{"-in",          scene.coupling.script.string(),     "-screen", "/dev/null",
                                     "-log",         (folder / "log.liggghts").string(), "-var",    "out",
                                     folder.string()};
  for (const auto& [name, value] : scene.coupling.variables) {
    arguments.insert(arguments.end(), {"-var", name, value});
  }
  return arguments;
}

/// Returns the status of the program.
int run(mps::Options options) {
  const mps::Scene scene = mps::read_scene(options.scene, options.overrides);
  mps::check_restart(scene, options);
  if (!scene.coupled()) {
    throw coupling::InputError(scene.file.string() + ": the scene has no solids (coupling.script); run it with mps");
  }
  const fs::path folder = options.out = fs::absolute(options.out);
  fs::create_directories(folder);
  fs::current_path(scene.coupling.script.parent_path());  // the script names its files from its own folder

  MPI_Comm fluid = MPI_COMM_NULL, solid = MPI_COMM_NULL;
  const coupling::Participants participants = coupling::share_world(fluid, solid);
  mps::Outcome outcome;
  liggghts::SolidReport report;
  coupling::Turnstile turnstile;
  const auto yield = [&] { turnstile.yield(); };
  turnstile.run([&] { outcome = mps::run_water(scene, options, &participants, fluid, yield); },
                [&] { liggghts::run_liggghts(participants, solid, liggghts_arguments(scene, folder), report, yield); });

  int rank = 0, ranks = 1;
  MPI_Comm_rank(fluid, &rank);
  MPI_Comm_size(fluid, &ranks);
  double seconds[2] = {report.step_seconds, report.script_seconds};
  MPI_Allreduce(MPI_IN_PLACE, seconds, 2, MPI_DOUBLE, MPI_SUM, fluid);
  if (rank == 0) {
    mps::Json& summary = outcome.summary;
    summary.set("layout", "shared").set("solid_ranks", ranks);
    mps::Json& part = summary.object("solid");
    part.set("step_seconds_mean_per_rank", seconds[0] / ranks).set("script_seconds_mean_per_rank", seconds[1] / ranks);
    // Of the water's waiting for states, what the solids of this rank did not use themselves is waiting for other
    // ranks.
    const double wall = summary.number("wall_seconds");
    part.set("share_of_wall_time", seconds[0] / ranks / wall);
    part.set("bodies", report.bodies).set("covering_spheres", report.covering_spheres);
    part.set("sub_steps", report.sub_steps).set("sub_steps_mean", report.mean_sub_steps());
    part.set("sub_steps_most", report.most_sub_steps).set("resolved_windows", report.resolved_windows);
    mps::Json& link = summary.object("coupling");
    link.set("waiting_share_of_wall_time",
             std::max(0.0, link.number("waiting_seconds_mean_per_rank") - (seconds[0] + seconds[1]) / ranks) / wall);
    mps::write_json(folder / "summary.json", summary);
    fmt::print("{}", outcome.farewell);
  }
  return rank == 0 ? outcome.status : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const mps::Options options = mps::parse_options(
        argc, argv, "embacle-shared", "A coupled scene in the shared layout: every rank carries water and solids");
    if (options.task == mps::Options::Task::leave) return 0;
    if (options.task != mps::Options::Task::run) {
      throw coupling::InputError("--check, --explain, --launch and --reference are tasks of mps");
    }
    int provided = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
    if (provided < MPI_THREAD_SERIALIZED) {
      throw coupling::SystemError("this MPI does not let two threads take turns (MPI_THREAD_SERIALIZED)");
    }
    const int status = run(options);
    MPI_Finalize();
    return status;
  } catch (const std::exception& error) {
    mps::end_run("embacle-shared", error);
  }
}
