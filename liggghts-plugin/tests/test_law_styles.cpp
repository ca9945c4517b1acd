// What the contact laws refuse, in every instance of LIGGGHTS of a process: all share one table of models, and each new
// one writes its own fallback into it.
#include <gtest/gtest.h>

#include "solids.hpp"

namespace embacle::liggghts {
namespace {

TEST(LawStyles, RefuseUnknownCombinationsInEveryInstance) {
  for (int instance = 0; instance < 3; ++instance) {
    Solids solids;
    solids.prepare();
    solids.run({"fix floes all floe/create shape sphere 0.1 density 900 position 0 0 0"});
    EXPECT_THROW(solids.run({"pair_style gran model contact_ratio tangential tan_luding"}), coupling::InputError);
    EXPECT_THROW(
        solids.run({"fix w all wall/gran model river_ice tangential history rolling_friction cdt primitive type "
                    "1 zplane 0"}),
        coupling::InputError);
    solids.run({"pair_style gran model river_ice tangential river_ice", "pair_coeff * *",
                "fix m5 all property/global collisionDampingRatio peratomtypepair 1 0.05", "run 0"});
  }
}

}  // namespace
}  // namespace embacle::liggghts
