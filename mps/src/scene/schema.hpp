// What a scene may contain: every key with its type, quantity, range, default and meaning.
// The reader and the reference page both work from this one table.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/scene.hpp"
#include "scene/units.hpp"

namespace embacle::mps {

/// Rows of (time [s], displacement [m]), as in Motion.
using MotionTable = std::vector<std::pair<double, Vec3d>>;

/// Rows of (time [s], angle [rad]), as in Motion.
using AngleTable = std::vector<std::pair<double, double>>;

using SurfacePointer = std::shared_ptr<const Surface>;
/// Points of a plane, the third component zero.
using Polygon = std::vector<Vec3d>;

/// Where a value goes; the type of the pointer is the type that the key expects.
using Target =
    std::variant<double*, std::optional<double>*, std::optional<bool>*, Vec3d*, int*, bool*, std::string*,
                 std::filesystem::path*, std::vector<double>*, std::vector<std::string>*, MotionTable*, KernelKind*,
                 Regularisation*, Diffusion*, Integrator*, TurbulenceModel*, WallPressure*, Scheme*, Loads*, GaugeKind*,
                 Wall::Kind*, Water::Kind*, WaterTable*, std::optional<Vec3d>*, Axis*, Polygon*, SurfacePointer*,
                 AngleTable*, Interpolation*, Hydrograph*, Direction*, Profile*, Opening::Kind*>;

/// Index of the word that an enumeration stands for; nothing for other values.
[[nodiscard]] inline std::optional<std::size_t> choice_of(const Target& target) {
  return std::visit(
      [](const auto* value) -> std::optional<std::size_t> {
        if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(*value)>>) return static_cast<std::size_t>(*value);
        return std::nullopt;
      },
      target);
}

/// Allowed interval of a number in SI; an open end is itself not allowed.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;

  [[nodiscard]] bool contains(double value) const {
    return (lower_open ? value > lower : value >= lower) && value <= upper;
  }
  /// "> 0", ">= 0", "0.01 to 2"; empty if unbounded.
  [[nodiscard]] std::string text() const;
};

/// One key of a section, apart from where its value goes.
struct Key {
  std::string name;
  std::string meaning;
  Quantity quantity = Quantity::plain;
  Range range = {};
  std::vector<std::string> choices = {};  ///< allowed words; of an enumeration in the order of its values
  bool required = false;
  bool label = false;  ///< a text that names the table: an identifier, unique among its kind
  std::string default_text =
      {};  ///< for the reference page, where the default is not simply the value in a fresh structure
};

template <class T>
struct Field {
  Key key;
  Target (*target)(T&);
};

/// A table of the file whose keys fill a T. `repeated`: written [[path]], any number of times.
template <class T>
struct Section {
  std::string path;
  std::string meaning;
  std::vector<Field<T>> fields;
  std::vector<std::string> tables = {};  ///< tables that may stand inside
  bool repeated = false;

  [[nodiscard]] const Field<T>* find(std::string_view name) const {
    for (const auto& field : fields)
      if (field.key.name == name) return &field;
    return nullptr;
  }
};

struct Schema {
  Section<Scene> root;
  Section<Scene> domain;
  Section<Fluid> fluid;
  Section<Numerics> numerics;
  Section<Water> water;
  Section<Wall> wall;
  Section<Motion> motion;
  Section<Opening> opening;
  Section<Sponge> sponge;
  Section<Gauge> gauge;
  Section<Coupling> coupling;
  Section<Output> output;
  Section<Scene> run;

  /// Calls f(section) for each in the order of the reference page.
  template <class F>
  void for_each(F&& f) const {
    f(root), f(domain), f(fluid), f(numerics), f(water), f(wall), f(motion), f(opening), f(sponge), f(gauge),
        f(coupling), f(output), f(run);
  }
};

[[nodiscard]] const Schema& schema();

/// What a key expects, in words: `a length: a number in m or text such as "2 mm" (...)`.
[[nodiscard]] std::string expectation(const Key& key, const Target& target, int dimension);

}  // namespace embacle::mps
