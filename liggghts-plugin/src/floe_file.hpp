// A CSV file of bodies: strict, with messages that name file and line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts {

/// One line of the file.
struct FloeRow {
  coupling::State state;
  bool own_size = false;                         ///< the file has the columns lx, ly, lz: this body's own box
  coupling::Vec3 size = coupling::Vec3::Zero();  ///< full edge lengths [m]
  std::vector<Eigen::Vector2d> outline;          ///< its own prism: corners of its polygon [m]
  double thickness = 0;                          ///< of the prism [m]
  std::optional<double> enters;                  ///< time at which it appears [s]; none: at once
  double density = 0;                            ///< [kg/m^3]; 0: not given
  double mass = 0;                               ///< [kg]; 0: not given
  std::string origin;                            ///< "floes.csv:7"
};

/// Reads a CSV file in SI units. The first line names the columns, in any order, each optionally with its unit in
/// brackets ("x [m]"): x, y, z (required); qw, qx, qy, qz; vx, vy, vz; wx, wy, wz; lx, ly, lz or outline,
/// thickness; density or mass; t. Columns of a vector come together or not at all. An outline is a list of coordinates
/// separated by spaces, x1 y1 x2 y2 ... Empty lines and lines that begin with # are skipped.
/// Throws InputError "file:line: ...".
std::vector<FloeRow> read_floe_file(const std::string& path);

}  // namespace embacle::liggghts
