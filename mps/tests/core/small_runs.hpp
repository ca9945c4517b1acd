// Short runs for the tests of the core, and what they are compared by.
#pragma once

#include <algorithm>

#include "core/diagnostics.hpp"

namespace embacle::mps::test {

inline void run(Simulation& simulation, int windows) {
  for (int done = 0; done < windows;) {
    const int batch = simulation.begin_epoch(std::min(20, windows - done));
    for (int w = 0; w < batch; ++w) simulation.window();
    done += batch;
  }
}

struct Result {
  WaterState state;
  Triple centre{};
  Audit audit;
};

inline Result result_of(const Scene& scene, MPI_Comm comm, int windows) {
  Simulation simulation(scene, comm, nullptr);
  run(simulation, windows);
  Result result;
  result.state = measure(simulation, scene);
  double sums[3] = {};
  for (std::size_t i = 0; i < simulation.particles().water; ++i) {
    for (int c = 0; c < 3; ++c) sums[c] += simulation.particles().record[i].x[c];
  }
  MPI_Allreduce(sums, result.centre.data(), 3, MPI_DOUBLE, MPI_SUM, comm);
  for (double& c : result.centre) c /= static_cast<double>(result.state.particles);
  result.audit = simulation.worst_audit();
  return result;
}

}  // namespace embacle::mps::test
