#include "scene/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "scene/suggest.hpp"

namespace embacle::mps {
namespace {

struct QuantityEntry {
  Quantity quantity;
  Dimension dimension;
  std::string_view name;
  std::string_view si_unit;
  std::string_view example;
  std::string_view usual_units;
};

constexpr std::array<QuantityEntry, 12> quantities{{
    {Quantity::plain, {0, 0, 0, 0}, "plain number", "", "50 %", "%"},
    {Quantity::length, {1, 0, 0, 0}, "length", "m", "2 mm", "m, dm, cm, mm, um, km"},
    {Quantity::time, {0, 0, 1, 0}, "time", "s", "20 ms", "s, ms, us, min, h"},
    {Quantity::speed, {1, 0, -1, 0}, "speed", "m/s", "0.4 m/s", "m/s, cm/s, mm/s, km/h"},
    {Quantity::acceleration, {1, 0, -2, 0}, "acceleration", "m/s2", "9.81 m/s2", "m/s2, cm/s2, mm/s2"},
    {Quantity::density, {-3, 1, 0, 0}, "density", "kg/m3", "868 kg/m3", "kg/m3, g/cm3, t/m3"},
    {Quantity::kinematic_viscosity, {2, 0, -1, 0}, "kinematic viscosity", "m2/s", "1e-6 m2/s", "m2/s, cm2/s, mm2/s"},
    {Quantity::pressure, {-1, 1, -2, 0}, "pressure", "Pa", "1 kPa", "Pa, hPa, kPa, MPa, GPa, mbar, bar, N/m2"},
    {Quantity::angle, {0, 0, 0, 1}, "angle", "rad", "30 deg", "rad, deg"},
    {Quantity::angular_speed, {0, 0, -1, 1}, "angular speed", "rad/s", "10 deg/s", "rad/s, deg/s"},
    {Quantity::acceleration_per_length, {0, 0, -2, 0}, "acceleration per length", "m/s2/m", "1 m/s2/m", "m/s2/m, Hz2"},
    {Quantity::discharge, {3, 0, -1, 0}, "discharge", "m3/s", "12 l/s", "m3/s, l/s, m3/h"},
}};

/// Quantities that no key of a scene takes but that a parameter for the solid side's script may have.
struct NamedDimension {
  Dimension dimension;
  std::string_view name;
};
constexpr std::array<NamedDimension, 7> other_dimensions{{
    {{2, 0, 0, 0}, "area"},
    {{3, 0, 0, 0}, "volume"},
    {{0, 1, 0, 0}, "mass"},
    {{0, 0, -1, 0}, "frequency"},
    {{1, 1, -2, 0}, "force"},
    {{2, 1, -2, 0}, "energy"},
    {{0, 1, -2, 0}, "stiffness"},
}};

/// The SI value is x * up / down: two exact numbers, so that "7 mm" is exactly the 0.007 that one would write in SI.
struct Unit {
  std::string_view name;
  Dimension dimension;
  double up = 1;
  double down = 1;
};

constexpr std::array<Unit, 41> units{{
    {"m", {1, 0, 0, 0}, 1, 1},
    {"dm", {1, 0, 0, 0}, 1, 10},
    {"cm", {1, 0, 0, 0}, 1, 100},
    {"mm", {1, 0, 0, 0}, 1, 1000},
    {"um", {1, 0, 0, 0}, 1, 1e6},
    {"µm", {1, 0, 0, 0}, 1, 1e6},
    {"μm", {1, 0, 0, 0}, 1, 1e6},
    {"km", {1, 0, 0, 0}, 1000, 1},
    {"s", {0, 0, 1, 0}, 1, 1},
    {"ms", {0, 0, 1, 0}, 1, 1000},
    {"us", {0, 0, 1, 0}, 1, 1e6},
    {"µs", {0, 0, 1, 0}, 1, 1e6},
    {"min", {0, 0, 1, 0}, 60, 1},
    {"h", {0, 0, 1, 0}, 3600, 1},
    {"kg", {0, 1, 0, 0}, 1, 1},
    {"g", {0, 1, 0, 0}, 1, 1000},
    {"mg", {0, 1, 0, 0}, 1, 1e6},
    {"t", {0, 1, 0, 0}, 1000, 1},
    {"Hz", {0, 0, -1, 0}, 1, 1},
    {"kHz", {0, 0, -1, 0}, 1000, 1},
    {"mN", {1, 1, -2, 0}, 1, 1000},
    {"N", {1, 1, -2, 0}, 1, 1},
    {"kN", {1, 1, -2, 0}, 1000, 1},
    {"MN", {1, 1, -2, 0}, 1e6, 1},
    {"Pa", {-1, 1, -2, 0}, 1, 1},
    {"hPa", {-1, 1, -2, 0}, 100, 1},
    {"kPa", {-1, 1, -2, 0}, 1000, 1},
    {"MPa", {-1, 1, -2, 0}, 1e6, 1},
    {"GPa", {-1, 1, -2, 0}, 1e9, 1},
    {"mbar", {-1, 1, -2, 0}, 100, 1},
    {"bar", {-1, 1, -2, 0}, 1e5, 1},
    {"mJ", {2, 1, -2, 0}, 1, 1000},
    {"J", {2, 1, -2, 0}, 1, 1},
    {"kJ", {2, 1, -2, 0}, 1000, 1},
    {"W", {2, 1, -3, 0}, 1, 1},
    {"kW", {2, 1, -3, 0}, 1000, 1},
    {"rad", {0, 0, 0, 1}, 1, 1},
    {"deg", {0, 0, 0, 1}, std::numbers::pi, 180},
    {"°", {0, 0, 0, 1}, std::numbers::pi, 180},
    {"%", {0, 0, 0, 0}, 1, 100},
    {"l", {3, 0, 0, 0}, 1, 1000},
}};

const QuantityEntry& entry(Quantity quantity) {
  return *std::find_if(quantities.begin(), quantities.end(), [&](const auto& e) { return e.quantity == quantity; });
}

std::string with_article(std::string_view name) {
  const bool vowel = std::string_view("aeiou").find(name.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(name);
}

/// "a length [m]", "a mass [kg]", "[kg m-1]".
std::string describe(const Dimension& dimension) {
  std::string symbols;
  const auto append = [&](std::string_view symbol, int exponent) {
    if (exponent == 0) return;
    if (!symbols.empty()) symbols += ' ';
    symbols += symbol;
    if (exponent != 1) symbols += std::to_string(exponent);
  };
  append("kg", dimension.mass);
  append("m", dimension.length);
  append("s", dimension.time);
  append("rad", dimension.angle);
  std::string_view name;
  for (const auto& e : quantities)
    if (e.dimension == dimension) name = e.name;
  for (const auto& e : other_dimensions)
    if (e.dimension == dimension) name = e.name;
  if (symbols.empty()) return with_article(name);
  if (name.empty()) return "a quantity in [" + symbols + "]";
  return with_article(name) + " [" + symbols + "]";
}

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_space(char c) { return c == ' ' || c == '\t'; }
bool starts_unit(char c) { return is_letter(c) || c == '%' || static_cast<unsigned char>(c) >= 0x80; }
bool continues_unit(char c) { return starts_unit(c) || is_digit(c) || c == '/' || c == '^'; }

const Unit& find_unit(std::string_view name) {
  const auto found = std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == name; });
  if (found != units.end()) return *found;
  std::vector<std::string> names;
  names.reserve(std::size(units));
  for (const Unit& unit : units) names.emplace_back(unit.name);
  throw QuantityError("unknown unit '" + std::string(name) + "'" + did_you_mean(name, names));
}

/// Takes "m2", "m^2" or "m²" from the front of `text`: name and exponent.
std::pair<std::string_view, int> take_power(std::string_view& text) {
  static constexpr std::array<std::pair<std::string_view, int>, 2> superscripts{{{"²", 2}, {"³", 3}}};
  std::size_t end = 0;
  const auto superscript_at = [&](std::size_t i) {
    for (const auto& [sign, power] : superscripts)
      if (text.substr(i).starts_with(sign)) return std::pair{sign.size(), power};
    return std::pair{std::size_t{0}, 0};
  };
  while (end < text.size() && text[end] != '/' && text[end] != '^' && !is_digit(text[end]) &&
         superscript_at(end).first == 0)
    ++end;
  const std::string_view name = text.substr(0, end);
  int exponent = 1;
  if (const auto [size, power] = superscript_at(end); size > 0) {
    exponent = power;
    end += size;
  } else {
    if (end < text.size() && text[end] == '^') ++end;
    if (end < text.size() && is_digit(text[end])) exponent = text[end++] - '0';
  }
  text.remove_prefix(end);
  return {name, exponent};
}

/// "kg/m3": factors separated by '/', the first above the line, the others below.
Unit parse_unit(std::string_view whole) {
  Unit result{whole, {}, 1, 1};
  std::string_view rest = whole;
  for (int sign = 1;; sign = -1) {
    const auto [name, exponent] = take_power(rest);
    if (name.empty() || exponent == 0) throw QuantityError("unknown unit '" + std::string(whole) + "'");
    const Unit& unit = find_unit(name);
    for (int k = 0; k < exponent; ++k) {
      result.up *= sign > 0 ? unit.up : unit.down;
      result.down *= sign > 0 ? unit.down : unit.up;
    }
    result.dimension.length += sign * exponent * unit.dimension.length;
    result.dimension.mass += sign * exponent * unit.dimension.mass;
    result.dimension.time += sign * exponent * unit.dimension.time;
    result.dimension.angle += sign * exponent * unit.dimension.angle;
    if (rest.empty()) return result;
    if (rest.front() != '/') throw QuantityError("unknown unit '" + std::string(whole) + "'");
    rest.remove_prefix(1);
  }
}

/// sum = product {('+'|'-') product}; product = factor {'*' factor}; factor = ['-'] ('$' name | number [unit]).
class Expression {
 public:
  Expression(std::string_view text, const ParameterLookup& lookup) : text_(text), lookup_(lookup) {}

  Number value() {
    Number result = product();
    for (;;) {
      skip_space();
      if (done()) break;
      const char operation = text_[at_];
      if (operation != '+' && operation != '-') fail();
      ++at_;
      const Number term = product();
      if (result.dimension && term.dimension && *result.dimension != *term.dimension)
        throw ValueError("'" + std::string(text_) + "' adds or subtracts " + describe(*result.dimension) + " and " +
                         describe(*term.dimension));
      result.value += operation == '+' ? term.value : -term.value;
      if (!result.dimension) result.dimension = term.dimension;
    }
    if (!std::isfinite(result.value)) throw ValueError("'" + std::string(text_) + "' is too large a number");
    return result;
  }

 private:
  Number product() {
    Number result = factor();
    for (skip_space(); !done() && text_[at_] == '*'; skip_space()) {
      ++at_;
      const Number other = factor();
      if (result.dimension && other.dimension)
        throw ValueError("'" + std::string(text_) + "' multiplies " + describe(*result.dimension) + " by " +
                         describe(*other.dimension) + "; only multiplication by a plain number is possible");
      result.value *= other.value;
      if (!result.dimension) result.dimension = other.dimension;
    }
    return result;
  }

  Number factor() {
    skip_space();
    bool negative = false;
    if (!done() && text_[at_] == '-') {
      negative = true;
      ++at_;
      skip_space();
    }
    if (done()) fail();
    Number result = text_[at_] == '$' ? parameter() : literal();
    if (negative) result.value = -result.value;
    return result;
  }

  Number parameter() {
    std::size_t end = ++at_;
    while (end < text_.size() && (is_letter(text_[end]) || is_digit(text_[end]) || text_[end] == '_')) ++end;
    const std::string name(text_.substr(at_, end - at_));
    if (!is_identifier(name)) fail();
    at_ = end;
    return lookup_(name);
  }

  Number literal() {
    if (!is_digit(text_[at_]) && text_[at_] != '.') fail();
    Number result;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), result.value);
    if (error == std::errc::result_out_of_range)
      throw QuantityError("'" + std::string(text_) + "' is out of the range of numbers");
    if (error != std::errc{}) fail();
    at_ = static_cast<std::size_t>(end - text_.data());
    skip_space();
    if (done() || !starts_unit(text_[at_])) return result;
    std::size_t unit_end = at_;
    while (unit_end < text_.size() && continues_unit(text_[unit_end])) ++unit_end;
    const Unit unit = parse_unit(text_.substr(at_, unit_end - at_));
    at_ = unit_end;
    result.value = result.value * unit.up / unit.down;
    result.dimension = unit.dimension;
    return result;
  }

  [[noreturn]] void fail() const {
    std::string message = "cannot read '" + std::string(text_) + "'";
    if (at_ > 0 && !done()) message += " from '" + std::string(text_.substr(at_)) + "' on";
    if (text_.find(',') != std::string_view::npos) message += " (the decimal sign is a point)";
    throw QuantityError(message);
  }

  [[nodiscard]] bool done() const { return at_ >= text_.size(); }
  void skip_space() {
    while (!done() && is_space(text_[at_])) ++at_;
  }

  std::string_view text_;
  const ParameterLookup& lookup_;
  std::size_t at_ = 0;
};

}  // namespace

Dimension dimension_of(Quantity quantity) { return entry(quantity).dimension; }
std::string_view quantity_name(Quantity quantity) { return entry(quantity).name; }
std::string a_quantity(Quantity quantity) { return with_article(quantity_name(quantity)); }
std::string_view si_unit(Quantity quantity) { return entry(quantity).si_unit; }
std::string_view example_of(Quantity quantity) { return entry(quantity).example; }
std::string_view usual_units(Quantity quantity) { return entry(quantity).usual_units; }

std::string how_to_write(Quantity quantity) {
  const QuantityEntry& e = entry(quantity);
  if (quantity == Quantity::plain) return "a number without unit";
  return "a number in " + std::string(e.si_unit) + " or text such as \"" + std::string(e.example) + "\" (units " +
         std::string(e.usual_units) + ")";
}

Number evaluate(std::string_view text, const ParameterLookup& lookup) { return Expression(text, lookup).value(); }

double to_si(const Number& number, Quantity quantity, std::string_view text) {
  const std::string allowed = "; allowed: " + how_to_write(quantity);
  if (number.dimension && *number.dimension != dimension_of(quantity))
    throw ValueError("'" + std::string(text) + "' is " + describe(*number.dimension) + ", expected " +
                     a_quantity(quantity) + allowed);
  if (!number.dimension && text.find('$') == std::string_view::npos)
    throw ValueError("'" + std::string(text) + "' has no unit: write the number without quotes" + allowed);
  return number.value;
}

bool looks_like_quantity(std::string_view text) {
  std::size_t at = 0;
  if (!text.empty() && text.front() == '-') at = 1;
  if (at >= text.size() || (!is_digit(text[at]) && text[at] != '.')) return false;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), value);
  if (error == std::errc::invalid_argument) return false;
  at = static_cast<std::size_t>(end - text.data());
  while (at < text.size() && is_space(text[at])) ++at;
  if (at >= text.size() || !starts_unit(text[at])) return false;
  return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), continues_unit);
}

bool is_identifier(std::string_view text) {
  if (text.empty() || is_digit(text.front())) return false;
  return std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

std::string number_text(double value) {
  std::array<char, 64> buffer{};
  const bool whole = std::abs(value) < 1e15 && value == std::floor(value);
  const auto result = whole ? std::to_chars(buffer.data(), buffer.data() + buffer.size(), static_cast<long long>(value))
                            : std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

}  // namespace embacle::mps
