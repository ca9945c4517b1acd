// Quantities with units, as users write them ("2.5 cm", "$depth + 2 mm"), turned into SI numbers.
#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace embacle::mps {

/// What a number of a scene measures. `plain` has no unit.
enum class Quantity {
  plain,
  length,
  time,
  speed,
  acceleration,
  density,
  kinematic_viscosity,
  pressure,
  angle,
  angular_speed,
  acceleration_per_length,
  discharge
};

/// Exponents of metre, kilogram, second and radian.
struct Dimension {
  int length = 0;
  int mass = 0;
  int time = 0;
  int angle = 0;
  bool operator==(const Dimension&) const = default;
};

/// A number in SI. Without a dimension it is a plain number, which counts as the SI value of whatever is expected.
struct Number {
  double value = 0;
  std::optional<Dimension> dimension;
};

/// A text that is no valid value; the message says why and what is allowed, but not where.
class ValueError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A text that is no quantity at all; the message leaves it to the catcher to say what is allowed.
class QuantityError : public ValueError {
 public:
  using ValueError::ValueError;
};

[[nodiscard]] Dimension dimension_of(Quantity quantity);
/// "length", "kinematic viscosity" ...
[[nodiscard]] std::string_view quantity_name(Quantity quantity);
/// "a length", "an acceleration" ...
[[nodiscard]] std::string a_quantity(Quantity quantity);
/// "m", "m2/s" ...; empty for plain numbers.
[[nodiscard]] std::string_view si_unit(Quantity quantity);
/// "2 mm", "1e-6 m2/s" ...
[[nodiscard]] std::string_view example_of(Quantity quantity);
/// Usual units, comma separated: "m, dm, cm, mm, um, km".
[[nodiscard]] std::string_view usual_units(Quantity quantity);
/// How to write it: `a number in m or text such as "2 mm" (units m, cm, ...)`.
[[nodiscard]] std::string how_to_write(Quantity quantity);

/// Value of a `$name`; throws ValueError if there is none or it is not a number.
using ParameterLookup = std::function<Number(const std::string& name)>;

/// Evaluates a quantity ("2 mm"), a parameter ("$depth") or a sum, difference or product with plain numbers of these
/// ("$depth + 2 * 3 mm"). Throws QuantityError if it is none of these, ValueError if they do not fit together.
[[nodiscard]] Number evaluate(std::string_view text, const ParameterLookup& lookup);

/// The SI value of `number`, which must measure `quantity` or be plain. `text` is what the user wrote, for the message
/// of the ValueError.
[[nodiscard]] double to_si(const Number& number, Quantity quantity, std::string_view text);

/// A number directly followed by a word: what a quantity looks like, with a known unit or not.
[[nodiscard]] bool looks_like_quantity(std::string_view text);

/// True for names that can be written as $name: a letter or underscore, then letters, digits, underscores.
[[nodiscard]] bool is_identifier(std::string_view text);

/// Shortest text that gives the same number again; whole numbers without exponent or decimal point.
[[nodiscard]] std::string number_text(double value);

}  // namespace embacle::mps
