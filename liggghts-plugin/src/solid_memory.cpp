#include "solid_memory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "embacle/coupling/types.hpp"
#include "stock_access.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::SystemError;

namespace {

std::string restart_file;  // of the run that continues

/// LIGGGHTS prints the version of a restart file on every rank.
class QuietOutput {
 public:
  QuietOutput() {
    std::fflush(stdout);
    kept_ = ::dup(STDOUT_FILENO);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    ::dup2(nowhere, STDOUT_FILENO);
    ::close(nowhere);
  }
  ~QuietOutput() {
    std::fflush(stdout);
    if (kept_ < 0) return;
    ::dup2(kept_, STDOUT_FILENO);
    ::close(kept_);
  }
  QuietOutput(const QuietOutput&) = delete;
  QuietOutput& operator=(const QuietOutput&) = delete;

 private:
  int kept_ = -1;
};

void read_restart_instead(LAMMPS* lammps, int /*count*/, char** /*words*/) {
  const QuietOutput quiet;
  lammps->input->one(("read_restart " + restart_file).c_str());
}

int rank_of(LAMMPS* lammps) {
  int rank = 0;
  MPI_Comm_rank(lammps->world, &rank);
  return rank;
}

}  // namespace

MemoryFile::MemoryFile(std::span<const std::byte> content) : descriptor_(::memfd_create("solids", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw SystemError(fmt::format("no file in memory for the solids: {}", std::strerror(errno)));
  std::size_t done = 0;
  while (done < content.size()) {
    const ssize_t written = ::write(descriptor_, content.data() + done, content.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw SystemError(fmt::format("no memory for the solids' checkpoint: {}", std::strerror(errno)));
    done += static_cast<std::size_t>(written);
  }
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::name() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

std::vector<std::byte> MemoryFile::content() const {
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  std::vector<std::byte> result(size > 0 ? static_cast<std::size_t>(size) : 0);
  std::size_t done = 0;
  while (done < result.size()) {
    const ssize_t got = ::pread(descriptor_, result.data() + done, result.size() - done, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw SystemError(fmt::format("the solids' checkpoint cannot be read: {}", std::strerror(errno)));
    done += static_cast<std::size_t>(got);
  }
  return result;
}

std::vector<std::byte> memory_of(LAMMPS* lammps) {
  const MemoryFile file;
  lammps->input->one(("write_restart " + file.name()).c_str());
  return rank_of(lammps) == 0 ? file.content() : std::vector<std::byte>{};
}

void continue_from(LAMMPS* lammps, const std::string& name) {
  restart_file = name;
  replace_command(lammps, "create_box", &read_restart_instead);
}

}  // namespace embacle::liggghts
