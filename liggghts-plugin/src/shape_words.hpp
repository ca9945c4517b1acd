// The keywords that describe a shape and its covering; shared by fix floe/create and the template writer. No LIGGGHTS
// here.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/shape.hpp"
#include "words.hpp"

namespace embacle::liggghts {

/// A shape with its covering spheres for contacts.
struct FloeShape {
  coupling::Shape shape;
  double spacing = 0;        ///< of the covering spheres [m]; 0: their number is given
  int count = 0;             ///< of the covering spheres, at most; 0: their spacing is given
  double sphere_radius = 0;  ///< as given [m]; 0: chosen by the shape
  int atom_type = 1;         ///< LIGGGHTS material type of the spheres
  std::vector<coupling::CoveringSphere> spheres;

  [[nodiscard]] bool same_as(const FloeShape& other) const;
  /// Gives the shape its name and computes the covering spheres. Throws InputError.
  void cover();
  /// Gives the shape its name and spheres that another rank has computed.
  void take_covering(std::vector<coupling::CoveringSphere> covering);
};

/// What a covering is and how far it is from its shape, in a few lines for logs and heads of files.
std::string covering_report(const FloeShape& shape);

/// Reads
///   shape box LX LY LZ | sphere R | cylinder R L | disc R L | prism L N X1 Y1 ... XN YN | stl FILE    starts a shape
///   scale F                   of an STL file: its unit of length [m]
///   density D | mass M        kg/m^3 | kg
///   spacing S | spheres N     of the covering spheres [m] | their number
///   sphere_radius R           of the covering spheres [m], optional
///   atom_type T               optional, 1
class ShapeWords {
 public:
  ShapeWords(Words& words, int atom_types) : words_(words), atom_types_(atom_types) {}

  /// Takes the values of a keyword; false if it is not one of these. Throws InputError.
  bool take(const std::string& keyword);
  [[nodiscard]] bool begun() const { return begun_; }
  /// Ends the description: another shape must be begun before further keywords.
  void end() { begun_ = false; }
  /// The shape described, with density and what is needed for its covering, but not yet covered. `needed_for` says what
  /// needs it, for messages. Throws InputError if something is missing.
  [[nodiscard]] const FloeShape& described(const std::string& needed_for);
  /// Likewise, but nothing needs to be there.
  [[nodiscard]] const FloeShape& so_far() const { return present_; }

  static const std::vector<std::string>& keywords();

 private:
  void read_shape();
  void read_prism();
  void set_mass();

  Words& words_;
  int atom_types_;
  FloeShape present_;
  std::vector<coupling::Triangle> triangles_;  ///< of an STL file, in its unit
  double scale_ = 1;
  double mass_ = 0;  ///< [kg]; 0: the density is given
  bool begun_ = false, complete_ = false;
};

}  // namespace embacle::liggghts
