// Units and numbers as text.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "scene/units.hpp"
#include "scene_fixture.hpp"

namespace embacle::mps {
namespace {

TEST(Units, QuantitiesBecomeSi) {
  const ParameterLookup none = [](const std::string& name) -> Number { throw ValueError(name); };
  const auto si = [&](const char* text, Quantity quantity) { return to_si(evaluate(text, none), quantity, text); };
  EXPECT_EQ(si("2 mm", Quantity::length), 0.002);
  EXPECT_EQ(si("7 mm", Quantity::length), 0.007);
  EXPECT_EQ(si("2.5cm", Quantity::length), 0.025);
  EXPECT_EQ(si("-3 µm", Quantity::length), -3e-6);
  EXPECT_EQ(si("0.4 m/s", Quantity::speed), 0.4);
  EXPECT_EQ(si("36 km/h", Quantity::speed), 10);
  EXPECT_EQ(si("20 ms", Quantity::time), 0.02);
  EXPECT_EQ(si("2 min", Quantity::time), 120);
  EXPECT_EQ(si("1e-6 m2/s", Quantity::kinematic_viscosity), 1e-6);
  EXPECT_EQ(si("1 mm^2/s", Quantity::kinematic_viscosity), 1e-6);
  EXPECT_EQ(si("868 kg/m3", Quantity::density), 868);
  EXPECT_EQ(si("1 g/cm³", Quantity::density), 1000);
  EXPECT_EQ(si("9.81 m/s2", Quantity::acceleration), 9.81);
  EXPECT_EQ(si("9.81 m/s/s", Quantity::acceleration), 9.81);
  EXPECT_EQ(si("1 kPa", Quantity::pressure), 1000);
  EXPECT_EQ(si("1 kN/m2", Quantity::pressure), 1000);
  EXPECT_EQ(si("50 %", Quantity::plain), 0.5);
  EXPECT_DOUBLE_EQ(si("30 deg", Quantity::angle), 0.52359877559829887);
  EXPECT_EQ(si("1 cm + 2 * 3 mm - 1mm", Quantity::length), 0.01 + 0.006 - 0.001);
}

TEST(Units, EveryListedUnitAndExampleIsAccepted) {
  const ParameterLookup none = [](const std::string&) { return Number{}; };
  for (const Quantity quantity :
       {Quantity::plain, Quantity::length, Quantity::time, Quantity::speed, Quantity::acceleration, Quantity::density,
        Quantity::kinematic_viscosity, Quantity::pressure, Quantity::angle, Quantity::angular_speed,
        Quantity::acceleration_per_length}) {
    std::vector<std::string> texts{std::string(example_of(quantity))};
    std::istringstream units{std::string(usual_units(quantity))};
    for (std::string unit; std::getline(units >> std::ws, unit, ',');) texts.push_back("1 " + unit);
    for (const std::string& text : texts) {
      const Number number = evaluate(text, none);
      ASSERT_TRUE(number.dimension) << text;
      EXPECT_EQ(*number.dimension, dimension_of(quantity)) << text;
    }
    if (quantity == Quantity::plain) continue;
    EXPECT_EQ(evaluate("1 " + std::string(si_unit(quantity)), none).value, 1);
  }
}

TEST(Units, NumberTextIsExactAndWholeNumbersArePlain) {
  EXPECT_EQ(number_text(100000), "100000");
  EXPECT_EQ(number_text(-3), "-3");
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(std::stod(number_text(1.0 / 3)), 1.0 / 3);
}

}  // namespace
}  // namespace embacle::mps
