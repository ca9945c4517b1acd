// Tables that grow during a run (bodies.csv, gauges/*.csv, energies.csv): written by one rank, flushed row by row.
#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace embacle::mps {

/// A CSV file with one header line of `name [unit]` columns. A failing write throws coupling::SystemError with the
/// path.
class CsvWriter {
 public:
  CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns);
  void row(std::span<const double> values);
  void flush();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
  std::size_t columns_;
};

}  // namespace embacle::mps
