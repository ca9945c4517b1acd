// Tables of numbers in CSV files: a header that names columns and their units, then rows. Included by reader.cpp only.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "scene/document.hpp"
#include "scene/units.hpp"

namespace embacle::mps {

/// A problem in a line of a table; line 0 concerns the whole file.
struct TableError : ValueError {
  TableError(int at, const std::string& message) : ValueError(message), line(at) {}
  int line;
};

/// A column that a table may have. Columns of group 0 are required, those of another group come all or not at all.
struct Column {
  std::string_view name;
  Quantity quantity;
  int group = 0;
};

/// The columns of a table: of each of the possible ones its place in a row, or -1, and its factor to SI.
class Header {
 public:
  /// From a header "x [mm], y [mm], p [Pa]"; a column without unit is in SI. Throws TableError.
  Header(const std::string& text, int line, std::span<const Column> columns) : place_(columns.size(), -1) {
    std::string allowed;
    for (const Column& column : columns)
      allowed +=
          (allowed.empty() ? "" : ", ") + std::string(column.name) + " [" + std::string(si_unit(column.quantity)) + "]";
    if (columns.back().group > 0) allowed += " (some may be left out: see docs/scene-reference.md)";
    std::size_t next = 0;
    for (const std::string& cell : split(text, ',')) {
      const auto open = cell.find('[');
      const std::string_view name = trimmed(std::string_view(cell).substr(0, open));
      // A group may be passed over where it begins.
      while (next < columns.size() && columns[next].name != name && columns[next].group > 0 &&
             (next == 0 || columns[next - 1].group != columns[next].group)) {
        const int passed = columns[next].group;
        while (next < columns.size() && columns[next].group == passed) ++next;
      }
      if (next == columns.size() || columns[next].name != name)
        throw TableError(line, "the header is '" + text + "'; allowed: " + allowed);
      place_[next] = static_cast<int>(factors_.size());
      factors_.push_back(factor(cell, open, columns[next].quantity, line, allowed));
      ++next;
    }
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const bool group_begun = k > 0 && columns[k - 1].group == columns[k].group && place_[k - 1] >= 0;
      if (place_[k] < 0 && (columns[k].group == 0 || group_begun))
        throw TableError(line, "the header is '" + text + "'; allowed: " + allowed);
    }
  }

  [[nodiscard]] std::size_t width() const { return factors_.size(); }
  [[nodiscard]] bool has(std::size_t column) const { return place_[column] >= 0; }
  /// Value of one of the possible columns in a row; 0 without it.
  [[nodiscard]] double value(const std::vector<double>& row, std::size_t column) const {
    return has(column) ? row[place_[column]] : 0.0;
  }
  [[nodiscard]] double factor(std::size_t place) const { return factors_[place]; }

 private:
  static double factor(const std::string& cell, std::size_t open, Quantity quantity, int line,
                       const std::string& allowed) {
    if (open == std::string::npos) return 1;
    if (cell.back() != ']') throw TableError(line, "'" + cell + "' in the header lacks its ]; allowed: " + allowed);
    try {
      const std::string one = "1 " + cell.substr(open + 1, cell.size() - open - 2);
      return to_si(evaluate(one, [](const std::string&) { return Number{}; }), quantity, one);
    } catch (const ValueError& error) {
      throw TableError(line, "column '" + cell + "': " + error.what());
    }
  }

  std::vector<int> place_;
  std::vector<double> factors_;
};

/// Reads a CSV file: a header line, then rows of numbers, each given as `take(header, row in SI, line)`; blank lines
/// and lines that begin with # are skipped. Throws TableError, also for a file larger than `largest` bytes or without
/// rows.
template <class Take>
void read_table(const std::filesystem::path& file, std::span<const Column> columns, std::uintmax_t largest,
                Take&& take) {
  std::string text;
  try {
    text = file_text(file, largest);
  } catch (const ValueError& error) {
    throw TableError(0, error.what());
  }
  std::optional<Header> header;
  std::vector<double> row;
  int line = 0, rows = 0;
  for (std::size_t begin = 0, end = 0; begin <= text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    std::string_view rest = trimmed(std::string_view(text).substr(begin, end - begin));
    ++line;
    if (rest.empty() || rest.front() == '#') continue;
    if (!header) {
      if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
      header.emplace(std::string(rest), line, columns);
      row.resize(header->width());
      continue;
    }
    const auto cells = static_cast<std::size_t>(std::count(rest.begin(), rest.end(), ',')) + 1;
    if (cells != header->width())
      throw TableError(line,
                       "has " + std::to_string(cells) + " columns, the header " + std::to_string(header->width()));
    for (std::size_t i = 0; i < cells; ++i) {
      const std::size_t comma = std::min(rest.find(','), rest.size());
      const std::string_view cell = trimmed(rest.substr(0, comma));
      const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row[i]);
      row[i] *= header->factor(i);
      if (error != std::errc{} || stop != cell.data() + cell.size() || !std::isfinite(row[i]))
        throw TableError(line, "column " + std::to_string(i + 1) + ": '" + std::string(cell) + "' is not a number");
      rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    take(*header, row, line);
    ++rows;
  }
  if (rows == 0) throw TableError(0, "has no rows");
}

}  // namespace embacle::mps
