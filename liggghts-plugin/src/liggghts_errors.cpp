// Replaces LIGGGHTS' Error functions in executables that link this file (the dynamic linker prefers an executable's own
// definitions). The originals print and then end the process through MPI_Finalize, where a coupled run would wait for
// the other program for ever, or MPI_Abort with status 1. These throw RunError instead, with the complete message.
#include "liggghts_errors.hpp"

#include <fmt/format.h>

#include <string>

#include <compute.h>
#include "embacle/coupling/types.hpp"

#include "stock.hpp"

namespace {

using embacle::coupling::ExitStatus;

/// Errors that tell of a simulation gone wrong rather than of a wrong script.
ExitStatus status_of(const std::string& message) {
  for (const char* sign :
       {"Lost atoms", "Non-numeric", "out of range - cannot compute", "blow", "Too many neighbor bins"}) {
    if (message.find(sign) != std::string::npos) return ExitStatus::unstable;
  }
  if (message.find("nternal error") != std::string::npos) return ExitStatus::internal;
  return ExitStatus::input;
}

[[noreturn]] void raise(FILE* logfile, const char* file, int line, const std::string& message) {
  const std::string complete = fmt::format("{} ({}:{})", message, file, line);
  if (logfile) {
    fmt::print(logfile, "ERROR: {}\n", complete);
    std::fflush(logfile);
  }
  throw embacle::coupling::RunError(status_of(message), complete);
}

}  // namespace

namespace LAMMPS_NS {

void Error::all(const char* file, int line, const char* text) { raise(logfile, file, line, text); }

void Error::one(const char* file, int line, const char* text) { raise(logfile, file, line, text); }

void Error::universe_all(const char* file, int line, const char* text) { raise(logfile, file, line, text); }

void Error::universe_one(const char* file, int line, const char* text) { raise(logfile, file, line, text); }

void Error::fix_error(const char* file, int line, Fix* fix, const char* text) {
  fix_error(file, line, fix, fix->style, text);
}

void Error::fix_error(const char* file, int line, Fix* fix, const char* style, const char* text) {
  // A text of at most two characters stands for "illegal command".
  raise(logfile, file, line,
        std::string(text).size() > 2 ? fmt::format("fix {} {}: {}", fix->id, style, text)
                                     : fmt::format("illegal command fix {} {}", fix->id, style));
}

void Error::compute_error(const char* file, int line, Compute* compute, const char* text) {
  raise(logfile, file, line,
        std::string(text).size() > 2 ? fmt::format("compute {} {}: {}", compute->id, compute->style, text)
                                     : fmt::format("illegal command compute {} {}", compute->id, compute->style));
}

void Error::done() { throw embacle::liggghts::ScriptQuit{}; }

}  // namespace LAMMPS_NS
