// Particle fields in parallel HDF5 with an XDMF index that ParaView opens.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace embacle::mps {

/// What each rank contributes to a frame: its own particles (any number, also none), in arrays of equal length.
struct FieldFrame {
  double time = 0;  ///< [s]
  std::int64_t step = 0;
  std::span<const float> position;         ///< [m], 3 per particle
  std::span<const float> velocity;         ///< [m/s], 3 per particle
  std::span<const float> pressure;         ///< [Pa]
  std::span<const std::int8_t> type;       ///< 0 fluid, 1 wall, 2 body
  std::span<const std::int32_t> body_tag;  ///< tag of the body, -1 for others
};

/// What the indices of all frames need to know of one already written.
struct FrameRecord {
  double time = 0;
  std::int64_t step = 0;
  std::int64_t particles = 0;
};

/// Writes `folder/fields/NNNNNN.h5` (one frame a file, collective, written beside and renamed, so that an interrupted
/// run leaves only whole frames), `folder/fields.h5` (all frames, as external links) and `folder/fields.xdmf`.
class FieldWriter {
 public:
  /// `earlier`: frames of a run that is continued in this folder; later ones are removed.
  FieldWriter(MPI_Comm comm, std::filesystem::path folder, std::vector<FrameRecord> earlier = {});
  ~FieldWriter();
  /// Collective. Throws coupling::SystemError on every rank if any rank cannot write (disk full ...).
  void write(const FieldFrame& frame);
  [[nodiscard]] int frames() const;
  [[nodiscard]] const std::vector<FrameRecord>& records() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace embacle::mps
