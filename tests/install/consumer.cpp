// A project outside of the tree uses the installed coupling library: the mass of a block from its shape.
#include <cmath>

#include "embacle/coupling/shape.hpp"

int main() {
  embacle::coupling::Shape block;
  block.name = "block";
  block.size = {0.0725, 0.0725, 0.0195};
  block.density = 868;
  const double expected = 868 * 0.0725 * 0.0725 * 0.0195;
  return std::abs(block.mass_properties().mass - expected) < 1e-12 ? 0 : 1;
}
