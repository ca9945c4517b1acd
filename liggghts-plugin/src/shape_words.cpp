#include "shape_words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace embacle::liggghts {

using coupling::ShapeKind;
using coupling::Vec3;

namespace {

std::string shape_name(const coupling::Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::box:
      return fmt::format("box {:g} x {:g} x {:g} m, {:g} kg/m3", shape.size.x(), shape.size.y(), shape.size.z(),
                         shape.density);
    case ShapeKind::sphere:
      return fmt::format("sphere of radius {:g} m, {:g} kg/m3", shape.size.x(), shape.density);
    case ShapeKind::cylinder:
      return fmt::format("cylinder of radius {:g} m and length {:g} m, {:g} kg/m3", shape.size.x(), shape.size.y(),
                         shape.density);
    case ShapeKind::prism:
      return fmt::format("prism of {} corners, {:g} x {:g} x {:g} m, {:g} kg/m3", shape.polyhedron->polygon.size(),
                         shape.size.x(), shape.size.y(), shape.size.z(), shape.density);
    case ShapeKind::surface:
      return fmt::format("solid of {} triangles, {:g} x {:g} x {:g} m, {:g} kg/m3",
                         shape.polyhedron->surface.triangles().size(), shape.size.x(), shape.size.y(), shape.size.z(),
                         shape.density);
  }
  return "";
}

bool is_polyhedron(const coupling::Shape& shape) {
  return shape.kind == ShapeKind::prism || shape.kind == ShapeKind::surface;
}

}  // namespace

bool FloeShape::same_as(const FloeShape& other) const {
  if (shape.kind != other.shape.kind || shape.size != other.shape.size || shape.density != other.shape.density ||
      spacing != other.spacing || count != other.count || sphere_radius != other.sphere_radius ||
      atom_type != other.atom_type) {
    return false;
  }
  if (!is_polyhedron(shape) || shape.polyhedron == other.shape.polyhedron) return true;
  return shape.polyhedron->surface.triangles() == other.shape.polyhedron->surface.triangles() &&
         shape.given_axes.coeffs() == other.shape.given_axes.coeffs();
}

void FloeShape::cover() {
  shape.name = shape_name(shape);
  spheres = count > 0 ? shape.covering_spheres_of_count(count, sphere_radius)
                      : shape.covering_spheres(spacing, sphere_radius);
  if (spheres.empty()) {
    throw coupling::InputError(
        fmt::format("shape '{}': no sphere of radius {} m fits below its faces", shape.name, sphere_radius));
  }
}

void FloeShape::take_covering(std::vector<coupling::CoveringSphere> covering) {
  shape.name = shape_name(shape);
  spheres = std::move(covering);
}

std::string covering_report(const FloeShape& floe) {
  const coupling::MassProperties mass = floe.shape.mass_properties();
  const coupling::CoveringError error = floe.shape.covering_error(floe.spheres);
  std::string text =
      fmt::format("{}: volume {:g} m3, mass {:g} kg, principal moments {:g} {:g} {:g} kg m2\n", floe.shape.name,
                  mass.volume, mass.mass, mass.inertia.x(), mass.inertia.y(), mass.inertia.z());
  if (is_polyhedron(floe.shape)) {
    const Vec3& centre = floe.shape.given_centre;
    const coupling::Quaternion& axes = floe.shape.given_axes;
    text += fmt::format(
        "  centre of mass as given: {:g} {:g} {:g} m; principal axes as given: quaternion {:g} {:g} {:g} {:g}\n",
        centre.x(), centre.y(), centre.z(), axes.w(), axes.x(), axes.y(), axes.z());
  }
  const auto length = [&](double value) { return fmt::format("{:.3g} m ({:.2g} %)", value, 100 * value / error.size); };
  text += fmt::format(
      "  {} covering spheres of radius {:g} m; gap to the surface: largest {}, mean {}; protrusion {}\n"
      "  volume outside the shape {:.2g} %, missing below its surface {:.2g} %\n",
      floe.spheres.size(), floe.spheres.front().radius, length(error.largest_gap), length(error.mean_gap),
      length(error.largest_protrusion > 1e-8 * error.size ? error.largest_protrusion : 0.0), 100 * error.outside_volume,
      100 * error.missing_volume);
  return text;
}

const std::vector<std::string>& ShapeWords::keywords() {
  static const std::vector<std::string> all = {"shape",   "density", "mass",          "spacing",
                                               "spheres", "scale",   "sphere_radius", "atom_type"};
  return all;
}

bool ShapeWords::take(const std::string& keyword) {
  if (std::find(keywords().begin(), keywords().end(), keyword) == keywords().end()) return false;
  if (keyword != "shape" && !begun_) words_.fail(fmt::format("'{}' must come after 'shape'", keyword));
  complete_ = false;
  if (keyword == "shape") {
    read_shape();
  } else if (keyword == "density") {
    present_.shape.density = words_.positive_number("density [kg/m3]");
    mass_ = 0;
  } else if (keyword == "mass") {
    mass_ = words_.positive_number("mass [kg]");
    present_.shape.density = 0;
    if (triangles_.empty()) set_mass();
  } else if (keyword == "spacing") {
    present_.spacing = words_.positive_number("spacing [m] of the covering spheres");
    present_.count = 0;
  } else if (keyword == "spheres") {
    present_.count = words_.integer("the number of covering spheres after 'spheres'", 1);
    present_.spacing = 0;
  } else if (keyword == "scale") {
    if (triangles_.empty()) words_.fail("'scale' belongs to 'shape stl' only");
    scale_ = words_.positive_number("scale [m], the unit of length of the STL file");
  } else if (keyword == "sphere_radius") {
    present_.sphere_radius = words_.positive_number("sphere_radius [m] of the covering spheres");
  } else {
    present_.atom_type = words_.integer("atom_type", 1);
    if (present_.atom_type > atom_types_) {
      words_.fail(
          fmt::format("atom_type {} does not exist: create_box made {} type(s)", present_.atom_type, atom_types_));
    }
  }
  return true;
}

void ShapeWords::read_shape() {
  const std::string kind = words_.word("the kind of shape (box, sphere, cylinder, disc, prism, stl)");
  present_ = FloeShape{};
  triangles_.clear();
  scale_ = 1;
  mass_ = 0;
  begun_ = true;
  coupling::Shape& shape = present_.shape;
  if (kind == "box") {
    shape.kind = ShapeKind::box;
    for (int k = 0; k < 3; ++k) {
      shape.size[k] = words_.positive_number(fmt::format("edge length [m] of the box along {}", "xyz"[k]));
    }
  } else if (kind == "sphere") {
    shape.kind = ShapeKind::sphere;
    shape.size.x() = words_.positive_number("radius [m] of the sphere");
  } else if (kind == "cylinder" || kind == "disc") {
    shape.kind = ShapeKind::cylinder;
    shape.size.x() = words_.positive_number(fmt::format("radius [m] of the {}", kind));
    shape.size.y() =
        words_.positive_number(kind == "disc" ? "thickness [m] of the disc" : "length [m] of the cylinder");
  } else if (kind == "prism") {
    read_prism();
  } else if (kind == "stl") {
    shape.kind = ShapeKind::surface;
    try {
      triangles_ = coupling::read_stl(words_.word("the name of the STL file"));
    } catch (const coupling::InputError& error) {
      words_.fail(error.what());
    }
  } else {
    words_.fail_unknown("shape", kind, {"box", "sphere", "cylinder", "disc", "prism", "stl"});
  }
}

void ShapeWords::read_prism() {
  const double length = words_.positive_number("length [m] of the prism along z");
  const int count = words_.integer("the number of corners of the prism", 3);
  std::vector<Eigen::Vector2d> corners(count);
  for (int k = 0; k < count; ++k) {
    for (int c = 0; c < 2; ++c) {
      corners[k][c] = words_.number(fmt::format("{} [m] of corner {} of the prism", "xy"[c], k + 1));
    }
  }
  try {
    present_.shape = coupling::make_prism(corners, length, 0);
  } catch (const coupling::InputError& error) {
    words_.fail(error.what());
  }
}

const FloeShape& ShapeWords::described(const std::string& needed_for) {
  if (complete_) return present_;
  if (!begun_) words_.fail(fmt::format("'{}' must come after 'shape'", needed_for));
  coupling::Shape& shape = present_.shape;
  if (!(shape.density > 0) && !(mass_ > 0)) {
    words_.fail(fmt::format("the shape needs 'density' [kg/m3] or 'mass' [kg] before {}", needed_for));
  }
  if (!(present_.spacing > 0) && present_.count == 0 && shape.kind != ShapeKind::sphere) {
    words_.fail(fmt::format(
        "the shape needs 'spacing' [m] of its covering spheres, or their number 'spheres', before {}", needed_for));
  }
  const double density = shape.density;
  if (!triangles_.empty()) {
    std::vector<coupling::Triangle> scaled = triangles_;
    for (coupling::Triangle& triangle : scaled) {
      for (Vec3& corner : triangle) corner *= scale_;
    }
    try {
      shape = coupling::make_solid(scaled, density);
    } catch (const coupling::InputError& error) {
      words_.fail(error.what());
    }
  }
  if (mass_ > 0) set_mass();
  complete_ = true;
  return present_;
}

void ShapeWords::set_mass() {
  present_.shape.density = 1;
  present_.shape.density = mass_ / present_.shape.mass_properties().mass;
}

}  // namespace embacle::liggghts
