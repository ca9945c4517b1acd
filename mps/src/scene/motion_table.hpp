// The displacement table of a moving wall. Included by reader.cpp only.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "scene/document.hpp"
#include "scene/schema.hpp"

namespace embacle::mps {

/// A problem in a line of a table; line 0 concerns the whole file.
struct TableError : ValueError {
  TableError(int at, const std::string& message) : ValueError(message), line(at) {}
  int line;
};

/// Factors to SI of the columns, from a header "t [s], x [mm], y [mm]". Throws TableError.
[[nodiscard]] inline std::vector<double> motion_table_header(const std::string& header, int line, int dimension) {
  const std::string allowed = dimension == 2 ? "t [s], x [m], y [m]" : "t [s], x [m], y [m], z [m]";
  static constexpr std::array<std::string_view, 4> names{"t", "x", "y", "z"};
  const std::vector<std::string> cells = split(header, ',');
  std::vector<double> factors;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string& cell = cells[i];
    const auto open = cell.find('[');
    if (i > static_cast<std::size_t>(dimension) || trimmed(cell.substr(0, open)) != names[i])
      throw TableError(line, "the header is '" + header + "'; allowed: " + allowed);
    if (open == std::string::npos) {
      factors.push_back(1);
      continue;
    }
    if (cell.back() != ']') throw TableError(line, "'" + cell + "' in the header lacks its ]; allowed: " + allowed);
    try {
      const std::string one = "1 " + cell.substr(open + 1, cell.size() - open - 2);
      factors.push_back(to_si(evaluate(one, [](const std::string&) { return Number{}; }),
                              i == 0 ? Quantity::time : Quantity::length, one));
    } catch (const ValueError& error) {
      throw TableError(line, "column '" + cell + "': " + error.what());
    }
  }
  if (factors.size() != static_cast<std::size_t>(dimension) + 1)
    throw TableError(line, "the header is '" + header + "'; allowed: " + allowed);
  return factors;
}

/// Reads a CSV file of displacements: a header line, then rows of strictly rising time; blank lines and lines that
/// begin with # are skipped. Throws TableError.
[[nodiscard]] inline MotionTable read_motion_table(const std::filesystem::path& file, int dimension) {
  std::string text;
  try {
    text = file_text(file);
  } catch (const ValueError& error) {
    throw TableError(0, error.what());
  }
  MotionTable table;
  std::vector<double> factors;
  int line = 0;
  for (const std::string& row : split(text, '\n')) {
    ++line;
    if (row.empty() || row.front() == '#') continue;
    if (factors.empty()) {
      factors = motion_table_header(row.starts_with("\xEF\xBB\xBF") ? row.substr(3) : row, line, dimension);
      continue;
    }
    const std::vector<std::string> cells = split(row, ',');
    if (cells.size() != factors.size())
      throw TableError(
          line, "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(factors.size()));
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto [end, error] = std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), values[i]);
      values[i] *= factors[i];
      if (error != std::errc{} || end != cells[i].data() + cells[i].size() || !std::isfinite(values[i]))
        throw TableError(line, "column " + std::to_string(i + 1) + ": '" + cells[i] + "' is not a number");
    }
    if (!table.empty() && values[0] <= table.back().first)
      throw TableError(line, "time " + number_text(values[0]) + " s is not after that of the row before, " +
                                 number_text(table.back().first) + " s");
    table.push_back({values[0], {values[1], values[2], values[3]}});
  }
  if (table.empty()) throw TableError(0, "has no rows");
  return table;
}

}  // namespace embacle::mps
