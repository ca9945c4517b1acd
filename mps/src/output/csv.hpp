// Tables that grow during a run (bodies.csv, gauges/*.csv, energies.csv): written by one rank, flushed row by row.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace embacle::mps {

/// A CSV file with one header line of `name [unit]` columns. A failing write throws coupling::SystemError with the
/// path.
class CsvWriter {
 public:
  /// `keep_until`: a file that is there is continued; of its rows, those stay whose first value is at most this. One
  /// with other columns throws coupling::InputError.
  CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns,
            std::optional<double> keep_until = std::nullopt);
  void row(std::span<const double> values);
  void flush();

 private:
  void drop_rows_after(double last, const std::string& header) const;

  std::filesystem::path path_;
  std::ofstream stream_;
  std::size_t columns_;
};

}  // namespace embacle::mps
