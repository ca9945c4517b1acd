// The tables that a scene can name: motions of walls, discharges, water at the start. Included by reader.cpp only.
#pragma once

#include <numeric>

#include "scene/schema.hpp"
#include "scene/table.hpp"

namespace embacle::mps {

/// The time of a row, which must be after that of the row before. Throws TableError.
template <class Rows>
double rising_time(const Rows& before, double time, int line) {
  if (!before.empty() && time <= before.back().first)
    throw TableError(line, "time " + number_text(time) + " s is not after that of the row before, " +
                               number_text(before.back().first) + " s");
  return time;
}

/// Reads a CSV file of angles: rows of strictly rising time. Throws TableError.
[[nodiscard]] inline AngleTable read_angle_table(const std::filesystem::path& file, int) {
  static constexpr std::array<Column, 2> columns{{{"t", Quantity::time}, {"angle", Quantity::angle}}};
  AngleTable table;
  read_table(file, std::span<const Column>(columns), largest_scene_file,
             [&](const Header&, const std::vector<double>& row, int line) {
               table.emplace_back(rising_time(table, row[0], line), row[1]);
             });
  return table;
}

/// Reads a CSV file of discharges: rows of strictly rising time, no discharge below zero. Throws TableError.
[[nodiscard]] inline Hydrograph read_hydrograph(const std::filesystem::path& file, int) {
  static constexpr std::array<Column, 2> columns{{{"t", Quantity::time}, {"discharge", Quantity::discharge}}};
  Hydrograph result;
  read_table(file, std::span<const Column>(columns), largest_scene_file,
             [&](const Header&, const std::vector<double>& row, int line) {
               if (row[1] < 0) throw TableError(line, "discharge " + number_text(row[1]) + " m3/s; allowed: >= 0");
               result.rows.emplace_back(rising_time(result.rows, row[0], line), row[1]);
             });
  return result;
}

/// Reads a CSV file of displacements: rows of strictly rising time. Throws TableError.
[[nodiscard]] inline MotionTable read_motion_table(const std::filesystem::path& file, int dimension) {
  static constexpr std::array<Column, 4> columns{
      {{"t", Quantity::time}, {"x", Quantity::length}, {"y", Quantity::length}, {"z", Quantity::length}}};
  MotionTable table;
  read_table(file, std::span(columns).first(dimension + 1), largest_scene_file,
             [&](const Header&, const std::vector<double>& row, int line) {
               table.push_back({rising_time(table, row[0], line), {row[1], row[2], dimension == 3 ? row[3] : 0.0}});
             });
  return table;
}

/// Reads a CSV file of particles at the start; no two at the same place. Throws TableError.
[[nodiscard]] inline WaterTable read_water_table(const std::filesystem::path& file, int dimension) {
  constexpr std::uintmax_t largest = std::uintmax_t{1} << 31;
  static constexpr std::array<Column, 7> in_space{{{"x", Quantity::length},
                                                   {"y", Quantity::length},
                                                   {"z", Quantity::length},
                                                   {"vx", Quantity::speed, 1},
                                                   {"vy", Quantity::speed, 1},
                                                   {"vz", Quantity::speed, 1},
                                                   {"p", Quantity::pressure, 2}}};
  static constexpr std::array<Column, 5> in_plane{{in_space[0], in_space[1], in_space[3], in_space[4], in_space[6]}};
  const std::span<const Column> columns = dimension == 3 ? std::span<const Column>(in_space) : in_plane;
  const auto axes = static_cast<std::size_t>(dimension);
  WaterTable table;
  table.file = file;
  read_table(file, columns, largest, [&](const Header& header, const std::vector<double>& row, int line) {
    table.has_velocity = header.has(axes);
    table.has_pressure = header.has(2 * axes);
    WaterTable::Row& entry = table.rows.emplace_back();
    entry.line = line;
    for (std::size_t axis = 0; axis < axes; ++axis) {
      entry.position[axis] = header.value(row, axis);
      entry.velocity[axis] = header.value(row, axes + axis);
    }
    entry.pressure = header.value(row, 2 * axes);
  });
  std::vector<std::size_t> order(table.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(table.rows[a].position, a) < std::pair(table.rows[b].position, b);
  });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const WaterTable::Row& first = table.rows[order[k - 1]];
    const WaterTable::Row& second = table.rows[order[k]];
    if (first.position == second.position)
      throw TableError(second.line, "is at the same place as line " + std::to_string(first.line));
  }
  return table;
}

}  // namespace embacle::mps
