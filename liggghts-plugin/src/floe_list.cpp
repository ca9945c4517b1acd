#include "floe_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "floe_file.hpp"

namespace embacle::liggghts {

using coupling::Quaternion;
using coupling::ShapeKind;
using coupling::Vec3;

namespace {

/// The reader's memory: the shape and the body that the keywords at hand describe.
class Reader {
 public:
  Reader(const std::string& where, const std::vector<std::string>& arguments, int atom_types)
      : where_(where), words_(where, arguments), shape_(words_, atom_types) {}

  FloeList read() {
    while (!words_.empty()) keyword(words_.word("a keyword"));
    if (list_.repeat > 0 && std::ranges::none_of(list_.floes, [](const Floe& floe) { return floe.enters.has_value(); }))
      words_.fail("'repeat' is for bodies of a file with a column t, and there is none");
    if (list_.floes.empty()) words_.fail("no bodies: give 'position X Y Z' for each body, or 'file NAME'");
    return std::move(list_);
  }

 private:
  void keyword(const std::string& name) {
    if (describing_body_ && name != "shape" && is_shape_keyword(name)) {
      words_.fail(
          fmt::format("'{}' describes a shape and must come before its first body; start another 'shape' for "
                      "other bodies",
                      name));
    }
    if (shape_.take(name)) {
      describing_body_ = false;
    } else if (name == "position") {
      Floe floe;
      floe.shape = registered_shape(name);
      floe.state.orientation = shape_.so_far().shape.given_axes;
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
      body(name).state.orientation = (given.normalized() * shape_.so_far().shape.given_axes).normalized();
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
    } else if (name == "repeat") {
      list_.repeat = words_.positive_number("repeat (the time [s] after which bodies appear again)");
    } else if (name == "verbose") {
      const std::string answer = words_.word("'yes' or 'no' after 'verbose'");
      if (answer != "yes" && answer != "no") words_.fail_unknown("word after 'verbose'", answer, {"yes", "no"});
      list_.verbose = answer == "yes";
    } else {
      std::vector<std::string> allowed = ShapeWords::keywords();
      allowed.insert(allowed.end(),
                     {"position", "quaternion", "rotate", "velocity", "omega", "file", "repeat", "verbose"});
      words_.fail_unknown("keyword", name, allowed);
    }
  }

  static bool is_shape_keyword(const std::string& name) {
    const auto& all = ShapeWords::keywords();
    return std::find(all.begin(), all.end(), name) != all.end();
  }

  int registered_shape(const std::string& name) {
    return list_.add_shape(shape_.described(name == "file" ? "'file'" : "its bodies"));
  }

  Floe& body(const std::string& name) {
    if (!describing_body_ || list_.floes.empty()) words_.fail(fmt::format("'{}' must come after 'position'", name));
    return list_.floes.back();
  }

  /// The box or prism that a row of a file describes, covered as the present shape.
  FloeShape own_shape(const FloeRow& row) {
    FloeShape own = shape_.so_far();
    const double density = row.density > 0 ? row.density : own.shape.density;
    if (row.own_size) {
      own.shape = {};
      own.shape.kind = ShapeKind::box;
      own.shape.size = row.size;
    } else {
      try {
        own.shape = coupling::make_prism(row.outline, row.thickness, 0);
      } catch (const coupling::InputError& error) {
        words_.fail(fmt::format("{}: {}", row.origin, error.what()));
      }
    }
    own.shape.density = density;
    if (row.mass > 0) {
      own.shape.density = 1;
      own.shape.density = row.mass / own.shape.mass_properties().mass;
    }
    if (!(own.shape.density > 0)) words_.fail(fmt::format("{}: no density or mass, here or before 'file'", row.origin));
    if (!(own.spacing > 0) && own.count == 0) words_.fail("give 'shape' and 'spacing' or 'spheres' before 'file'");
    return own;
  }

  void read_file(const std::string& path) {
    for (const FloeRow& row : read_floe_file(path)) {
      const bool own = row.own_size || !row.outline.empty();
      Floe floe;
      floe.shape = own ? list_.add_shape(own_shape(row)) : registered_shape("file");
      floe.state = row.state;
      floe.state.orientation = (row.state.orientation * list_.shapes[floe.shape].shape.given_axes).normalized();
      floe.enters = row.enters;
      floe.origin = row.origin;
      list_.floes.push_back(floe);
    }
    describing_body_ = false;
    shape_.end();  // a new shape must be given before further bodies
  }

  std::string where_;
  Words words_;
  ShapeWords shape_;
  FloeList list_;
  bool describing_body_ = false;
};

}  // namespace

int FloeList::add_shape(FloeShape shape) {
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].same_as(shape)) return static_cast<int>(i);
  }
  shapes.push_back(std::move(shape));
  return static_cast<int>(shapes.size()) - 1;
}

void FloeList::cover(MPI_Comm comm) {
  int rank = 0, size = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  const int count = static_cast<int>(shapes.size());
  int failed = count;  // the first shape that has no covering
  std::string message;
  std::vector<double> mine, all;  // of each shape of a rank: the number of spheres, then x, y, z, radius of each
  for (int i = rank; i < count && message.empty(); i += size) {
    try {
      shapes[i].cover();
    } catch (const coupling::InputError& error) {
      failed = i;
      message = error.what();
      continue;
    }
    mine.push_back(static_cast<double>(shapes[i].spheres.size()));
    for (const auto& [centre, radius] : shapes[i].spheres)
      mine.insert(mine.end(), {centre.x(), centre.y(), centre.z(), radius});
  }
  if (size > 1) {
    MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MIN, comm);
    if (failed < count) {
      const int speaker = failed % size;
      int length = static_cast<int>(message.size());
      MPI_Bcast(&length, 1, MPI_INT, speaker, comm);
      message.resize(static_cast<std::size_t>(length));
      MPI_Bcast(message.data(), length, MPI_CHAR, speaker, comm);
    }
  }
  if (failed < count) throw coupling::InputError(message);
  if (size == 1) return;
  std::vector<int> lengths(size), starts(size);
  const int length = static_cast<int>(mine.size());
  MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, comm);
  std::partial_sum(lengths.begin(), lengths.end() - 1, starts.begin() + 1);
  all.resize(static_cast<std::size_t>(starts.back()) + lengths.back());
  MPI_Allgatherv(mine.data(), length, MPI_DOUBLE, all.data(), lengths.data(), starts.data(), MPI_DOUBLE, comm);
  for (int i = 0; i < count; ++i) {
    const double* numbers = all.data() + starts[i % size];
    std::vector<coupling::CoveringSphere> spheres(static_cast<std::size_t>(*numbers++));
    for (auto& [centre, radius] : spheres) {
      centre = {numbers[0], numbers[1], numbers[2]};
      radius = numbers[3];
      numbers += 4;
    }
    starts[i % size] = static_cast<int>(numbers - all.data());
    shapes[i].take_covering(std::move(spheres));
  }
}

FloeList read_floe_list(const std::string& where, const std::vector<std::string>& arguments, int atom_types) {
  return Reader(where, arguments, atom_types).read();
}

}  // namespace embacle::liggghts
