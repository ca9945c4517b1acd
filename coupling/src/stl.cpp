// Closed surfaces of triangles in STL files, ASCII or binary.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "embacle/coupling/closed_surface.hpp"

namespace embacle::coupling {

namespace {

class StlParser {
 public:
  std::vector<Triangle> parse(const std::string& text) {
    std::uint32_t count = 0;
    if (text.size() >= header + 4) std::memcpy(&count, text.data() + header, 4);
    if (text.size() == header + 4 + std::size_t{count} * bytes)
      parse_binary(text, count);
    else
      parse_ascii(text);
    check_closed();
    return std::move(triangles_);
  }

 private:
  static constexpr std::size_t header = 80, bytes = 50;

  void add(const Triangle& triangle, int line) {
    const auto& [a, b, c] = triangle;
    if (a == b || b == c || c == a) throw StlError(line, "the triangle has two corners at the same place");
    triangles_.push_back(triangle);
    lines_.push_back(line);
  }

  void parse_binary(const std::string& text, std::uint32_t count) {
    for (std::uint32_t k = 0; k < count; ++k) {
      std::array<float, 12> numbers{};
      std::memcpy(numbers.data(), text.data() + header + 4 + k * bytes, sizeof numbers);
      Triangle triangle;
      for (int n = 0; n < 9; ++n) {
        if (!std::isfinite(numbers[n + 3]))
          throw StlError(static_cast<int>(k + 1), "has a coordinate that is no number");
        triangle[n / 3][n % 3] = numbers[n + 3];
      }
      add(triangle, static_cast<int>(k + 1));
    }
  }

  void parse_ascii(const std::string& text) {
    std::istringstream stream(text);
    int line = 0, corners = -1, begun = 0;  // corners so far of the triangle, -1 outside of one
    Triangle triangle;
    for (std::string row; std::getline(stream, row);) {
      ++line;
      std::istringstream words(row);
      std::string word;
      words >> word;
      if (line == 1 && word != "solid")
        throw StlError(line, "is no STL file: it begins neither with 'solid' nor has the length of a binary one");
      if (word == "facet") {
        if (corners >= 0) throw StlError(line, "'facet' within a triangle");
        corners = 0;
        begun = line;
      } else if (word == "vertex") {
        if (corners < 0 || corners > 2) throw StlError(line, "a 'vertex' too many: a triangle has three");
        for (double& coordinate : triangle[corners]) {
          std::string cell;
          words >> cell;
          const auto [stop, error] = std::from_chars(cell.data(), cell.data() + cell.size(), coordinate);
          if (cell.empty() || error != std::errc{} || stop != cell.data() + cell.size() || !std::isfinite(coordinate))
            throw StlError(line, "'" + cell + "' is not a number");
        }
        ++corners;
      } else if (word == "endfacet") {
        if (corners != 3) throw StlError(line, "the triangle has fewer than three corners");
        add(triangle, begun);
        corners = -1;
      } else if (!word.empty() && word != "solid" && word != "endsolid" && word != "outer" && word != "endloop") {
        throw StlError(line, "unknown word '" + word + "'");
      }
    }
    if (corners >= 0) throw StlError(line, "the file ends within a triangle");
  }

  void check_closed() {
    if (triangles_.empty()) throw StlError(0, "has no triangles");
    using Key = std::array<double, 3>;
    const auto key_of = [](const Vec3& place) { return Key{place.x(), place.y(), place.z()}; };
    std::map<std::pair<Key, Key>, int> edges;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const Triangle& corner = triangles_[k];
      for (int e = 0; e < 3; ++e)
        if (!edges.emplace(std::pair(key_of(corner[e]), key_of(corner[(e + 1) % 3])), lines_[k]).second)
          throw StlError(lines_[k],
                         "an edge of the triangle belongs to another one in the same direction; allowed: "
                         "surfaces whose triangles all turn the same way");
    }
    for (const auto& [edge, line] : edges)
      if (!edges.contains({edge.second, edge.first}))
        throw StlError(line, "an edge of the triangle has no neighbour; allowed: closed surfaces");
    const double volume = solid_moments(triangles_).volume;
    if (volume < 0)
      for (Triangle& triangle : triangles_) std::swap(triangle[1], triangle[2]);
  }

  std::vector<Triangle> triangles_;
  std::vector<int> lines_;
};

}  // namespace

std::vector<Triangle> parse_stl(const std::string& text) { return StlParser().parse(text); }

std::vector<Triangle> read_stl(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) throw InputError(fmt::format("cannot read the STL file '{}'", path));
  try {
    return parse_stl(text);
  } catch (const StlError& error) {
    throw InputError(error.line > 0 ? fmt::format("{}:{}: {}", path, error.line, error.what())
                                    : fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace embacle::coupling
