// liggghts-mps: LIGGGHTS with the command line of `liggghts`, as the solid side of a coupled run.
#include <fmt/format.h>
#include <mpi.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "embacle/liggghts/driver.hpp"
#include "template_file.hpp"

using namespace embacle;

namespace {

constexpr const char* usage = R"(liggghts-mps: LIGGGHTS with Embacle's styles, as the solid side of a coupled run

  mpirun -n F mps SCENE : -n S liggghts-mps -in SCRIPT [options of liggghts]
  mpirun -n S liggghts-mps -in SCRIPT [options of liggghts]        solids alone

The script is read first and does what it says; if it contains 'fix ID all couple/mps', the coupled run follows and ends
when the fluid ends. Options are those of liggghts, among them
  -in FILE           the script
  -var NAME VALUE    a variable of the script; with -var out DIR, DIR/solid-summary.json is written
  -log FILE|none     the log file (log.liggghts)
  -screen FILE|none  where the screen output goes
  -echo WHERE        none, screen, log, both
  --help, --version

  liggghts-mps --template NAME shape ... density D spacing S|spheres N [id ID] [type N] [seed N] [...]

writes a shape as a multisphere template of stock LIGGGHTS, for insert/pack and insert/stream: NAME.spheres and the
command NAME.template, which a script includes. Keywords are those of fix floe/create; see docs/liggghts.
Exit status: 0 done; 2 the input is wrong; 3 the simulation broke; 4 the machine failed; 1 an error of the program.
)";

/// Ends all programs of the run. An error that all ranks have met is printed by the first alone; one that the other
/// ranks do not know of, by the rank that met it.
[[noreturn]] void end_run(MPI_Comm own, const std::string& message, coupling::ExitStatus status) {
  int rank = 0, everyone = 0;
  MPI_Comm_rank(own, &rank);
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(own, &request);
  for (const double start = MPI_Wtime(); !everyone && MPI_Wtime() - start < 1.0;) {
    MPI_Test(&request, &everyone, MPI_STATUS_IGNORE);
  }
  // An error of the handshake is found by both sides: the one that holds the first rank of all speaks and ends the run.
  int world_rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &world_rank);
  if (everyone && world_rank != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  if (rank == 0 || !everyone) {
    fmt::print(stderr, "liggghts-mps: error: {}\n", message);
    std::fflush(stderr);
  }
  if (everyone) {  // nobody may end the run before the first rank has printed
    MPI_Barrier(own);
  }
  MPI_Abort(MPI_COMM_WORLD, static_cast<int>(status));
  std::abort();
}

/// Writes a multisphere template; needs no MPI. Returns the exit status.
int template_mode(const std::vector<std::string>& words) {
  try {
    const liggghts::TemplateFile file = liggghts::read_template(words);
    liggghts::write_template(file);
    fmt::print("{}wrote {}.spheres and {}.template\n", liggghts::covering_report(file.shape), file.name, file.name);
    return 0;
  } catch (const coupling::RunError& error) {
    fmt::print(stderr, "liggghts-mps: error: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && arguments.front() == "--template") {
    return template_mode({arguments.begin() + 1, arguments.end()});
  }
  for (const std::string& argument : arguments) {
    if (argument == "--help" || argument == "-h") {
      fmt::print("{}", usage);
      return 0;
    }
    if (argument == "--version") {
      fmt::print("liggghts-mps {}\n", EMBACLE_VERSION);
      return 0;
    }
  }
  MPI_Init(&argc, &argv);
  MPI_Comm own = MPI_COMM_NULL;
  coupling::Participants participants;
  try {
    participants = coupling::split_world(coupling::Role::solid, own);
    // The fluid decides when a coupled run ends, also after a signal: it tells the solids through the plan.
    std::signal(SIGTERM, SIG_IGN);
    std::signal(SIGUSR1, SIG_IGN);
  } catch (const coupling::InputError&) {
    // Alone, which is right for a script without coupling; run_liggghts rejects a script with it.
    participants = {};
    MPI_Comm_dup(MPI_COMM_WORLD, &own);
  }
  try {
    liggghts::SolidReport report;
    const int status = liggghts::run_liggghts(participants, own, arguments, report);
    MPI_Finalize();
    return status;
  } catch (const coupling::RunError& error) {
    end_run(own, error.what(), error.status());
  } catch (const std::exception& error) {
    end_run(own, fmt::format("internal error: {}", error.what()), coupling::ExitStatus::internal);
  }
}
