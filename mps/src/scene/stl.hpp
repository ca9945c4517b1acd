// Closed surfaces of triangles from STL files. Included by reader.cpp only.
#pragma once

#include "embacle/coupling/closed_surface.hpp"
#include "scene/table.hpp"

namespace embacle::mps {

/// Reads the triangles of an STL file; lines (of a binary file the numbers of its triangles) name them in messages.
/// Throws TableError unless the surface is closed: every edge belongs to two triangles of the same sense.
inline Surface read_surface(const std::filesystem::path& file) {
  Surface surface;
  surface.file = file;
  try {
    for (const coupling::Triangle& triangle : coupling::parse_stl(file_text(file, std::uintmax_t{1} << 31))) {
      Triangle& added = surface.triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) added.corner[k] = {triangle[k].x(), triangle[k].y(), triangle[k].z()};
    }
  } catch (const coupling::StlError& error) {
    throw TableError(error.line, error.what());
  } catch (const ValueError& error) {
    throw TableError(0, error.what());
  }
  return surface;
}

}  // namespace embacle::mps
