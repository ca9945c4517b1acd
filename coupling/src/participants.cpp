// Who takes part: the ranks of both sides and their private communicators.
#include <fmt/format.h>
#include <mpi.h>

#include <array>

#include "embacle/coupling/link.hpp"
#include "local_order.hpp"

namespace embacle::coupling {

Participants split_world(Role role, MPI_Comm& own) {
  int rank = 0;
  int size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);

  // This first message must never change, so that programs of any two versions understand each other's version.
  const std::array<int, 2> mine{static_cast<int>(role), protocol_version};
  std::vector<std::array<int, 2>> all(static_cast<std::size_t>(size));
  MPI_Allgather(mine.data(), 2, MPI_INT, all.data(), 2, MPI_INT, MPI_COMM_WORLD);

  Participants result;
  for (int r = 0; r < size; ++r) {
    const auto [other_role, other_version] = all[static_cast<std::size_t>(r)];
    if (other_version != all.front()[1]) {
      throw InputError(fmt::format(
          "rank 0 speaks version {} of the coupling protocol and rank {} version {}; install mps and the solid "
          "program from the same release",
          all.front()[1], r, other_version));
    }
    (other_role == static_cast<int>(Role::fluid) ? result.fluid_ranks : result.solid_ranks).push_back(r);
  }
  if (role == Role::solid && result.fluid_ranks.empty()) {
    throw InputError(
        "no water takes part: liggghts-mps needs an mps program in the same mpirun "
        "(mpirun -n 4 mps scene.toml : -n 2 liggghts-mps -in in.floes)");
  }
  MPI_Comm_dup(MPI_COMM_WORLD, &result.world);
  MPI_Comm_split(MPI_COMM_WORLD, static_cast<int>(role), rank, &own);
  MPI_Comm_dup(own, role == Role::fluid ? &result.fluid_side : &result.solid_side);
  return result;
}

Participants share_world(MPI_Comm& fluid, MPI_Comm& solid) {
  Participants result;
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  for (int rank = 0; rank < size; ++rank) result.fluid_ranks.push_back(rank);
  result.solid_ranks = result.fluid_ranks;
  result.shared = true;
  result.order = std::make_shared<LocalOrder>();
  for (MPI_Comm* comm : {&result.world, &result.fluid_side, &result.solid_side, &fluid, &solid}) {
    MPI_Comm_dup(MPI_COMM_WORLD, comm);
  }
  return result;
}

void release(Participants& participants) {
  for (MPI_Comm* comm : {&participants.world, &participants.fluid_side, &participants.solid_side}) {
    if (*comm != MPI_COMM_NULL) MPI_Comm_free(comm);
  }
}

}  // namespace embacle::coupling
