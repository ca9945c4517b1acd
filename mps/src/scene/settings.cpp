#include "scene/settings.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <sstream>

#include <fmt/format.h>

#include "embacle/coupling/types.hpp"
#include "scene/schema.hpp"
#include "scene/units.hpp"

namespace embacle::mps {
namespace {

/// Differing settings that a message names.
constexpr std::size_t most_named = 5;

/// FNV-1a over the bits of numbers.
struct Checksum {
  std::uint64_t value = 14695981039346656037U;
  void add(double number) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    for (int byte = 0; byte < 8; ++byte) value = (value ^ ((bits >> (8 * byte)) & 0xff)) * 1099511628211U;
  }
};

/// A value as text that is equal only for equal values.
struct Text {
  std::string operator()(const double* x) const { return number_text(*x); }
  std::string operator()(const std::optional<double>* x) const { return *x ? number_text(**x) : "none"; }
  std::string operator()(const Vec3d* x) const {
    return fmt::format("[{}, {}, {}]", number_text((*x)[0]), number_text((*x)[1]), number_text((*x)[2]));
  }
  std::string operator()(const std::optional<Vec3d>* x) const { return *x ? operator()(&**x) : "none"; }
  std::string operator()(const int* x) const { return std::to_string(*x); }
  std::string operator()(const bool* x) const { return *x ? "true" : "false"; }
  std::string operator()(const std::optional<bool>* x) const { return *x ? operator()(&**x) : "none"; }
  std::string operator()(const std::string* x) const { return *x; }
  std::string operator()(const std::filesystem::path* x) const { return x->string(); }
  std::string operator()(const std::vector<double>* x) const {
    std::string text;
    for (const double value : *x) text += (text.empty() ? "[" : ", ") + number_text(value);
    return text.empty() ? "[]" : text + "]";
  }
  std::string operator()(const std::vector<std::string>* x) const {
    std::vector<std::string> sorted = *x;  // sides of a tank: in any order
    std::sort(sorted.begin(), sorted.end());
    std::string text;
    for (const std::string& value : sorted) text += (text.empty() ? "[" : ", ") + value;
    return text.empty() ? "[]" : text + "]";
  }
  // A table may be long: its length and a checksum stand for it.
  std::string operator()(const MotionTable* x) const {
    Checksum sum;
    for (const auto& [time, moved] : *x) {
      sum.add(time);
      for (const double value : moved) sum.add(value);
    }
    return std::to_string(x->size()) + " rows, checksum " + std::to_string(sum.value);
  }
  std::string operator()(const AngleTable* x) const {
    Checksum sum;
    for (const auto& [time, angle] : *x) {
      sum.add(time);
      sum.add(angle);
    }
    return std::to_string(x->size()) + " rows, checksum " + std::to_string(sum.value);
  }
  std::string operator()(const Hydrograph* x) const { return operator()(&x->rows); }
  std::string operator()(const WaterTable* x) const {
    Checksum sum;
    for (const WaterTable::Row& row : x->rows) {
      for (const double value : row.position) sum.add(value);
      for (const double value : row.velocity) sum.add(value);
      sum.add(row.pressure);
    }
    return std::to_string(x->rows.size()) + " rows, checksum " + std::to_string(sum.value);
  }
  std::string operator()(const Polygon* x) const {
    std::string text;
    for (const Vec3d& point : *x) text += (text.empty() ? "[" : ", ") + operator()(&point);
    return text.empty() ? "[]" : text + "]";
  }
  std::string operator()(const SurfacePointer* x) const {
    if (!*x) return "none";
    Checksum sum;
    for (const Triangle& triangle : (*x)->triangles) {
      for (const Vec3d& corner : triangle.corner) {
        for (const double value : corner) sum.add(value);
      }
    }
    return std::to_string((*x)->triangles.size()) + " triangles, checksum " + std::to_string(sum.value);
  }
  template <class Enumeration>
  std::string operator()(const Enumeration* x) const {
    return std::to_string(static_cast<int>(*x));
  }
};

/// The word of an enumeration where the key has one, else the value's text.
std::string value_text(const Key& key, const Target& target) {
  const auto choice = choice_of(target);
  return choice && *choice < key.choices.size() ? key.choices[*choice] : std::visit(Text{}, target);
}

template <class T>
void append(std::string& lines, const Section<T>& section, const std::string& path, T& values) {
  for (const Field<T>& field : section.fields) {
    const std::string name = (path.empty() ? "" : path + ".") + field.key.name;
    if (field.key.label || name == "title" || name == "numerics.rebalance_imbalance") continue;
    lines += name + " = " + value_text(field.key, field.target(values)) + "\n";
  }
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

std::string lasting_settings(const Scene& scene) {
  Scene copy = scene;  // the schema points into what it is given
  const Schema& all = schema();
  std::string lines;
  append(lines, all.root, "", copy);
  append(lines, all.domain, "domain", copy);
  append(lines, all.fluid, "fluid", copy.fluid);
  append(lines, all.numerics, "numerics", copy.numerics);
  for (Water& water : copy.water) append(lines, all.water, "water." + water.name, water);
  for (Wall& wall : copy.walls) {
    append(lines, all.wall, "wall." + wall.name, wall);
    if (wall.motion) append(lines, all.motion, "wall." + wall.name + ".motion", *wall.motion);
  }
  for (Opening& opening : copy.openings) append(lines, all.opening, "opening." + opening.name, opening);
  for (Sponge& sponge : copy.sponges) append(lines, all.sponge, "sponge." + sponge.name, sponge);
  if (copy.coupled()) {
    copy.coupling.script = copy.coupling.script.filename();  // the scene may have moved as a whole
    append(lines, all.coupling, "coupling", copy.coupling);
    for (const auto& [name, value] : copy.coupling.variables)
      lines += "coupling.variables." + name + " = " + value + "\n";
  }
  return lines;
}

void compare_settings(const Scene& scene, const std::string& now, const std::string& then, const std::string& file) {
  if (now == then) return;
  const auto present = split_lines(now), past = split_lines(then);
  std::vector<std::string> problems;
  const auto key_of = [](const std::string& line) { return line.substr(0, line.find(" = ")); };
  const auto value_of = [](const std::string& line) {
    return line.substr(std::min(line.size(), line.find(" = ") + 3));
  };
  const auto find = [&](const std::vector<std::string>& lines, const std::string& key) {
    return std::find_if(lines.begin(), lines.end(), [&](const std::string& line) { return key_of(line) == key; });
  };
  for (const std::string& line : present) {
    const auto before = find(past, key_of(line));
    if (before == past.end()) {
      problems.push_back(line + " (then: not there)");
    } else if (*before != line) {
      problems.push_back(line + " (then: " + value_of(*before) + ")");
    }
  }
  for (const std::string& line : past) {
    if (find(present, key_of(line)) == present.end())
      problems.push_back(key_of(line) + ": not there (then: " + value_of(line) + ")");
  }
  if (problems.empty()) problems.emplace_back("the order of the walls, waters, openings or sponges");
  std::string text;
  for (std::size_t i = 0; i < std::min(problems.size(), most_named); ++i) text += "\n  " + problems[i];
  if (problems.size() > most_named) text += "\n  and " + std::to_string(problems.size() - most_named) + " more";
  throw coupling::InputError(scene.file.string() + ": the scene is not the one of the checkpoint " + file +
                             "; a restart may change [run], [output], [[gauge]], title and "
                             "numerics.rebalance_imbalance only. It differs in" +
                             text);
}

}  // namespace embacle::mps
