#include "floe_list.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "floe_file.hpp"

namespace embacle::liggghts {

using coupling::Quaternion;
using coupling::ShapeKind;
using coupling::Vec3;

namespace {

const std::vector<std::string> keywords = {"shape",    "density",    "mass",   "spacing",  "sphere_radius", "atom_type",
                                           "position", "quaternion", "rotate", "velocity", "omega",         "file"};

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
  }
  return "";
}

/// The reader's memory: the shape and the body that the keywords at hand describe.
class Reader {
 public:
  Reader(const std::string& where, const std::vector<std::string>& arguments, int atom_types)
      : where_(where), words_(where, arguments), atom_types_(atom_types) {}

  FloeList read() {
    while (!words_.empty()) keyword(words_.word("a keyword"));
    if (list_.floes.empty()) words_.fail("no bodies: give 'position X Y Z' for each body, or 'file NAME'");
    return std::move(list_);
  }

 private:
  void keyword(const std::string& name) {
    if (name == "shape") {
      read_shape();
    } else if (name == "density") {
      describe_shape(name);
      present_.shape.density = words_.positive_number("density [kg/m3]");
    } else if (name == "mass") {
      describe_shape(name);
      coupling::Shape unit = present_.shape;
      unit.density = 1;
      present_.shape.density = words_.positive_number("mass [kg]") / unit.mass_properties().mass;
    } else if (name == "spacing") {
      describe_shape(name);
      present_.spacing = words_.positive_number("spacing [m] of the covering spheres");
    } else if (name == "sphere_radius") {
      describe_shape(name);
      present_.sphere_radius = words_.positive_number("sphere_radius [m] of the covering spheres");
    } else if (name == "atom_type") {
      describe_shape(name);
      present_.atom_type = words_.integer("atom_type", 1);
      if (present_.atom_type > atom_types_) {
        words_.fail(
            fmt::format("atom_type {} does not exist: create_box made {} type(s)", present_.atom_type, atom_types_));
      }
    } else if (name == "position") {
      Floe floe;
      floe.shape = registered_shape(name);
      floe.state.position = words_.vector("position [m]");
      floe.origin = fmt::format("body {} of {}", list_.floes.size() + 1, where_);
      list_.floes.push_back(floe);
      describing_body_ = true;
    } else if (name == "quaternion") {
      const double w = words_.number("quaternion (w component)");
      const Vec3 xyz = words_.vector("quaternion");
      const Quaternion given(w, xyz.x(), xyz.y(), xyz.z());
      if (std::abs(given.norm() - 1) > 1e-6) {
        words_.fail(fmt::format("the quaternion's norm must be 1, not {:g}", given.norm()));
      }
      body(name).state.orientation = given.normalized();
    } else if (name == "rotate") {
      const Vec3 axis = words_.vector("axis of rotate");
      const double degrees = words_.number("angle of rotate [degrees]");
      if (!(axis.norm() > 0)) words_.fail("the axis of rotate must not be zero");
      Floe& floe = body(name);
      const Quaternion turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
      floe.state.orientation = (turn * floe.state.orientation).normalized();
    } else if (name == "velocity") {
      body(name).state.velocity = words_.vector("velocity [m/s]");
    } else if (name == "omega") {
      body(name).state.angular_velocity = words_.vector("omega [rad/s]");
    } else if (name == "file") {
      read_file(words_.word("the name of the file of bodies"));
    } else {
      words_.fail_unknown("keyword", name, keywords);
    }
  }

  void read_shape() {
    const std::string kind = words_.word("the kind of shape (box, sphere, cylinder)");
    present_ = FloeShape{};
    if (kind == "box") {
      present_.shape.kind = ShapeKind::box;
      for (int k = 0; k < 3; ++k) {
        present_.shape.size[k] = words_.positive_number(fmt::format("edge length [m] of the box along {}", "xyz"[k]));
      }
    } else if (kind == "sphere") {
      present_.shape.kind = ShapeKind::sphere;
      present_.shape.size.x() = words_.positive_number("radius [m] of the sphere");
    } else if (kind == "cylinder") {
      present_.shape.kind = ShapeKind::cylinder;
      present_.shape.size.x() = words_.positive_number("radius [m] of the cylinder");
      present_.shape.size.y() = words_.positive_number("length [m] of the cylinder");
    } else {
      words_.fail_unknown("shape", kind, {"box", "sphere", "cylinder"});
    }
    have_shape_ = true;
    describing_body_ = false;
  }

  void describe_shape(const std::string& name) {
    if (!have_shape_) words_.fail(fmt::format("'{}' must come after 'shape'", name));
    if (describing_body_) {
      words_.fail(
          fmt::format("'{}' describes a shape and must come before its first body; start another 'shape' for "
                      "other bodies",
                      name));
    }
  }

  int registered_shape(const std::string& name) {
    if (!have_shape_) words_.fail(fmt::format("'{}' must come after 'shape'", name));
    if (!(present_.shape.density > 0))
      words_.fail("the shape needs 'density' [kg/m3] or 'mass' [kg] before its bodies");
    if (!(present_.spacing > 0) && present_.shape.kind != ShapeKind::sphere) {
      words_.fail("the shape needs 'spacing' [m] of its covering spheres before its bodies");
    }
    return list_.add_shape(present_);
  }

  Floe& body(const std::string& name) {
    if (!describing_body_ || list_.floes.empty()) words_.fail(fmt::format("'{}' must come after 'position'", name));
    return list_.floes.back();
  }

  void read_file(const std::string& path) {
    for (const FloeRow& row : read_floe_file(path)) {
      Floe floe;
      if (row.own_size) {
        FloeShape own = present_;
        own.shape.kind = ShapeKind::box;
        own.shape.size = row.size;
        if (row.density > 0) own.shape.density = row.density;
        if (row.mass > 0) own.shape.density = row.mass / row.size.prod();
        if (!(own.shape.density > 0))
          words_.fail(fmt::format("{}: no density or mass, here or before 'file'", row.origin));
        if (!(own.spacing > 0)) words_.fail("give 'shape' and 'spacing' before 'file'");
        floe.shape = list_.add_shape(own);
      } else {
        floe.shape = registered_shape("file");
      }
      floe.state = row.state;
      floe.origin = row.origin;
      list_.floes.push_back(floe);
    }
    describing_body_ = false;
    have_shape_ = false;  // a new shape must be given before further bodies
  }

  std::string where_;
  Words words_;
  int atom_types_;
  FloeList list_;
  FloeShape present_;
  bool have_shape_ = false;
  bool describing_body_ = false;
};

}  // namespace

bool FloeShape::same_as(const FloeShape& other) const {
  return shape.kind == other.shape.kind && shape.size == other.shape.size && shape.density == other.shape.density &&
         spacing == other.spacing && sphere_radius == other.sphere_radius && atom_type == other.atom_type;
}

int FloeList::add_shape(FloeShape shape) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].same_as(shape)) return static_cast<int>(i);
  }
  shape.shape.name = shape_name(shape.shape);
  shape.spheres = shape.shape.covering_spheres(shape.spacing, shape.sphere_radius);
  shapes.push_back(std::move(shape));
  return static_cast<int>(shapes.size()) - 1;
}

FloeList read_floe_list(const std::string& where, const std::vector<std::string>& arguments, int atom_types) {
  return Reader(where, arguments, atom_types).read();
}

}  // namespace embacle::liggghts
