// summary.json: what ran, where, how long, and what came out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace embacle::mps {

/// A small ordered JSON object builder, enough for summary.json (numbers, strings, booleans, nested objects, arrays).
class Json {
 public:
  using Array = std::vector<double>;
  Json& set(const std::string& key, double value);
  Json& set(const std::string& key, std::int64_t value);
  Json& set(const std::string& key, int value) { return set(key, static_cast<std::int64_t>(value)); }
  Json& set(const std::string& key, bool value);
  Json& set(const std::string& key, const std::string& value);
  Json& set(const std::string& key, const char* value) { return set(key, std::string(value)); }
  Json& set(const std::string& key, const Array& values);
  Json& set(const std::string& key, const std::vector<std::string>& values);
  Json& object(const std::string& key);  ///< nested object, created on first use
  Json& append(const std::string& key);  ///< new last object of an array of objects; valid until the next append to it
  /// A number set before; NaN if there is none under this key.
  [[nodiscard]] double number(const std::string& key) const;
  [[nodiscard]] std::string text(int indent = 0) const;

 private:
  struct Objects {
    std::vector<Json> items;
    bool array = false;  ///< an array of objects; otherwise `items` holds the one nested object
  };
  using Value = std::variant<double, std::int64_t, bool, std::string, Array, std::vector<std::string>, Objects>;
  std::vector<std::pair<std::string, Value>> members_;
  Value& slot(const std::string& key);
  Objects& objects(const std::string& key, bool array);
};

/// Writes beside and renames, so that the file is always whole. Throws coupling::SystemError.
void write_json(const std::filesystem::path& path, const Json& json);

}  // namespace embacle::mps
