#include "fix_floe_outlet.hpp"

#include <fmt/format.h>

#include <vector>

#include "words.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

FixFloeOutlet::FixFloeOutlet(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  Words words(fmt::format("fix {} {}", id, style), std::vector<std::string>(argv + 3, argv + argc));
  const std::string plane = words.word("the plane (xplane, yplane, zplane)");
  const std::vector<std::string> planes = {"xplane", "yplane", "zplane"};
  for (axis_ = 0; axis_ < 3 && planes[axis_] != plane;) ++axis_;
  if (axis_ == 3) words.fail_unknown("plane", plane, planes);
  place_ = words.number("the place [m] of the plane");
  const std::string side = words.word("'above' or 'below' after the place");
  if (side != "above" && side != "below") words.fail_unknown("side", side, {"above", "below"});
  above_ = side == "above";
  if (!words.empty()) words.fail(fmt::format("'{}' after the side: nothing more is expected", words.word("")));
}

}  // namespace embacle::liggghts
