#include "template_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <sstream>

namespace embacle::liggghts {

namespace {

const std::string where = "liggghts-mps --template";

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw coupling::SystemError(fmt::format("cannot write '{}'", path));
}

bool is_prime(int number) {
  for (int divisor = 2; divisor * divisor <= number; ++divisor) {
    if (number % divisor == 0) return false;
  }
  return number > 1;
}

/// LIGGGHTS wants primes above 10 000 that differ between the templates of an insertion.
int seed_of_type(int type) {
  int seed = 20'000'000 + 1000 * (type % 100'000);
  while (!is_prime(seed)) ++seed;
  return seed;
}

/// The text as comments of a script.
std::string commented(const std::string& text) {
  std::string result, line;
  std::istringstream lines(text);
  while (std::getline(lines, line)) result += "# " + line + "\n";
  return result;
}

}  // namespace

TemplateFile read_template(const std::vector<std::string>& arguments) {
  Words words(where, arguments);
  TemplateFile file;
  file.name = words.word("the name of the files to write");
  file.fix_id = "template";
  ShapeWords shape(words, std::numeric_limits<int>::max());
  while (!words.empty()) {
    const std::string keyword = words.word("a keyword");
    if (shape.take(keyword)) continue;
    if (keyword == "id") {
      file.fix_id = words.word("the ID of the fix");
    } else if (keyword == "type") {
      file.type = words.integer("type", 1);
    } else if (keyword == "seed") {
      file.seed = words.integer("seed, a prime number", 10001);
      if (!is_prime(file.seed)) words.fail(fmt::format("seed must be a prime number, and {} is none", file.seed));
    } else {
      std::vector<std::string> allowed = ShapeWords::keywords();
      allowed.insert(allowed.end(), {"id", "type", "seed"});
      words.fail_unknown("keyword", keyword, allowed);
    }
  }
  if (file.seed == 0) file.seed = seed_of_type(file.type);
  file.shape = shape.described("the template");
  try {
    file.shape.cover();
  } catch (const coupling::InputError& error) {
    words.fail(error.what());
  }
  if (file.shape.spheres.size() < 2) {
    words.fail(
        "the covering is a single sphere, which LIGGGHTS does not take as a multisphere; use fix "
        "particletemplate/sphere "
        "for a sphere, or more spheres for another shape");
  }
  return file;
}

std::string spheres_text(const TemplateFile& file) {
  std::string text;
  for (const coupling::CoveringSphere& sphere : file.shape.spheres) {
    const coupling::Vec3& c = sphere.centre;
    text += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}\n", c.x(), c.y(), c.z(), sphere.radius);
  }
  return text;
}

std::string command_text(const TemplateFile& file) {
  const coupling::MassProperties mass = file.shape.shape.mass_properties();
  return "# A multisphere template for LIGGGHTS; written by liggghts-mps --template.\n" +
         commented(covering_report(file.shape)) +
         fmt::format(
             "fix {} all particletemplate/multisphere {} atom_type {} density constant {:.17g} &\n"
             "  nspheres {} ntry 100000 spheres file {}.spheres scale 1.0 type {} &\n"
             "  mass {:.17g} inertia_tensor {:.17g} 0 0 {:.17g} 0 {:.17g} use_density\n",
             file.fix_id, file.seed, file.shape.atom_type, file.shape.shape.density, file.shape.spheres.size(),
             file.name, file.type, mass.mass, mass.inertia.x(), mass.inertia.y(), mass.inertia.z());
}

void write_template(const TemplateFile& file) {
  write(file.name + ".spheres", spheres_text(file));
  write(file.name + ".template", command_text(file));
}

}  // namespace embacle::liggghts
