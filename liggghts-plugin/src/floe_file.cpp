#include "floe_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "words.hpp"

namespace embacle::liggghts {

using coupling::InputError;
using coupling::Vec3;

namespace {

struct Column {
  std::string name, unit;
};

const std::vector<std::vector<Column>> groups = {
    {{"x", "m"}, {"y", "m"}, {"z", "m"}},
    {{"qw", "1"}, {"qx", "1"}, {"qy", "1"}, {"qz", "1"}},
    {{"vx", "m/s"}, {"vy", "m/s"}, {"vz", "m/s"}},
    {{"wx", "rad/s"}, {"wy", "rad/s"}, {"wz", "rad/s"}},
    {{"lx", "m"}, {"ly", "m"}, {"lz", "m"}},
    {{"outline", "m"}, {"thickness", "m"}},
    {{"density", "kg/m3"}},
    {{"mass", "kg"}},
    {{"t", "s"}},
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(trimmed(cell));
  if (!line.empty() && trimmed(line).back() == ',') cells.emplace_back();
  return cells;
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const auto& group : groups) {
    for (const Column& column : group) names.push_back(column.name);
  }
  return names;
}

/// Column name to its place; checks names, units, repetition and completeness of the groups.
std::map<std::string, std::size_t> read_header(const std::string& where, const std::vector<std::string>& cells) {
  std::map<std::string, std::string> units;
  for (const auto& group : groups) {
    for (const Column& column : group) units[column.name] = column.unit;
  }
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string name = cells[i], unit;
    if (const auto open = name.find('['); open != std::string::npos && name.back() == ']') {
      unit = trimmed(name.substr(open + 1, name.size() - open - 2));
      name = trimmed(name.substr(0, open));
    }
    if (!units.contains(name)) {
      const std::string near = nearest_word(name, all_names());
      throw InputError(fmt::format("{}: unknown column '{}'{}; allowed: {}", where, name,
                                   near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near),
                                   fmt::join(all_names(), ", ")));
    }
    if (!unit.empty() && unit != units[name]) {
      throw InputError(fmt::format("{}: column '{}' is in {}, not in {}", where, name, units[name], unit));
    }
    if (!place.emplace(name, i).second) throw InputError(fmt::format("{}: column '{}' appears twice", where, name));
  }
  for (const auto& group : groups) {
    for (const Column& column : group) {
      const bool required =
          group.front().name == "x" || place.contains(group.front().name) || place.contains(group.back().name);
      if (required && !place.contains(column.name)) {
        throw InputError(fmt::format("{}: column '{}' is missing", where, column.name));
      }
    }
  }
  if (place.contains("density") && place.contains("mass")) {
    throw InputError(where + ": give either the column 'density' or the column 'mass', not both");
  }
  if (place.contains("lx") && place.contains("outline")) {
    throw InputError(where + ": give either the columns lx, ly, lz or the columns outline, thickness, not both");
  }
  if ((place.contains("density") || place.contains("mass")) && !place.contains("lx") && !place.contains("outline")) {
    throw InputError(where + ": the columns 'density' and 'mass' need the columns lx, ly, lz or outline, thickness");
  }
  return place;
}

std::vector<Eigen::Vector2d> read_outline(const std::string& where, const std::string& cell) {
  std::istringstream stream(cell);
  std::vector<double> numbers;
  for (std::string word; stream >> word;) {
    double number = 0;
    if (!parse_number(word, number)) {
      throw InputError(fmt::format("{}: '{}' in column 'outline' is not a number", where, word));
    }
    numbers.push_back(number);
  }
  if (numbers.size() % 2 != 0 || numbers.size() < 6) {
    throw InputError(
        fmt::format("{}: the outline has {} numbers; allowed: x and y of at least 3 corners", where, numbers.size()));
  }
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t k = 0; k < numbers.size(); k += 2) corners.emplace_back(numbers[k], numbers[k + 1]);
  return corners;
}

}  // namespace

std::vector<FloeRow> read_floe_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("cannot read the file of bodies '{}'", path));
  std::map<std::string, std::size_t> place;
  std::vector<FloeRow> rows;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::string where = fmt::format("{}:{}", path, number);
    const std::vector<std::string> cells = cells_of(line);
    if (place.empty()) {
      place = read_header(where, cells);
      continue;
    }
    if (cells.size() != place.size()) {
      throw InputError(
          fmt::format("{}: {} values, but the header names {} columns", where, cells.size(), place.size()));
    }
    const auto value = [&](const std::string& name) {
      double number_read = 0;
      if (!parse_number(cells[place.at(name)], number_read)) {
        throw InputError(fmt::format("{}: '{}' in column '{}' is not a number", where, cells[place.at(name)], name));
      }
      return number_read;
    };
    const auto positive = [&](const std::string& name) {
      const double number_read = value(name);
      if (!(number_read > 0)) {
        throw InputError(fmt::format("{}: column '{}' must be greater than zero, not {}", where, name, number_read));
      }
      return number_read;
    };
    FloeRow row;
    row.origin = where;
    row.state.position = Vec3(value("x"), value("y"), value("z"));
    if (place.contains("qw")) {
      const coupling::Quaternion given(value("qw"), value("qx"), value("qy"), value("qz"));
      if (std::abs(given.norm() - 1) > 1e-6) {
        throw InputError(fmt::format("{}: the quaternion's norm must be 1, not {:g}", where, given.norm()));
      }
      row.state.orientation = given.normalized();
    }
    if (place.contains("vx")) row.state.velocity = Vec3(value("vx"), value("vy"), value("vz"));
    if (place.contains("wx")) row.state.angular_velocity = Vec3(value("wx"), value("wy"), value("wz"));
    if (place.contains("lx")) {
      row.own_size = true;
      row.size = Vec3(positive("lx"), positive("ly"), positive("lz"));
    } else if (place.contains("outline")) {
      row.outline = read_outline(where, cells[place.at("outline")]);
      row.thickness = positive("thickness");
    }
    if (place.contains("density")) row.density = positive("density");
    if (place.contains("mass")) row.mass = positive("mass");
    if (place.contains("t")) row.enters = value("t");
    rows.push_back(row);
  }
  if (rows.empty()) throw InputError(fmt::format("{}: no bodies", path));
  return rows;
}

}  // namespace embacle::liggghts
