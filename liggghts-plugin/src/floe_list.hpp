// The bodies that one `fix floe/create` command describes: shapes, their covering spheres, states. No LIGGGHTS here.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/shape.hpp"
#include "words.hpp"

namespace embacle::liggghts {

/// A shape with its covering spheres for contacts.
struct FloeShape {
  coupling::Shape shape;
  double spacing = 0;        ///< of the covering spheres [m]
  double sphere_radius = 0;  ///< as given [m]; 0: chosen by the shape
  int atom_type = 1;         ///< LIGGGHTS material type of the spheres
  std::vector<coupling::CoveringSphere> spheres;

  [[nodiscard]] bool same_as(const FloeShape& other) const;
};

/// A body to create.
struct Floe {
  int shape = 0;  ///< index into FloeList::shapes
  coupling::State state;
  std::string origin;  ///< how messages name it: "body 3 of fix floes" or "floes.csv:7"
};

struct FloeList {
  std::vector<FloeShape> shapes;
  std::vector<Floe> floes;

  /// The index of an equal shape, or of `shape` added (with covering spheres and a name).
  int add_shape(FloeShape shape);
};

/// Reads the arguments of the fix after its style:
///   shape box LX LY LZ | sphere R | cylinder R L     starts a shape; the next four describe it
///   density D | mass M        kg/m^3 | kg
///   spacing S                 of the covering spheres [m]
///   sphere_radius R           of the covering spheres [m], optional
///   atom_type T               optional, 1
///   position X Y Z            starts a body of the present shape; the next four describe it, all optional
///   quaternion W X Y Z | rotate AX AY AZ DEGREES | velocity VX VY VZ | omega WX WY WZ
///   file NAME                 bodies from a CSV file (see floe_file.hpp)
/// Throws InputError.
FloeList read_floe_list(const std::string& where, const std::vector<std::string>& arguments, int atom_types);

}  // namespace embacle::liggghts
