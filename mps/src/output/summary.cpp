#include "summary.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "files.hpp"

namespace embacle::mps {
namespace {

/// JSON knows no infinity and no NaN: both become null.
std::string number_text(double value) {
  if (!std::isfinite(value)) return "null";
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      constexpr const char* hex = "0123456789abcdef";
      out += std::string("\\u00") + hex[c >> 4] + hex[c & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// The items' texts between brackets.
template <typename Items, typename Text>
std::string list(const std::string& open, const Items& items, const std::string& separator, const std::string& close,
                 Text text) {
  std::string out = open;
  bool first = true;
  for (const auto& item : items) {
    if (!first) out += separator;
    out += text(item);
    first = false;
  }
  return out += close;
}

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

}  // namespace

Json::Value& Json::slot(const std::string& key) {
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const auto& m) { return m.first == key; });
  if (found != members_.end()) return found->second;
  return members_.emplace_back(key, Value{}).second;
}

double Json::number(const std::string& key) const {
  const auto found = std::find_if(members_.begin(), members_.end(), [&](const auto& m) { return m.first == key; });
  const double* value = found != members_.end() ? std::get_if<double>(&found->second) : nullptr;
  return value != nullptr ? *value : std::numeric_limits<double>::quiet_NaN();
}

Json& Json::set(const std::string& key, double value) {
  slot(key) = value;
  return *this;
}
Json& Json::set(const std::string& key, std::int64_t value) {
  slot(key) = value;
  return *this;
}
Json& Json::set(const std::string& key, bool value) {
  slot(key) = value;
  return *this;
}
Json& Json::set(const std::string& key, const std::string& value) {
  slot(key) = value;
  return *this;
}
Json& Json::set(const std::string& key, const Array& values) {
  slot(key) = values;
  return *this;
}
Json& Json::set(const std::string& key, const std::vector<std::string>& values) {
  slot(key) = values;
  return *this;
}

Json::Objects& Json::objects(const std::string& key, bool array) {
  Value& value = slot(key);
  if (!std::holds_alternative<Objects>(value)) value = Objects{{}, array};
  auto& found = std::get<Objects>(value);
  if (found.array != array) throw std::logic_error("JSON member " + key + " is both an object and an array");
  return found;
}

Json& Json::object(const std::string& key) {
  auto& found = objects(key, false);
  if (found.items.empty()) found.items.emplace_back();
  return found.items.front();
}

Json& Json::append(const std::string& key) { return objects(key, true).items.emplace_back(); }

std::string Json::text(int indent) const {
  if (members_.empty()) return "{}";
  const std::string inner(static_cast<std::size_t>(indent) + 2, ' ');
  std::string close(1, '\n');
  close.append(static_cast<std::size_t>(indent), ' ').append(1, '}');
  const auto value_text = Overloaded{
      [](double value) { return number_text(value); },
      [](std::int64_t value) { return std::to_string(value); },
      [](bool value) { return std::string(value ? "true" : "false"); },
      [](const std::string& value) { return quoted(value); },
      [](const Array& values) { return list("[", values, ", ", "]", number_text); },
      [](const std::vector<std::string>& values) { return list("[", values, ", ", "]", quoted); },
      [&](const Objects& objects) {
        if (!objects.array) return objects.items.front().text(indent + 2);
        const std::string deeper = inner + "  ";
        return list("[\n" + deeper, objects.items, ",\n" + deeper, "\n" + inner + "]",
                    [&](const Json& item) { return item.text(indent + 4); });
      },
  };
  return list("{\n", members_, ",\n", close, [&](const auto& member) {
    return inner + quoted(member.first) + ": " + std::visit(value_text, member.second);
  });
}

void write_json(const std::filesystem::path& path, const Json& json) { write_whole_file(path, json.text() + "\n"); }

}  // namespace embacle::mps
