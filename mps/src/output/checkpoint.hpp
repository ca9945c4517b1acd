// Checkpoint files: named values and distributed tables in HDF5, always whole. What they hold is decided in core/.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace embacle::mps {

/// Rows spread over the ranks; in the file, those of rank 0 first.
struct CheckpointTable {
  std::string name;
  std::string columns;  ///< what the columns are, with units
  std::size_t width = 1;
  std::variant<std::vector<double>, std::vector<std::int64_t>> values;  ///< of this rank, row after row
};

/// What goes into a checkpoint. All but the tables' values is the same on every rank; that of rank 0 is written.
struct CheckpointContent {
  std::map<std::string, double> numbers;
  std::map<std::string, std::int64_t> counts;
  std::map<std::string, std::vector<double>> lists;
  std::map<std::string, std::string> texts;
  std::vector<CheckpointTable> tables;
};

/// `checkpoint.h5` and, beside it, `checkpoint-previous.h5`.
[[nodiscard]] std::filesystem::path checkpoint_path(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path previous_checkpoint(const std::filesystem::path& path);

/// Writes a checkpoint beside `path`, brings it to the disk and then puts it in place of the old one, which becomes the
/// previous one: at any moment there is a whole checkpoint. Collective. Throws coupling::SystemError on every rank if
/// any rank cannot write; the checkpoints before stay as they are.
void write_checkpoint(MPI_Comm comm, const std::filesystem::path& path, const CheckpointContent& content);

/// Reads a checkpoint; each rank opens it for itself. Whatever is missing or cannot be read throws
/// coupling::InputError.
class CheckpointReader {
 public:
  /// `given`: a checkpoint, or a results folder that holds one (the previous one if there is no other).
  explicit CheckpointReader(const std::filesystem::path& given);
  ~CheckpointReader();
  CheckpointReader(const CheckpointReader&) = delete;
  CheckpointReader& operator=(const CheckpointReader&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] double number(const std::string& name) const;
  [[nodiscard]] std::int64_t count(const std::string& name) const;
  [[nodiscard]] std::vector<double> list(const std::string& name) const;
  [[nodiscard]] std::string text(const std::string& name) const;
  /// Rows of a table over all ranks.
  [[nodiscard]] std::int64_t rows(const std::string& table) const;
  /// `count` rows of a table from `first` on, into `out` (count times the table's width values).
  void read(const std::string& table, std::int64_t first, std::int64_t count, std::span<double> out) const;
  void read(const std::string& table, std::int64_t first, std::int64_t count, std::span<std::int64_t> out) const;

 private:
  struct Impl;
  std::filesystem::path path_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace embacle::mps
