// A shape written as a multisphere template of stock LIGGGHTS.
#pragma once

#include <string>
#include <vector>

#include "shape_words.hpp"

namespace embacle::liggghts {

/// What the words of `liggghts-mps --template NAME ...` ask for.
struct TemplateFile {
  std::string name;    ///< of the files, without ending
  FloeShape shape;     ///< covered
  std::string fix_id;  ///< of the fix particletemplate/multisphere
  int type = 1;        ///< multisphere type: 1, 2, ... over the templates of a script
  int seed = 0;        ///< prime, for LIGGGHTS' random numbers; unless given, another for each type
};

/// Reads NAME and the keywords of a shape (see ShapeWords), then id ID, type N, seed N, all optional. Throws
/// InputError, also for a single sphere, which LIGGGHTS does not take as a multisphere.
TemplateFile read_template(const std::vector<std::string>& arguments);

/// The spheres, one a line: x y z r [m] in the body frame, whose origin is the centre of mass.
std::string spheres_text(const TemplateFile& file);
/// The command `fix particletemplate/multisphere` with the exact mass and inertia of the shape, under a head of
/// comments that states them and the error of the covering.
std::string command_text(const TemplateFile& file);

/// Writes NAME.spheres and NAME.template. Throws SystemError.
void write_template(const TemplateFile& file);

}  // namespace embacle::liggghts
