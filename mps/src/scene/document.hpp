// The scene file as a TOML document with the overrides applied, which knows where each key comes from.
// Included by reader.cpp only.
#pragma once

// Its assertion in front of keys fires on some malformed files ("[.]") that the line after it reports as an error.
#ifndef TOML_ASSERT
#define TOML_ASSERT(condition) static_cast<void>(0)
#endif
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"
#include "scene/suggest.hpp"
#include "scene/units.hpp"

namespace embacle::mps {

/// Where a key comes from.
struct Place {
  std::string text;  ///< "scene.toml:12" or "--set key=value"
  int line = 0;      ///< 0 for an override
};

[[nodiscard]] inline std::string joined(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

/// "a.b.c" -> "a.b"; "a" -> "".
[[nodiscard]] inline std::string parent_of(const std::string& path) {
  const auto point = path.rfind('.');
  return point == std::string::npos ? "" : path.substr(0, point);
}

[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The trimmed parts of `text` between the separators.
[[nodiscard]] inline std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.emplace_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return parts;
}

/// Sections written [[name]], whose elements are addressed by their key `name`.
[[nodiscard]] inline bool is_repeated(std::string_view section) {
  return section == "water" || section == "wall" || section == "opening" || section == "sponge" || section == "gauge";
}

/// "text 'abc'", "number 3", "a list" ...
[[nodiscard]] inline std::string what_it_is(const toml::node& node) {
  if (const auto* text = node.as_string()) return "text '" + text->get() + "'";
  if (const auto* integer = node.as_integer()) return "number " + std::to_string(integer->get());
  if (const auto* number = node.as_floating_point()) return "number " + number_text(number->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  if (node.is_array()) return "a list";
  if (node.is_table()) return "a section";
  return "a date or time";
}

/// A scene, or a table that someone has typed, beyond this is some other file [bytes].
constexpr std::uintmax_t largest_scene_file = 1 << 24;

/// The whole text of a regular file of at most `largest` bytes. Throws ValueError.
[[nodiscard]] inline std::string file_text(const std::filesystem::path& file,
                                           std::uintmax_t largest = largest_scene_file) {
  std::error_code error;
  if (const auto size = std::filesystem::file_size(file, error); !error && size > largest)
    throw ValueError("is larger than " + std::to_string(largest >> 20) + " MiB: not a file of this kind");
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) throw ValueError("cannot be read (permission?)");
  return text;
}

class Document {
 public:
  /// `given`: scene file or folder with scene.toml. Throws InputError if it is missing or no TOML; problems with
  /// overrides go to `problems`.
  Document(const std::filesystem::path& given, const std::vector<std::string>& overrides, Problems& problems)
      : shown_(find_scene_file(given)), problems_(problems) {
    parse();
    note_used_parameters(root_);
    for (const std::string& text : overrides) apply(text);
    note_used_parameters(root_);
    index(root_, "");
  }

  [[nodiscard]] const toml::table& root() const { return root_; }
  /// The scene file, absolute.
  [[nodiscard]] std::filesystem::path file() const { return std::filesystem::absolute(shown_).lexically_normal(); }
  [[nodiscard]] bool has(const std::string& path) const { return lines_.contains(path); }
  /// The override that has set exactly this key, or null.
  [[nodiscard]] const std::string* override_of(const std::string& path) const {
    const auto found = overridden_.find(path);
    return found == overridden_.end() ? nullptr : &found->second;
  }
  /// Names that stand as $name somewhere in the file or the overrides.
  [[nodiscard]] const std::set<std::string>& used_parameters() const { return used_; }
  /// Paths of the elements of a repeated section: "water.upstream", or "water[2]" without a name of its own.
  [[nodiscard]] std::vector<std::string> elements(const std::string& section) const {
    const auto found = elements_.find(section);
    return found == elements_.end() ? std::vector<std::string>{} : found->second;
  }
  /// The earlier element with the same name, if there is one; else empty.
  [[nodiscard]] std::string earlier_namesake(const std::string& element) const {
    const auto found = namesakes_.find(element);
    return found == namesakes_.end() ? "" : found->second;
  }
  /// Notes that the value of `path` comes from a parameter that an override has set.
  void note_origin(const std::string& path, const std::string& override_text) { origins_[path] = override_text; }

  [[nodiscard]] Place place_of(const std::string& path) const {
    for (std::string at = path; !at.empty(); at = parent_of(at))
      if (const std::string* text = override_of(at)) return {"--set " + *text, 0};
    Place place{shown_.string(), 0};
    for (std::string at = path; !at.empty() && place.line == 0; at = parent_of(at))
      if (const auto found = lines_.find(at); found != lines_.end()) place.line = found->second;
    if (place.line > 0) place.text += ":" + std::to_string(place.line);
    if (const auto found = origins_.find(path); found != origins_.end())
      return {"--set " + found->second + " (" + place.text + ")", 0};
    return place;
  }

  void report(const std::string& path, const std::string& problem) {
    const Place place = place_of(path);
    problems_.add(place.text, place.line, path, problem);
  }

  /// Of several keys that a problem involves, one set by an override is to blame; else the first.
  void report_any(const std::vector<std::string>& paths, const std::string& problem) {
    for (const std::string& path : paths)
      if (const Place place = place_of(path); place.text.starts_with("--set "))
        return problems_.add(place.text, place.line, paths.front(), problem);
    report(paths.front(), problem);
  }

 private:
  /// Scene file as given, or the scene.toml of a folder. Throws InputError if there is none.
  static std::filesystem::path find_scene_file(const std::filesystem::path& given) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(given, error);
    if (std::filesystem::is_directory(status)) {
      const std::filesystem::path file = given / "scene.toml";
      if (!std::filesystem::is_regular_file(file, error))
        throw coupling::InputError(given.string() +
                                   ": the folder has no scene.toml; name a scene file or a folder with one");
      return file;
    }
    if (!std::filesystem::exists(status)) {
      std::vector<std::string> neighbours;
      const std::filesystem::path parent =
          given.parent_path().empty() ? std::filesystem::path(".") : given.parent_path();
      for (std::filesystem::directory_iterator it(parent, error), end; !error && it != end; it.increment(error))
        neighbours.push_back(it->path().filename().string());
      throw coupling::InputError(given.string() + ": no such scene file or folder" +
                                 did_you_mean(given.filename().string(), neighbours));
    }
    if (!std::filesystem::is_regular_file(status))
      throw coupling::InputError(given.string() + ": neither a file nor a folder");
    return given;
  }

  /// Whether the value in a line of TOML looks like text or a quantity that lacks its quotes.
  static bool lacks_quotes(const std::string& text, unsigned line) {
    std::size_t begin = 0;
    for (unsigned i = 1; i < line && begin != std::string::npos; ++i) {
      begin = text.find('\n', begin);
      if (begin != std::string::npos) ++begin;
    }
    if (begin == std::string::npos) return false;
    const std::string_view whole = std::string_view(text).substr(begin, text.find('\n', begin) - begin);
    const auto equals = whole.find('=');
    if (equals == std::string_view::npos) return false;
    const std::string_view value = trimmed(whole.substr(equals + 1));
    return !value.empty() && value.find_first_of("\"'") == std::string_view::npos &&
           std::any_of(value.begin(), value.end(), [](char c) { return (c >= 'a' && c <= 'z') || c == '$'; });
  }

  void parse() {
    std::string text;
    try {
      text = file_text(shown_);
      root_ = toml::parse(text, shown_.string());
    } catch (const ValueError& error) {
      throw coupling::InputError(shown_.string() + ": " + error.what());
    } catch (const toml::parse_error& error) {
      const auto at = error.source().begin;
      throw coupling::InputError(
          shown_.string() + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) +
          ": not valid TOML: " + std::string(error.description()) +
          (lacks_quotes(text, at.line) ? " (quantities, words and $names need quotes, for example \"2 mm\")" : ""));
    }
  }

  void note_used_parameters(const toml::node& node) {
    if (const auto* table = node.as_table()) {
      for (const auto& [key, child] : *table) note_used_parameters(child);
    } else if (const auto* array = node.as_array()) {
      for (const auto& child : *array) note_used_parameters(child);
    } else if (const auto* text = node.as_string()) {
      const std::string& whole = text->get();
      for (auto at = whole.find('$'); at != std::string::npos; at = whole.find('$', at + 1)) {
        std::size_t end = at + 1;
        while (end < whole.size() && is_identifier(whole.substr(at + 1, end - at))) ++end;
        used_.insert(whole.substr(at + 1, end - at - 1));
      }
    }
  }

  /// The element of a list of tables that has this name, or null.
  static toml::table* named_element(toml::node* list, const std::string& name, std::vector<std::string>& names) {
    toml::table* found = nullptr;
    if (list == nullptr || !list->is_array()) return found;
    for (auto& element : *list->as_array())
      if (auto* table = element.as_table())
        if (const auto label = (*table)["name"].value<std::string>()) {
          names.push_back(*label);
          if (*label == name && found == nullptr) found = table;
        }
    return found;
  }

  void apply(const std::string& text) {
    const auto fail = [&](const std::string& key, const std::string& problem) {
      problems_.add("--set " + text, 0, key, problem);
    };
    const auto equals = text.find('=');
    const std::string path(trimmed(std::string_view(text).substr(0, equals)));
    const std::string_view value =
        equals == std::string::npos ? std::string_view{} : trimmed(std::string_view(text).substr(equals + 1));
    const std::vector<std::string> keys = split(path, '.');
    if (value.empty() || std::find(keys.begin(), keys.end(), "") != keys.end())
      return fail("", "expected key.path=value, for example fluid.density=868");
    std::optional<toml::table> parsed = parse_value(value);
    if (!parsed) return fail(path, "the value is not valid TOML; quantities in lists need quotes: [\"2 cm\", 0, 0]");

    toml::table* table = &root_;
    std::string at;
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
      at = joined(at, keys[i]);
      toml::node* child = table->get(keys[i]);
      if (i == 0 && is_repeated(keys[0])) {
        std::vector<std::string> names;
        table = named_element(child, keys[1], names);
        at = joined(at, keys[1]);
        if (table == nullptr)
          return fail(at, "no [[" + keys[0] + "]] has this name" + suggestion(keys[1], names, "names"));
        if (keys.size() == 2) return fail(at, "a key must follow the name: " + at + ".KEY=value");
        if (keys.size() == 3 && keys[2] == "name") return fail(path, "a name is what --set goes by and cannot be set");
        i = 1;
        continue;
      }
      if (child == nullptr) {
        child = &table->insert_or_assign(keys[i], toml::table{}).first->second;
        overridden_[at] = text;
      }
      table = child->as_table();
      if (table == nullptr) return fail(path, "'" + at + "' is no section");
    }
    if (keys[0] == "parameters" && keys.size() == 2 && !table->contains(keys[1])) {
      std::vector<std::string> names;
      for (const auto& [key, node] : *table) names.emplace_back(key.str());
      return fail(path, "the scene has no such parameter" + suggestion(keys[1], names, "parameters"));
    }
    table->insert_or_assign(keys.back(), *parsed->get("v"));
    overridden_[path] = text;
  }

  /// The value of an override as {v = value}; a bare word or quantity becomes text.
  static std::optional<toml::table> parse_value(std::string_view value) {
    try {
      toml::table parsed = toml::parse("v = " + std::string(value));
      if (parsed.size() == 1) return parsed;
    } catch (const toml::parse_error&) {
      if (std::string_view("\"'[{").find(value.front()) != std::string_view::npos) return std::nullopt;
    }
    return toml::table{{"v", std::string(value)}};
  }

  /// Notes the line of every key; tables in lists go by their name.
  void index(const toml::node& node, const std::string& path) {
    if (!path.empty()) lines_[path] = static_cast<int>(node.source().begin.line);
    if (const auto* table = node.as_table()) {
      for (const auto& [key, child] : *table) index(child, joined(path, key.str()));
    } else if (const auto* array = node.as_array(); array != nullptr && is_repeated(path)) {
      for (std::size_t i = 0; i < array->size(); ++i) {
        const auto* element = array->get(i)->as_table();
        const auto name = element != nullptr ? (*element)["name"].value<std::string>() : std::nullopt;
        std::string label = path + "." + name.value_or("");
        if (!name || lines_.contains(label)) {
          label = path + "[" + std::to_string(i + 1) + "]";
          if (name) namesakes_[label] = path + "." + *name;
        }
        elements_[path].push_back(label);
        index(*array->get(i), label);
      }
    }
  }

  std::filesystem::path shown_;  ///< as the user wrote it
  Problems& problems_;
  toml::table root_;
  std::map<std::string, int> lines_;
  std::map<std::string, std::string> overridden_;  ///< path -> text of the override
  std::map<std::string, std::string> origins_;     ///< path -> override of a parameter that its value uses
  std::map<std::string, std::vector<std::string>> elements_;
  std::map<std::string, std::string> namesakes_;
  std::set<std::string> used_;
};

}  // namespace embacle::mps
