// Closed surfaces of triangles in STL files, ASCII or binary. Included by reader.cpp only.
#pragma once

#include <cstring>
#include <map>
#include <sstream>

#include "scene/table.hpp"

namespace embacle::mps {

/// Reads the triangles of an STL file; lines (of a binary file the numbers of its triangles) name them in messages.
/// Throws TableError unless the surface is closed: every edge belongs to two triangles of the same sense.
class StlReader {
 public:
  [[nodiscard]] static Surface read(const std::filesystem::path& file) {
    StlReader reader;
    reader.surface_.file = file;
    std::string text;
    try {
      text = file_text(file, std::uintmax_t{1} << 31);
    } catch (const ValueError& error) {
      throw TableError(0, error.what());
    }
    std::uint32_t count = 0;
    if (text.size() >= header + 4) std::memcpy(&count, text.data() + header, 4);
    if (text.size() == header + 4 + std::size_t{count} * bytes)
      reader.read_binary(text, count);
    else
      reader.read_ascii(text);
    reader.check_closed();
    return std::move(reader.surface_);
  }

 private:
  static constexpr std::size_t header = 80, bytes = 50;

  void add(const Triangle& triangle, int line) {
    const auto& [a, b, c] = triangle.corner;
    if (a == b || b == c || c == a) throw TableError(line, "the triangle has two corners at the same place");
    surface_.triangles.push_back(triangle);
    lines_.push_back(line);
  }

  void read_binary(const std::string& text, std::uint32_t count) {
    for (std::uint32_t k = 0; k < count; ++k) {
      std::array<float, 12> numbers{};
      std::memcpy(numbers.data(), text.data() + header + 4 + k * bytes, sizeof numbers);
      Triangle triangle;
      for (std::size_t n = 0; n < 9; ++n) {
        if (!std::isfinite(numbers[n + 3]))
          throw TableError(static_cast<int>(k + 1), "has a coordinate that is no number");
        triangle.corner[n / 3][n % 3] = numbers[n + 3];
      }
      add(triangle, static_cast<int>(k + 1));
    }
  }

  void read_ascii(const std::string& text) {
    std::istringstream stream(text);
    int line = 0, corners = -1, begun = 0;  // corners so far of the triangle, -1 outside of one
    Triangle triangle;
    for (std::string row; std::getline(stream, row);) {
      ++line;
      std::istringstream words(row);
      std::string word;
      words >> word;
      if (line == 1 && word != "solid")
        throw TableError(line, "is no STL file: it begins neither with 'solid' nor has the length of a binary one");
      if (word == "facet") {
        if (corners >= 0) throw TableError(line, "'facet' within a triangle");
        corners = 0;
        begun = line;
      } else if (word == "vertex") {
        if (corners < 0 || corners > 2) throw TableError(line, "a 'vertex' too many: a triangle has three");
        for (double& coordinate : triangle.corner[corners]) {
          std::string cell;
          words >> cell;
          const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), coordinate);
          if (cell.empty() || error != std::errc{} || stop != cell.data() + cell.size() || !std::isfinite(coordinate))
            throw TableError(line, "'" + cell + "' is not a number");
        }
        ++corners;
      } else if (word == "endfacet") {
        if (corners != 3) throw TableError(line, "the triangle has fewer than three corners");
        add(triangle, begun);
        corners = -1;
      } else if (!word.empty() && word != "solid" && word != "endsolid" && word != "outer" && word != "endloop") {
        throw TableError(line, "unknown word '" + word + "'");
      }
    }
    if (corners >= 0) throw TableError(line, "the file ends within a triangle");
  }

  void check_closed() {
    if (surface_.triangles.empty()) throw TableError(0, "has no triangles");
    std::map<std::pair<Vec3d, Vec3d>, int> edges;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const auto& corner = surface_.triangles[k].corner;
      for (int e = 0; e < 3; ++e)
        if (!edges.emplace(std::pair(corner[e], corner[(e + 1) % 3]), lines_[k]).second)
          throw TableError(lines_[k],
                           "an edge of the triangle belongs to another one in the same direction; allowed: "
                           "surfaces whose triangles all turn the same way");
    }
    for (const auto& [edge, line] : edges)
      if (!edges.contains({edge.second, edge.first}))
        throw TableError(line, "an edge of the triangle has no neighbour; allowed: closed surfaces");
    double volume = 0;
    for (const Triangle& triangle : surface_.triangles) {
      const auto& [a, b, c] = triangle.corner;
      volume +=
          a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    if (volume < 0)
      for (Triangle& triangle : surface_.triangles) std::swap(triangle.corner[1], triangle.corner[2]);
  }

  Surface surface_;
  std::vector<int> lines_;
};

}  // namespace embacle::mps
