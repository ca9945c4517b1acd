#include "core/walls.hpp"

#include <algorithm>
#include <cmath>

namespace embacle::mps {

std::vector<double> fitted_lattice(double lower, double upper, double spacing) {
  const int n = std::max(1, static_cast<int>(std::lround((upper - lower) / spacing)));
  std::vector<double> centres(n);
  for (int i = 0; i < n; ++i) centres[i] = lower + (i + 0.5) * (upper - lower) / n;
  return centres;
}

Walls::Walls(const Scene& scene, int dimension, int layers)
    : walls_(scene.walls),
      dimension_(dimension),
      layers_(layers),
      particle_distance_(scene.numerics.particle_distance) {
  int thin = 0;
  for (const Wall& wall : walls_) {
    courses_.push_back(wall.motion ? Course(*wall.motion) : Course());
    any_moves_ = any_moves_ || courses_.back().moves();
    any_accelerates_ = any_accelerates_ || courses_.back().accelerates();
    int axis = -1;
    if (wall.kind == Wall::Kind::box) {
      for (int c = 0; c < dimension; ++c) {
        const double thickness = wall.region.upper[c] - wall.region.lower[c];
        const bool thinnest = axis < 0 || thickness < wall.region.upper[axis] - wall.region.lower[axis];
        if (thickness < (layers - 0.5) * particle_distance_ && thinnest) axis = c;
      }
    }
    solids_.emplace_back();
    if (wall.form.kind != Form::Kind::none) solids_.back().emplace(wall.form, dimension);
    thin_axis_.push_back(axis);
    thin_index_.push_back(axis < 0 ? -1 : thin++);
  }
}

std::vector<Stride> Walls::strides(double from, double to, double step) const {
  std::vector<Stride> result;
  for (const Course& course : courses_) result.push_back(course.stride(from, to, step));
  return result;
}

double Walls::travel(double from, double to) const {
  double farthest = 0;
  for (int w = 0; w < count(); ++w) {
    if (!courses_[w].moves()) continue;
    const Pose before = courses_[w].pose(from), after = courses_[w].pose(to);
    // The way is a convex function of the place: it is longest at a corner.
    const double around = walls_[w].kind == Wall::Kind::tank ? layers_ * particle_distance_ : 0.0;
    for (int corner = 0; corner < (1 << dimension_); ++corner) {
      Vec3d x{};
      for (int c = 0; c < dimension_; ++c) {
        x[c] = (corner >> c) % 2 == 1 ? walls_[w].region.upper[c] + around : walls_[w].region.lower[c] - around;
      }
      const Vec3d a = before.place(x), b = after.place(x);
      farthest = std::max(farthest, std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
    }
  }
  return farthest;
}

std::vector<ThinWall> Walls::thin_walls(double time) const {
  std::vector<ThinWall> result;
  for (int w = 0; w < count(); ++w) {
    if (thin_index_[w] < 0) continue;
    ThinWall thin{thin_axis_[w], walls_[w].region.lower, walls_[w].region.upper};
    if (walls_[w].motion) {
      const Vec3d moved = courses_[w].pose(time).moved;  // thin walls do not turn
      for (int c = 0; c < 3; ++c) {
        thin.lower[c] += moved[c];
        thin.upper[c] += moved[c];
      }
    }
    result.push_back(thin);
  }
  return result;
}

bool Walls::visible(const ThinWall& wall, std::int32_t side, const double* x) {
  if (side == both) return true;
  const bool on_plus = x[wall.axis] > wall.middle();
  if (on_plus != (side > 0)) return false;
  if (side == plus || side == minus) return true;
  for (int c = 0; c < 3; ++c) {  // extra layers are seen only from in front of the wall, not past its edges
    if (c != wall.axis && wall.upper[c] > wall.lower[c] && (x[c] < wall.lower[c] || x[c] > wall.upper[c])) return false;
  }
  return true;
}

bool Walls::separates(const ThinWall& wall, const double* a, const double* b, int dimension) {
  const double da = a[wall.axis] - wall.middle();
  const double db = b[wall.axis] - wall.middle();
  if ((da > 0) == (db > 0)) return false;
  const double share = da / (da - db);
  for (int c = 0; c < dimension; ++c) {
    if (c == wall.axis) continue;
    const double crossing = a[c] + share * (b[c] - a[c]);
    if (crossing < wall.lower[c] || crossing > wall.upper[c]) return false;
  }
  return true;
}

Walls::Distances Walls::distances(int wall, std::int32_t side, const Pose& pose, const double* point,
                                  const double* water, const Periodic& periodic) const {
  const BoxRegion& region = walls_[wall].region;
  // In the frame of the wall at the start.
  Vec3d b = pose.zero({point[0], point[1], point[2]}), w = pose.zero({water[0], water[1], water[2]});
  for (int c = 0; c < dimension_; ++c) {
    const double middle = 0.5 * (region.lower[c] + region.upper[c]);
    const double image = periodic.nearest(c, b[c] - middle) - (b[c] - middle);
    b[c] += image;
    w[c] += image;
  }
  if (side != both) {
    const int axis = thin_axis_[wall];
    return side > 0 ? Distances{region.upper[axis] - b[axis], w[axis] - region.upper[axis]}
                    : Distances{b[axis] - region.lower[axis], region.lower[axis] - w[axis]};
  }
  if (const Solid* const form = solid(wall)) {
    Vec3d normal{};
    const double distance = form->distance(w.data(), &normal);
    double beyond = -distance;
    for (int c = 0; c < dimension_; ++c) beyond += (w[c] - b[c]) * normal[c];
    return {beyond, distance};
  }
  // The place on the surface nearest to the one of the two that lies outside of the convex box: the plane through it
  // has all of the other medium on its far side.
  const bool tank = walls_[wall].kind == Wall::Kind::tank;
  const Vec3d& from = tank ? b : w;
  Vec3d foot = from;
  double square = 0;
  for (int c = 0; c < dimension_; ++c) {
    const bool endless = periodic.in(c) && region.upper[c] - region.lower[c] > periodic.length[c] - particle_distance_;
    if (!endless) foot[c] = std::clamp(from[c], region.lower[c], region.upper[c]);
    square += (from[c] - foot[c]) * (from[c] - foot[c]);
  }
  const double distance = std::sqrt(square);
  if (distance == 0) return {0, 0};
  double beyond = 0;  // of the other one, behind the plane
  for (int c = 0; c < dimension_; ++c) beyond += (foot[c] - (tank ? w : b)[c]) * (from[c] - foot[c]) / distance;
  return tank ? Distances{distance, beyond} : Distances{beyond, distance};
}

std::vector<Walls::Point> Walls::points(int wall) const {
  if (const Solid* const form = solid(wall)) {
    std::vector<Point> result;
    for (const Vec3d& x : form->points(particle_distance_, layers_ * particle_distance_)) result.push_back({x, both});
    return result;
  }
  return walls_[wall].kind == Wall::Kind::tank ? tank_points(walls_[wall]) : box_points(walls_[wall]);
}

std::vector<Walls::Point> Walls::tank_points(const Wall& wall) const {
  const char* const axis_name = "xyz";
  std::array<std::vector<double>, 3> lattice;
  std::array<std::vector<char>, 3> outside;
  for (int c = 0; c < 3; ++c) {
    if (c >= dimension_) {
      lattice[c] = {0.0};
      outside[c] = {0};
      continue;
    }
    const double lower = wall.region.lower[c];
    const double upper = wall.region.upper[c];
    const auto is_open = [&](char sign) {
      return std::find(wall.open.begin(), wall.open.end(), std::string{axis_name[c], sign}) != wall.open.end();
    };
    if (!is_open('-')) {
      for (int k = layers_; k-- > 0;) lattice[c].push_back(lower - (k + 0.5) * particle_distance_);
    }
    outside[c].assign(lattice[c].size(), 1);
    const auto inner = fitted_lattice(lower, upper, particle_distance_);
    lattice[c].insert(lattice[c].end(), inner.begin(), inner.end());
    outside[c].resize(lattice[c].size(), 0);
    if (!is_open('+')) {
      for (int k = 0; k < layers_; ++k) lattice[c].push_back(upper + (k + 0.5) * particle_distance_);
    }
    outside[c].resize(lattice[c].size(), 1);
  }
  std::vector<Point> result;
  for (std::size_t k = 0; k < lattice[2].size(); ++k) {
    for (std::size_t j = 0; j < lattice[1].size(); ++j) {
      for (std::size_t i = 0; i < lattice[0].size(); ++i) {
        if (outside[0][i] || outside[1][j] || outside[2][k]) {
          result.push_back({{lattice[0][i], lattice[1][j], lattice[2][k]}, both});
        }
      }
    }
  }
  return result;
}

std::vector<Walls::Point> Walls::box_points(const Wall& wall) const {
  const int index = static_cast<int>(&wall - walls_.data());
  const int thin_axis = thin_axis_[index];
  std::array<std::vector<double>, 3> lattice;
  for (int c = 0; c < 3; ++c) {
    lattice[c] = c < dimension_ ? fitted_lattice(wall.region.lower[c], wall.region.upper[c], particle_distance_)
                                : std::vector<double>{0.0};
  }
  std::vector<Point> result;
  const auto emit = [&](const std::vector<double>& along_thin, std::int32_t side) {
    auto sites = lattice;
    if (thin_axis >= 0) sites[thin_axis] = along_thin;
    for (const double z : sites[2]) {
      for (const double y : sites[1]) {
        for (const double x : sites[0]) result.push_back({{x, y, z}, side});
      }
    }
  };
  if (thin_axis < 0) {
    const double depth = layers_ * particle_distance_;  // deeper points cannot be felt
    emit({}, both);
    std::erase_if(result, [&](const Point& point) {
      double distance = 1e300;
      for (int c = 0; c < dimension_; ++c) {
        distance = std::min({distance, point.x[c] - wall.region.lower[c], wall.region.upper[c] - point.x[c]});
      }
      return distance > depth;
    });
    return result;
  }
  const auto& core = lattice[thin_axis];
  const int missing = std::max(0, layers_ - static_cast<int>(core.size()));
  std::vector<double> behind_plus, behind_minus;
  for (int k = 1; k <= missing; ++k) {
    behind_plus.push_back(core.front() - k * particle_distance_);
    behind_minus.push_back(core.back() + k * particle_distance_);
  }
  emit(core, plus);
  emit(core, minus);
  emit(behind_plus, plus_extra);
  emit(behind_minus, minus_extra);
  return result;
}

}  // namespace embacle::mps
