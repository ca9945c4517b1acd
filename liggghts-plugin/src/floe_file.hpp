// A CSV file of bodies: strict, with messages that name file and line.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts {

/// One line of the file.
struct FloeRow {
  coupling::State state;
  bool own_size = false;                         ///< the file has the columns lx, ly, lz: this body's own box
  coupling::Vec3 size = coupling::Vec3::Zero();  ///< full edge lengths [m]
  double density = 0;                            ///< [kg/m^3]; 0: not given
  double mass = 0;                               ///< [kg]; 0: not given
  std::string origin;                            ///< "floes.csv:7"
};

/// Reads a CSV file in SI units. The first line names the columns, in any order, each optionally with its unit in
/// brackets ("x [m]"): x, y, z (required); qw, qx, qy, qz; vx, vy, vz; wx, wy, wz; lx, ly, lz; density or mass. Columns
/// of a vector come together or not at all. Empty lines and lines that begin with # are skipped.
/// Throws InputError "file:line: ...".
std::vector<FloeRow> read_floe_file(const std::string& path);

}  // namespace embacle::liggghts
