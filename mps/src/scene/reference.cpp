// The schema in words: what a key expects, for error messages, and the reference page of all keys.
#include <algorithm>

#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "scene/suggest.hpp"

namespace embacle::mps {
namespace {

std::string unit_text(const Key& key) {
  if (key.quantity == Quantity::plain) return {};
  std::string text(1, ' ');
  return text.append(si_unit(key.quantity));
}

/// "length [m]", "number", "vector of speed [m/s]" ...
std::string type_text(const Key& key, const Target& target) {
  const std::string number = key.quantity == Quantity::plain ? "number"
                                                             : std::string(quantity_name(key.quantity)) + " [" +
                                                                   std::string(si_unit(key.quantity)) + "]";
  if (std::holds_alternative<Vec3d*>(target) || std::holds_alternative<std::optional<Vec3d>*>(target))
    return "vector of " + number;
  if (std::holds_alternative<std::vector<double>*>(target)) return "list of " + number;
  if (std::holds_alternative<std::vector<std::string>*>(target)) return "list of words";
  if (std::holds_alternative<int*>(target)) return "whole number";
  if (std::holds_alternative<bool*>(target) || std::holds_alternative<std::optional<bool>*>(target))
    return "true or false";
  if (std::holds_alternative<std::string*>(target)) return "text";
  if (std::holds_alternative<std::filesystem::path*>(target) || std::holds_alternative<MotionTable*>(target) ||
      std::holds_alternative<AngleTable*>(target) || std::holds_alternative<WaterTable*>(target) ||
      std::holds_alternative<SurfacePointer*>(target) || std::holds_alternative<Hydrograph*>(target))
    return "file";
  if (std::holds_alternative<Polygon*>(target)) return "list of points, " + number;
  return key.choices.empty() ? number : "word";
}

/// The value in a fresh structure, as one would write it.
std::string default_text(const Key& key, const Target& target) {
  if (key.required) return "**required**";
  if (!key.default_text.empty()) return key.default_text;
  if (const auto* number = std::get_if<double*>(&target)) return number_text(**number) + unit_text(key);
  if (const auto* number = std::get_if<int*>(&target)) return number_text(**number);
  if (const auto* truth = std::get_if<bool*>(&target)) return **truth ? "true" : "false";
  if (const auto* vector = std::get_if<Vec3d*>(&target))
    return "[" + number_text((**vector)[0]) + ", " + number_text((**vector)[1]) + ", " + number_text((**vector)[2]) +
           "]";
  const std::size_t choice = choice_of(target).value_or(key.choices.size());
  return choice < key.choices.size() ? "`" + key.choices[choice] + "`" : "none";
}

std::string allowed_text(const Key& key) {
  if (key.choices.empty()) return key.range.text() + (key.range.text().empty() ? "" : unit_text(key));
  std::string result;
  for (const std::string& choice : key.choices) result += (result.empty() ? "`" : ", `") + choice + "`";
  return result;
}

}  // namespace

std::string expectation(const Key& key, const Target& target, int dimension) {
  const std::string choices = join(key.choices);
  const std::string quantity = key.quantity == Quantity::plain
                                   ? how_to_write(key.quantity)
                                   : a_quantity(key.quantity) + ": " + how_to_write(key.quantity);
  struct Describe {
    const Key& key;
    const std::string& choices;
    const std::string& quantity;
    int dimension;
    std::string operator()(const double*) const { return quantity; }
    std::string operator()(const std::optional<double>*) const { return quantity; }
    std::string operator()(const Vec3d*) const {
      return "a list of " + std::to_string(dimension) + " components, each " + quantity;
    }
    std::string operator()(const std::optional<Vec3d>*) const { return operator()(static_cast<const Vec3d*>(nullptr)); }
    std::string operator()(const Polygon*) const {
      return "a list of points, each a list of 2 components, each " + quantity;
    }
    std::string operator()(const SurfacePointer*) const {
      return operator()(static_cast<const std::filesystem::path*>(nullptr));
    }
    std::string operator()(const int*) const { return "a whole number, " + key.range.text(); }
    std::string operator()(const bool*) const { return "true or false"; }
    std::string operator()(const std::optional<bool>*) const { return "true or false"; }
    std::string operator()(const std::string*) const {
      return key.label ? "a name in quotes, of letters, digits, _ and -" : "text in quotes";
    }
    std::string operator()(const std::filesystem::path*) const {
      return "name of a file in quotes, relative to the scene file";
    }
    std::string operator()(const std::vector<double>*) const { return "a list, each element " + quantity; }
    std::string operator()(const std::vector<std::string>*) const { return "a list of any of " + choices; }
    std::string operator()(const MotionTable*) const {
      return operator()(static_cast<const std::filesystem::path*>(nullptr));
    }
    std::string operator()(const AngleTable*) const {
      return operator()(static_cast<const std::filesystem::path*>(nullptr));
    }
    std::string operator()(const Hydrograph*) const {
      return operator()(static_cast<const std::filesystem::path*>(nullptr));
    }
    std::string operator()(const WaterTable*) const {
      return operator()(static_cast<const std::filesystem::path*>(nullptr));
    }
    std::string operator()(const void*) const { return choices; }  // enumerations
  };
  return std::visit(Describe{key, choices, quantity, dimension}, target);
}

std::string Range::text() const {
  const bool below = std::isfinite(lower);
  const bool above = std::isfinite(upper);
  if (below && above) return number_text(lower) + " to " + number_text(upper);
  if (below) return (lower_open ? "> " : ">= ") + number_text(lower);
  if (above) return "<= " + number_text(upper);
  return {};
}

std::string scene_reference() {
  std::string page = R"(# Scene reference

<!-- Generated by `mps --reference` from the schema in mps/src/scene/schema.cpp: change it there. -->

A scene is a [TOML](https://toml.io) file in SI units. A number is SI; a text carries number and unit (`"2 mm"`) and is
checked against the quantity that the key expects. A vector has as many components as the scene has dimensions. Unknown
keys, wrong types and units, and values out of range are errors that name file, line and key.

Values can be replaced from the command line: `--set fluid.density=868`, `--set numerics.particle_distance="4 mm"`,
`--set parameters.depth=2.5cm`; tables that can occur several times go by their name: `--set water.upstream.level=0.3`.
Paths in the file are relative to its folder.

| quantity | SI unit | for example | units |
|---|---|---|---|
)";
  for (const Quantity quantity :
       {Quantity::length, Quantity::time, Quantity::speed, Quantity::acceleration, Quantity::density,
        Quantity::kinematic_viscosity, Quantity::pressure, Quantity::angle, Quantity::angular_speed,
        Quantity::acceleration_per_length, Quantity::discharge, Quantity::plain}) {
    const auto cell = [](std::string_view text) { return std::string(text) + " | "; };
    page += "| " + cell(quantity_name(quantity)) + cell(si_unit(quantity)) +
            cell("`\"" + std::string(example_of(quantity)) + "\"`") + std::string(usual_units(quantity)) + " |\n";
  }
  page += R"(
Units combine with `/` and powers (`kg/m3`, `kg/m^3`, `kg/m³`). Parameters and variables take units of mass (kg, g, mg, t),
force (N, kN, MN, mN), energy (J, kJ, mJ), power (W, kW), frequency (Hz, kHz) and volume (l) as well.

## `[parameters]`

Names and values of your own: numbers, quantities, text. `"$name"` stands for the value wherever a key takes such a value, also
in vectors and lists; sums, differences and products with plain numbers are possible: `"$depth + 2 * 3 mm"`. A plain number
counts as SI. Every parameter must be used somewhere; `[coupling.variables]` counts.
)";
  schema().for_each([&]<class T>(const Section<T>& section) {
    const std::string name = section.repeated ? "[[" + section.path + "]]" : "[" + section.path + "]";
    page += section.path.empty() ? "\n## Top of the file\n" : "\n## `" + name + "`\n";
    page += "\n" + section.meaning + "\n\n| key | type | default | allowed | meaning |\n|---|---|---|---|---|\n";
    for (const Field<T>& field : section.fields) {
      T fresh{};
      const Target target = field.target(fresh);
      page += "| `" + field.key.name + "` | " + type_text(field.key, target) + " | " + default_text(field.key, target) +
              " | " + allowed_text(field.key) + " | " + field.key.meaning + " |\n";
    }
  });
  page += R"(
## `[coupling.variables]`

Names and values that the LIGGGHTS script gets as `-var name value`: numbers, quantities (passed as their SI number, angles in
radians), other text as it stands, and `"$name"` of a parameter.
)";
  return page;
}

}  // namespace embacle::mps
