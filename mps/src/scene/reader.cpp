#include "scene/reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "scene/document.hpp"
#include "scene/rules.hpp"
#include "scene/schema.hpp"
#include "scene/stl.hpp"
#include "scene/suggest.hpp"
#include "scene/tables.hpp"
#include "scene/units.hpp"

namespace embacle::mps {
namespace {

namespace fs = std::filesystem;

/// A value refers to a parameter whose own problem is reported already.
struct AlreadyReported {};

class Reader {
 public:
  Reader(const fs::path& given, const std::vector<std::string>& overrides) : document_(given, overrides, problems_) {}

  Scene read() {
    Scene scene;
    scene.file = document_.file();
    read_parameters();
    const Schema& all = schema();
    read_section(document_.root(), "", all.root, scene);
    if (problems_.none_at("dimension")) dimension_ = scene.dimension;
    if (dimension_ == 2) scene.fluid.gravity = {0, -9.81, 0};
    read_single(all.domain, scene);
    read_single(all.fluid, scene.fluid);
    read_single(all.numerics, scene.numerics);
    read_repeated(all.water, scene.water, [&](Water& water, const toml::table&, const std::string&) {
      if (water.kind == Water::Kind::table) enclose(water, scene.numerics.particle_distance);
      if (water.kind > Water::Kind::table)
        shape(water, static_cast<int>(water.kind) - static_cast<int>(Water::Kind::table));
    });
    read_repeated(all.wall, scene.walls, [this](Wall& wall, const toml::table& table, const std::string& path) {
      if (wall.kind > Wall::Kind::box) shape(wall, static_cast<int>(wall.kind) - static_cast<int>(Wall::Kind::box));
      const toml::node* motion = table.get("motion");
      if (motion == nullptr) return;
      wall.motion.emplace();
      if (const auto* inner = section_table(*motion, path + ".motion"))
        read_section(*inner, path + ".motion", schema().motion, *wall.motion);
      normalise(wall.motion->axis);
    });
    read_repeated(all.opening, scene.openings, [](Opening&, const toml::table&, const std::string&) {});
    read_repeated(all.sponge, scene.sponges, [](Sponge&, const toml::table&, const std::string&) {});
    read_repeated(all.gauge, scene.gauges,
                  [](Gauge& gauge, const toml::table&, const std::string&) { normalise(gauge.direction); });
    if (document_.root().contains("coupling")) read_single(all.coupling, scene.coupling);
    read_variables(scene.coupling);
    read_single(all.output, scene.output);
    read_single(all.run, scene);
    std::sort(scene.output.pictures.begin(), scene.output.pictures.end());
    const RuleContext context{
        .given = [this](const std::string& path) { return document_.has(path); },
        .overridden = [this](const std::string& path) { return document_.override_of(path) != nullptr; },
        .sound = [this](const std::string& path) { return problems_.none_at(path); },
        .report = [this](const std::vector<std::string>& paths,
                         const std::string& problem) { document_.report_any(paths, problem); }};
    Rules(scene, context).check();
    problems_.throw_if_any();
    for (const auto& [name, parameter] : parameters_)
      if (!parameter.text) scene.parameters[name] = parameter.number.value;
    return scene;
  }

 private:
  struct Parameter {
    const toml::node* node = nullptr;
    enum { waiting, resolving, failed, done } status = waiting;
    Number number;
    std::optional<std::string> text;  ///< instead of a number
    std::string origin;               ///< override that its value comes from, if any
  };

  // Parameters.

  void read_parameters() {
    const toml::node* node = document_.root().get("parameters");
    const toml::table* table = node != nullptr ? section_table(*node, "parameters") : nullptr;
    if (table == nullptr) return;
    for (const auto& [key, child] : *table) parameters_[std::string(key.str())].node = &child;
    for (auto& [name, parameter] : parameters_) {
      const std::string path = "parameters." + name;
      if (!is_identifier(name))
        document_.report(path, "a parameter's name has letters, digits and _, and no digit in front");
      else if (!document_.used_parameters().contains(name))
        document_.report(path, "is not used; write \"$" + name +
                                   "\" as the value of a key or of a coupling.variables, or remove it");
      try {
        resolve(name);
      } catch (const AlreadyReported&) {
      }
    }
  }

  /// The value of a parameter. Throws ValueError where the reference itself is wrong, and AlreadyReported where the
  /// parameter's own value is.
  const Parameter& resolve(const std::string& name) {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) {
      std::vector<std::string> names;
      for (const auto& [known, parameter] : parameters_) names.push_back(known);
      throw ValueError("undefined parameter '$" + name + "'" + suggestion(name, names, "parameters"));
    }
    Parameter& parameter = found->second;
    if (parameter.status == Parameter::failed) throw AlreadyReported{};
    if (parameter.status == Parameter::resolving) throw ValueError("'$" + name + "' refers to itself");
    if (parameter.status == Parameter::done) return parameter;
    parameter.status = Parameter::resolving;
    const std::string path = "parameters." + name;
    const std::string* own = document_.override_of(path);
    const std::string outer = std::exchange(origin_, own != nullptr ? *own : "");
    try {
      read_parameter(parameter);
      parameter.status = Parameter::done;
    } catch (const ValueError& error) {
      parameter.status = Parameter::failed;
      report_value(path, error.what());
    } catch (const AlreadyReported&) {
      parameter.status = Parameter::failed;
    }
    parameter.origin = std::exchange(origin_, outer);
    if (parameter.status == Parameter::failed) throw AlreadyReported{};
    return parameter;
  }

  void read_parameter(Parameter& parameter) {
    if (const auto number = plain_number(*parameter.node)) {
      parameter.number.value = *number;
    } else if (const auto* text = parameter.node->as_string()) {
      const std::string& whole = text->get();
      if (whole.find('$') != std::string::npos || looks_like_quantity(whole))
        parameter.number = evaluated(whole, any_quantity);
      else
        parameter.text = whole;
    } else {
      throw ValueError("expected a number, a quantity or text, found " + what_it_is(*parameter.node));
    }
  }

  /// A finite TOML number; throws ValueError for nan and inf.
  static std::optional<double> plain_number(const toml::node& node) {
    if (const auto* number = node.as_integer()) return static_cast<double>(number->get());
    const auto* number = node.as_floating_point();
    if (number == nullptr) return std::nullopt;
    if (!std::isfinite(number->get())) throw ValueError("must be a finite number, found " + number_text(number->get()));
    return number->get();
  }

  // Values.

  static constexpr const char* any_quantity = "a number or a quantity such as \"2 mm\"";

  /// Evaluates a text; if it is none of what can be evaluated, the message says what is `allowed`.
  Number evaluated(const std::string& text, const std::string& allowed) {
    try {
      return evaluate(text, lookup_);
    } catch (const QuantityError& error) {
      const std::string message = error.what();
      throw ValueError(message + (message.ends_with('?') ? " " : "; ") + "allowed: " + allowed +
                       ", \"$name\" of a parameter, or sums and multiples of these");
    }
  }

  void wrong_type(const toml::node& node, const std::string& path, const Key& key, const Target& target) {
    document_.report(path, "found " + what_it_is(node) + "; allowed: " + expectation(key, target, dimension_));
  }

  /// Reports a problem with the value evaluated last; the override of a parameter in it is to blame if there is one.
  void report_value(const std::string& path, const std::string& problem) {
    if (!origin_.empty()) document_.note_origin(path, origin_);
    document_.report(path, problem);
  }

  void read_number(const toml::node& node, const std::string& path, const Key& key, const Target& target, double& out) {
    origin_.clear();
    try {
      double value = 0;
      if (const auto number = plain_number(node)) {
        value = *number;
      } else if (const auto* text = node.as_string()) {
        value = to_si(evaluated(text->get(), how_to_write(key.quantity)), key.quantity, text->get());
      } else {
        return wrong_type(node, path, key, target);
      }
      const std::string unit = (key.quantity == Quantity::plain ? "" : " ") + std::string(si_unit(key.quantity));
      if (!key.range.contains(value))
        throw ValueError(number_text(value) + unit + " is out of range; allowed: " + key.range.text() + unit);
      if (!origin_.empty()) document_.note_origin(path, origin_);
      out = value;
    } catch (const ValueError& error) {
      report_value(path, error.what());
    } catch (const AlreadyReported&) {
      document_.report(path, "");
    }
  }

  /// A text, also by way of a parameter that is a text.
  std::optional<std::string> read_text(const toml::node& node, const std::string& path, const Key& key,
                                       const Target& target) {
    const auto* text = node.as_string();
    if (text == nullptr) {
      wrong_type(node, path, key, target);
      return std::nullopt;
    }
    const std::string& whole = text->get();
    if (whole.empty() || whole.front() != '$' || !is_identifier(whole.substr(1))) return whole;
    try {
      const Parameter& parameter = resolve(whole.substr(1));
      if (!parameter.origin.empty()) document_.note_origin(path, parameter.origin);
      if (parameter.text) return *parameter.text;
      document_.report(path, "'" + whole + "' is a number; allowed: " + expectation(key, target, dimension_));
    } catch (const ValueError& error) {
      document_.report(path, error.what());
    } catch (const AlreadyReported&) {
      document_.report(path, "");
    }
    return std::nullopt;
  }

  std::optional<std::size_t> read_choice(const toml::node& node, const std::string& path, const Key& key,
                                         const Target& target) {
    const auto text = read_text(node, path, key, target);
    if (!text) return std::nullopt;
    const auto found = std::find(key.choices.begin(), key.choices.end(), *text);
    if (found != key.choices.end()) return static_cast<std::size_t>(found - key.choices.begin());
    document_.report(path, "unknown value '" + *text + "'" + suggestion(*text, key.choices));
    return std::nullopt;
  }

  // One overload for each type that a key can have.

  void read_value(const toml::node& node, const std::string& path, const Key& key, double& out) {
    read_number(node, path, key, &out, out);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::optional<double>& out) {
    read_number(node, path, key, &out, out.emplace());
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, Vec3d& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return wrong_type(node, path, key, &out);
    if (array->size() != static_cast<std::size_t>(dimension_))
      return document_.report(path, "has " + std::to_string(array->size()) + " components, the scene " +
                                        std::to_string(dimension_) +
                                        " dimensions; allowed: " + expectation(key, &out, dimension_));
    Vec3d result{};
    for (std::size_t axis = 0; axis < array->size(); ++axis)
      read_number(*array->get(axis), path, key, &out, result[axis]);
    out = result;
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::optional<Vec3d>& out) {
    read_value(node, path, key, out.emplace());
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, Polygon& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return wrong_type(node, path, key, &out);
    for (const toml::node& element : *array) {
      const auto* pair = element.as_array();
      if (pair == nullptr || pair->size() != 2) return wrong_type(element, path, key, &out);
      Vec3d& point = out.emplace_back();
      for (std::size_t axis = 0; axis < 2; ++axis) read_number(*pair->get(axis), path, key, &out, point[axis]);
    }
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, SurfacePointer& out) {
    auto surface = std::make_shared<Surface>();
    read_table_of(
        node, path, key, *surface, +[](const fs::path& file, int) { return read_surface(file); });
    if (!surface->triangles.empty()) out = std::move(surface);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::vector<double>& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return wrong_type(node, path, key, &out);
    out.assign(array->size(), 0.0);
    for (std::size_t i = 0; i < array->size(); ++i) read_number(*array->get(i), path, key, &out, out[i]);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, int& out) {
    if (node.is_floating_point()) return wrong_type(node, path, key, &out);
    double value = out;
    read_number(node, path, key, &out, value);
    if (value != std::floor(value))
      return document_.report(path,
                              number_text(value) + " is not whole; allowed: " + expectation(key, &out, dimension_));
    out = static_cast<int>(value);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, bool& out) {
    if (const auto* truth = node.as_boolean())
      out = truth->get();
    else
      wrong_type(node, path, key, &out);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::optional<bool>& out) {
    read_value(node, path, key, out.emplace());
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::string& out) {
    const auto text = read_text(node, path, key, &out);
    if (!text) return;
    const bool is_label = !text->empty() && std::all_of(text->begin(), text->end(), [](char c) {
      return is_identifier(std::string("_") + c) || c == '-';
    });
    if (key.label && !is_label)
      return document_.report(path, "'" + *text + "' cannot be a name; allowed: " + expectation(key, &out, dimension_));
    out = *text;
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, std::vector<std::string>& out) {
    const auto* array = node.as_array();
    if (array == nullptr) return wrong_type(node, path, key, &out);
    for (const toml::node& element : *array)
      if (const auto index = read_choice(element, path, key, &out)) out.push_back(key.choices[*index]);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, fs::path& out) {
    const auto text = read_text(node, path, key, &out);
    if (!text) return;
    const fs::path file = (document_.file().parent_path() / *text).lexically_normal();
    std::error_code error;
    if (fs::is_regular_file(file, error))
      out = file;
    else
      document_.report(
          path, (fs::exists(file, error) ? "'" + *text + "' is not a file" : "there is no file '" + *text + "'") +
                    " (looked for " + file.string() + ")");
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, MotionTable& out) {
    read_table_of(node, path, key, out, read_motion_table);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, AngleTable& out) {
    read_table_of(node, path, key, out, read_angle_table);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, Hydrograph& out) {
    read_table_of(node, path, key, out, read_hydrograph);
  }

  void read_value(const toml::node& node, const std::string& path, const Key& key, WaterTable& out) {
    read_table_of(node, path, key, out, read_water_table);
  }

  template <class Table>
  void read_table_of(const toml::node& node, const std::string& path, const Key& key, Table& out,
                     Table (*reading)(const fs::path&, int)) {
    fs::path file;
    read_value(node, path, key, file);
    if (file.empty()) return;
    const int line = document_.place_of(path).line;
    try {
      out = reading(file, dimension_);
    } catch (const TableError& error) {
      const std::string at = error.line > 0 ? ":" + std::to_string(error.line) : "";
      problems_.add(file.string() + at, line, path, error.what());
    }
  }

  template <class Enumeration>
  requires std::is_enum_v<Enumeration>
  void read_value(const toml::node& node, const std::string& path, const Key& key, Enumeration& out) {
    if (const auto index = read_choice(node, path, key, &out)) out = static_cast<Enumeration>(*index);
  }

  /// The region of water from a table: the box around its particles, each of which fills a cell.
  void enclose(Water& water, double cell) const {
    if (water.table.rows.empty()) return;
    water.region = {water.table.rows.front().position, water.table.rows.front().position};
    for (const WaterTable::Row& row : water.table.rows) {
      for (int axis = 0; axis < dimension_; ++axis) {
        water.region.lower[axis] = std::min(water.region.lower[axis], row.position[axis] - 0.5 * cell);
        water.region.upper[axis] = std::max(water.region.upper[axis], row.position[axis] + 0.5 * cell);
      }
    }
  }

  static void normalise(Vec3d& direction) {
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    if (length > 0)
      for (double& component : direction) component /= length;
  }

  /// Completes the form of a wall or of water: its kind, its true size, the box around it.
  template <class T>
  void shape(T& object, int kind) const {
    Form& form = object.form;
    form.kind = static_cast<Form::Kind>(kind);
    if (form.surface && form.scale != 1) {
      auto scaled = std::make_shared<Surface>(*form.surface);
      for (Triangle& triangle : scaled->triangles)
        for (Vec3d& corner : triangle.corner)
          for (double& coordinate : corner) coordinate *= form.scale;
      form.surface = std::move(scaled);
    }
    if (form.kind == Form::Kind::stl ? form.surface == nullptr : form.kind == Form::Kind::prism && form.polygon.empty())
      return;
    object.region = bounds(form, dimension_);
  }

  // Sections.

  const toml::table* section_table(const toml::node& node, const std::string& path) {
    if (const auto* table = node.as_table()) return table;
    document_.report(path, node.is_array_of_tables()
                               ? "may stand only once: write [" + path + "], not [[" + path + "]]"
                               : "found " + what_it_is(node) + "; allowed: a section, [" + path + "]");
    return nullptr;
  }

  template <class T>
  void read_section(const toml::table& table, const std::string& path, const Section<T>& section, T& object) {
    for (const auto& [name, node] : table) {
      const std::string child = joined(path, name.str());
      if (const Field<T>* field = section.find(name.str()))
        std::visit([&, &value = node](auto* out) { read_value(value, child, field->key, *out); },
                   field->target(object));
      else if (std::find(section.tables.begin(), section.tables.end(), name.str()) == section.tables.end())
        unknown(std::string(name.str()), node, child, section);
    }
    for (const Field<T>& field : section.fields)
      if (field.key.required && !table.contains(field.key.name))
        document_.report(joined(path, field.key.name),
                         "required, but missing; allowed: " + expectation(field.key, field.target(object), dimension_));
  }

  template <class T>
  void unknown(const std::string& name, const toml::node& node, const std::string& path, const Section<T>& section) {
    std::vector<std::string> names = section.tables;
    for (const auto& field : section.fields) names.push_back(field.key.name);
    std::sort(names.begin(), names.end());
    std::string home;
    schema().for_each([&](const auto& other) {
      if (other.find(name) != nullptr && home.empty())
        home = other.path.empty() ? "the top of the file, before all sections" : "[" + other.path + "]";
    });
    std::string problem = node.is_table() || node.is_array_of_tables() ? "unknown section" : "unknown key";
    if (!home.empty() && nearest(name, names).empty()) problem += "; it belongs to " + home;
    document_.report(path, problem + suggestion(name, names));
  }

  template <class T>
  void read_single(const Section<T>& section, T& object) {
    static const toml::table empty;
    const toml::node* node = document_.root().get(section.path);
    const toml::table* table = node != nullptr ? section_table(*node, section.path) : &empty;
    if (table != nullptr) read_section(*table, section.path, section, object);
  }

  /// `more(object, table, path)` reads what is no plain key of the section.
  template <class T, class F>
  void read_repeated(const Section<T>& section, std::vector<T>& objects, F&& more) {
    const toml::node* node = document_.root().get(section.path);
    if (node == nullptr) return;
    const toml::array* array = node->as_array();
    if (array == nullptr || (!array->empty() && !array->is_array_of_tables()))
      return document_.report(
          section.path,
          "found " + what_it_is(*node) + "; allowed: any number of sections, each begun by [[" + section.path + "]]");
    const std::vector<std::string> paths = document_.elements(section.path);
    for (std::size_t i = 0; i < array->size(); ++i) {
      const toml::table& table = *array->get(i)->as_table();
      T& object = objects.emplace_back();
      if constexpr (requires { object.line; }) object.line = document_.place_of(paths[i]).line;
      read_section(table, paths[i], section, object);
      more(object, table, paths[i]);
      if (const std::string first = document_.earlier_namesake(paths[i]); !first.empty())
        document_.report(paths[i] + ".name", "'" + object.name + "' is taken by the [[" + section.path + "]] at " +
                                                 document_.place_of(first).text);
    }
  }

  void read_variables(Coupling& coupling) {
    const toml::node* node = document_.root().at_path("coupling.variables").node();
    const toml::table* table = node != nullptr ? section_table(*node, "coupling.variables") : nullptr;
    if (table == nullptr) return;
    for (const auto& [key, value] : *table) {
      const std::string name(key.str());
      const std::string path = "coupling.variables." + name;
      try {
        if (!is_identifier(name))
          throw ValueError("a variable's name has letters, digits and _, and no digit in front");
        coupling.variables[name] = variable_text(value);
      } catch (const ValueError& error) {
        report_value(path, error.what());
      } catch (const AlreadyReported&) {
        document_.report(path, "");
      }
    }
  }

  /// A variable as the script gets it: numbers and quantities in SI, other text as it stands.
  std::string variable_text(const toml::node& node) {
    if (const auto number = plain_number(node)) return number_text(*number);
    const auto* text = node.as_string();
    if (text == nullptr)
      throw ValueError("found " + what_it_is(node) + "; allowed: a number, a quantity, text, \"$name\"");
    const std::string& whole = text->get();
    if (whole.starts_with('$') && is_identifier(whole.substr(1))) {
      const Parameter& parameter = resolve(whole.substr(1));
      return parameter.text ? *parameter.text : number_text(parameter.number.value);
    }
    const bool computed = whole.find('$') != std::string::npos || looks_like_quantity(whole);
    return computed ? number_text(evaluated(whole, any_quantity).value) : whole;
  }

  Problems problems_;
  Document document_;
  int dimension_ = 3;
  std::map<std::string, Parameter> parameters_;
  std::string origin_;  ///< override of a parameter that the value being evaluated uses
  const ParameterLookup lookup_ = [this](const std::string& name) {
    const Parameter& parameter = resolve(name);
    if (parameter.text) throw ValueError("'$" + name + "' is the text '" + *parameter.text + "', not a number");
    if (!parameter.origin.empty()) origin_ = parameter.origin;
    return parameter.number;
  };
};

}  // namespace

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return Reader(path, overrides).read();
}

}  // namespace embacle::mps
