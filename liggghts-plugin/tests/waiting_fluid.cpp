// A fluid for tests of what happens beside it: shakes hands and runs some windows with no load.
#include <fmt/format.h>
#include <mpi.h>

#include <cstdlib>

#include "embacle/coupling/link.hpp"

using namespace embacle::coupling;

namespace {

void run(int windows) {
  MPI_Comm own = MPI_COMM_NULL;
  Participants participants = split_world(Role::fluid, own);
  FluidTerms terms;
  terms.gravity = Vec3(0, 0, -9.81);
  terms.particle_distance = 0.02;
  terms.reach = 0.1;
  terms.reference_speed = 3;
  FluidLink link(participants, own, terms);
  constexpr double everywhere = 1e9;
  for (int done = 0;;) {
    Epoch proposal;
    proposal.windows = windows - done;
    proposal.window = 1e-3;
    proposal.time = done * proposal.window;
    const Epoch epoch = link.plan({Vec3::Constant(-everywhere), Vec3::Constant(everywhere)}, proposal);
    if (epoch.windows == 0) break;
    for (int w = 0; w < epoch.windows; ++w, ++done) {
      link.send_loads(std::vector<Load>(link.bodies().size()));
      link.receive_states();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int windows = argc > 1 ? std::atoi(argv[1]) : 10;
  try {
    run(windows);
  } catch (const RunError& error) {
    fmt::print(stderr, "the water: error: {}\n", error.what());
    MPI_Abort(MPI_COMM_WORLD, static_cast<int>(error.status()));
  }
  fmt::print("the water ran {} windows\n", windows);
  MPI_Finalize();
}
