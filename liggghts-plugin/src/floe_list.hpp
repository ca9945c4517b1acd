// The bodies that one `fix floe/create` command describes: shapes, their covering spheres, states. No LIGGGHTS here.
#pragma once

#include <mpi.h>

#include <optional>
#include <string>
#include <vector>

#include "shape_words.hpp"

namespace embacle::liggghts {

/// A body to create.
struct Floe {
  int shape = 0;  ///< index into FloeList::shapes
  coupling::State state;
  std::optional<double> enters;  ///< time [s] of a coupled run at which it appears; none: at once
  std::string origin;            ///< how messages name it: "body 3 of fix floes" or "floes.csv:7"
};

struct FloeList {
  std::vector<FloeShape> shapes;
  std::vector<Floe> floes;
  bool verbose = false;  ///< the coverings are to be reported
  double repeat = 0;     ///< those that appear later do so again after this time [s]; 0: once

  /// The index of an equal shape, or of `shape` added.
  int add_shape(FloeShape shape);
  /// Computes the covering spheres of all shapes, shared out among the ranks, the same on each. Throws InputError, on
  /// every rank that of the first shape that has one. Collective.
  void cover(MPI_Comm comm);
};

/// Reads the arguments of the fix after its style: the keywords of a shape (see ShapeWords), then
///   position X Y Z            starts a body of the present shape; the next four describe it, all optional
///   quaternion W X Y Z | rotate AX AY AZ DEGREES | velocity VX VY VZ | omega WX WY WZ
///   file NAME                 bodies from a CSV file (see floe_file.hpp)
///   repeat T                  its bodies that appear later do so again every T [s]
///   verbose yes|no            whether each covering is reported
/// The shapes are not covered yet. Orientations are of the frame in which a shape was given; the list holds those of
/// the principal axes. Throws InputError.
FloeList read_floe_list(const std::string& where, const std::vector<std::string>& arguments, int atom_types);

}  // namespace embacle::liggghts
