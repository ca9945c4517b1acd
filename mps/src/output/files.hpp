// What every writer of the output folder needs: whole files, agreement on failure, clear reasons.
#pragma once

#include <mpi.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {

/// The message of a file that could not be written: what, where, why (`code` is an errno; 0: unknown).
inline std::string cannot_write(const std::filesystem::path& path, int code) {
  return "cannot write " + path.string() + ": " + (code != 0 ? std::strerror(code) : "unknown input/output error");
}

/// A limit on the file size (`ulimit -f`, a batch system's quota) kills a process by SIGXFSZ unless it is ignored;
/// ignored, the write fails with EFBIG and the run can end with its message. A handler somebody installed is left
/// alone.
inline void report_file_size_limit_as_error() {
  if (const auto previous = std::signal(SIGXFSZ, SIG_IGN); previous != SIG_DFL) std::signal(SIGXFSZ, previous);
}

/// The name under which a file is written before it is renamed into place.
inline std::filesystem::path beside(const std::filesystem::path& path) { return path.string() + ".part"; }

/// Renames `beside(path)` to `path`, replacing it in one step. Throws SystemError.
inline void move_into_place(const std::filesystem::path& path) {
  if (std::rename(beside(path).c_str(), path.c_str()) != 0) {
    const int code = errno;
    std::remove(beside(path).c_str());
    throw coupling::SystemError(cannot_write(path, code));
  }
}

/// Replaces the file by `text`: written beside and renamed, so that the file is whole at any moment. Throws
/// SystemError.
inline void write_whole_file(const std::filesystem::path& path, const std::string& text) {
  report_file_size_limit_as_error();
  std::FILE* const file = std::fopen(beside(path).c_str(), "wb");
  if (file == nullptr) throw coupling::SystemError(cannot_write(path, errno));
  errno = 0;
  bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  int code = errno;
  if (std::fclose(file) != 0) {
    if (written) code = errno;
    written = false;
  }
  if (!written) {
    std::remove(beside(path).c_str());
    throw coupling::SystemError(cannot_write(path, code));
  }
  move_into_place(path);
}

/// Collective. `error` is empty where all went well. If any rank has an error, throws SystemError with the message of
/// the lowest such rank on every rank.
inline void throw_on_all_if_any(MPI_Comm comm, const std::string& error) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  int first = error.empty() ? INT_MAX : rank;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == INT_MAX) return;
  int length = static_cast<int>(error.size());
  MPI_Bcast(&length, 1, MPI_INT, first, comm);
  std::string message = error;
  message.resize(static_cast<std::size_t>(length));
  MPI_Bcast(message.data(), length, MPI_CHAR, first, comm);
  throw coupling::SystemError(message);
}

}  // namespace embacle::mps
