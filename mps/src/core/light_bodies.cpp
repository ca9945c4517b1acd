#include "core/light_bodies.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/kernel.hpp"

namespace embacle::mps {

using coupling::Load;
using coupling::MassProperties;
using coupling::Shape;
using coupling::Vec3;

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// A Matrix6 whose size the compiler does not know: solvers of a known size take it a minute to unroll.
using SolvedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// Up to this the explicit load is accurate.
constexpr double explicit_chi = 0.5;
constexpr std::uint32_t no_point = 0xffffffff;

Vector6 with_moment(const Vec3& arm, const Vec3& direction) {
  Vector6 result;
  result << direction, arm.cross(direction);
  return result;
}

/// Mass and inertia with axes `orientation`, global frame.
Matrix6 inertia_of(const MassProperties& mass, const coupling::Quaternion& orientation) {
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>().diagonal().setConstant(mass.mass);
  const Eigen::Matrix3d turn = orientation.toRotationMatrix();
  result.bottomRightCorner<3, 3>() = turn * mass.inertia.asDiagonal() * turn.transpose();
  return result;
}

/// Largest eigenvalue of M^-1 S, with the symmetric part of S.
double largest_eigenvalue(const Matrix6& mass, const Matrix6& matrix) {
  const SolvedMatrix symmetric = 0.5 * (matrix + matrix.transpose());
  return Eigen::GeneralizedSelfAdjointEigenSolver<SolvedMatrix>(symmetric, SolvedMatrix(mass), Eigen::EigenvaluesOnly)
      .eigenvalues()[5];
}

/// Outward normal of the face nearest to a point inside a shape; of one of them if several are equally near.
Vec3 nearest_normal(const Shape& shape, const Vec3& point, const Constants& constants) {
  const double l0 = constants.particle_distance;
  const Vec3 aside = point + 1e-3 * l0 * Vec3(0.41, 0.59, constants.dimension == 2 ? 0.0 : 0.67);
  Vec3 slope = Vec3::Zero();
  for (int c = 0; c < constants.dimension; ++c) {
    const Vec3 offset = 1e-5 * l0 * Vec3::Unit(c);
    slope[c] = shape.signed_distance(aside + offset) - shape.signed_distance(aside - offset);
  }
  return slope.normalized();
}

/// chi of a shape that is wet all over.
double wet_chi(const MassProperties& mass, const std::vector<coupling::SurfacePiece>& pieces,
               const Constants& constants, double horizon) {
  const double thickness = constants.dimension == 2 ? constants.particle_mass /
                                                          (constants.density * std::pow(constants.particle_distance, 2))
                                                    : 1.0;
  Matrix6 impedance = Matrix6::Zero();
  for (const coupling::SurfacePiece& piece : pieces) {
    const double area = piece.area.norm();
    if (area <= 0) continue;
    const Vector6 normal = with_moment(piece.place, piece.area / area);
    impedance += constants.density * constants.sound_speed * thickness * area * normal * normal.transpose();
  }
  return largest_eigenvalue(inertia_of(mass, coupling::Quaternion::Identity()), impedance) * horizon;
}

}  // namespace

LightBodies::LightBodies(const Constants& constants, const std::vector<Shape>& shapes, int first_owner, double horizon)
    : constants_(constants), first_owner_(first_owner) {
  for (const Shape& shape : shapes) {
    std::vector<coupling::SurfacePiece> pieces;
    const auto points = shape.points(constants.particle_distance, constants.layers * constants.particle_distance,
                                     constants.dimension, &pieces);
    const double chi = wet_chi(shape.mass_properties(), pieces, constants, horizon);
    largest_chi_ = std::max(largest_chi_, chi);
    light_.push_back(chi > explicit_chi ? 1 : 0);
    std::vector<Vec3>& normals = normal_.emplace_back();
    if (chi <= explicit_chi) continue;
    for (const coupling::ShapePoint& point : points) {
      normals.push_back(nearest_normal(shape, point.position, constants));
    }
  }
}

bool LightBodies::any() const {
  return std::ranges::any_of(light_, [](char light) { return light != 0; });
}

void LightBodies::gather_points(const Particles& particles, const Bodies& bodies) {
  points_.clear();
  point_of_slot_.assign(reaction_slots(particles), no_point);
  const auto gather = [&](std::size_t first, std::size_t last) {
    for (std::size_t j = first; j < last; ++j) {
      const Identity& identity = particles.identity[j];
      if (identity.owner < first_owner_) continue;
      const auto b = static_cast<std::size_t>(identity.owner - first_owner_);
      const coupling::FluidBody& body = bodies.all()[b];
      if (!light_[body.shape]) continue;
      const double* x = particles.record[j].x;
      point_of_slot_[reaction_slot(particles, j)] = static_cast<std::uint32_t>(points_.size());
      points_.push_back({b, Vec3(x[0], x[1], x[2]) - body.state.position,
                         body.state.orientation * normal_[body.shape][identity.point]});
    }
  };
  gather(particles.water, particles.own());
  gather(particles.ghost_solid_begin(), particles.all());
}

void LightBodies::gather_pairs(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies,
                               bool first) {
  const double scale = constants_.gradient_factor / constants_.density;
  const auto weight = [&](double distance) {
    return constants_.kernel == KernelKind::wendland
               ? Kernel<KernelKind::wendland>{1 / constants_.support}.gradient_weight(distance)
               : Kernel<KernelKind::rational>{1 / constants_.support}.gradient_weight(distance);
  };
  pairs_.resize(threads());
  for (auto& found : pairs_) found.clear();
  sums_.reset(points_.size());
  const std::vector<std::uint32_t>& nearby = bodies.water_nearby();
  for_each(nearby.size(), [&](std::size_t n, int thread) {
    const std::uint32_t i = nearby[n];
    const Record& water = particles.record[i];
    const NeighbourRange range = neighbours.of_water(i);
    for (auto k = range.middle; k < range.end && *k != particles.sentinel(); ++k) {
      const std::uint32_t number = point_of_slot_[reaction_slot(particles, *k)];
      if (number == no_point) continue;
      const Record& point = particles.record[*k];
      Vec3 away = Vec3::Zero(), approach = Vec3::Zero();
      for (int c = 0; c < constants_.dimension; ++c) {
        away[c] = water.x[c] - point.x[c];
        approach[c] = point.v[c] - water.v[c];
      }
      const double square = away.squaredNorm();
      if (square >= constants_.support * constants_.support) continue;
      const double distance = std::sqrt(square), now = weight(distance);
      const Vec3& normal = points_[number].normal;
      const double side = normal.dot(away) < 0 ? -1 : 1;
      const double before = distance + constants_.step * approach.dot(away) / distance;  // a step ago
      const double growth = first ? 1.0 : 1 - weight(before) * before / (now * distance);
      const double taken_up = std::max(0.0, growth) / constants_.step * side * approach.dot(normal);
      const Vec3 per_dp = scale * now * away;
      pairs_[thread].push_back({i, number, {per_dp[0], per_dp[1], per_dp[2]}, side, taken_up});
      std::array<double, 6>& sum = sums_.of_thread(thread)[number];
      for (int c = 0; c < 3; ++c) {
        sum[c] += side * per_dp[c];
        sum[3 + c] += taken_up * per_dp[c];
      }
    }
  });
  sums_.join();
}

void LightBodies::apply(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies,
                        coupling::FluidLink& link, double horizon, bool first, std::vector<Triple>& acceleration,
                        std::vector<Load>& load) {
  const std::size_t count = bodies.count();
  const double mass = constants_.particle_mass;
  gather_points(particles, bodies);
  gather_pairs(particles, neighbours, bodies, first);

  // F, H and G of each body, over all ranks: 6 + 6 + 36 numbers.
  constexpr int numbers = 48;
  std::vector<double> sums(numbers * count, 0.0);
  for (std::size_t b = 0; b < count; ++b) {
    Eigen::Map<Vector6>(&sums[numbers * b]) << load[b].force, load[b].torque;
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    const std::array<double, 6>& sum = sums_.total()[p];
    Eigen::Map<Vector6> taken_up(&sums[numbers * point.body + 6]);
    Eigen::Map<Matrix6> matrix(&sums[numbers * point.body + 12]);
    taken_up += mass * with_moment(point.arm, Vec3(sum[3], sum[4], sum[5]));
    matrix +=
        mass * with_moment(point.arm, Vec3(sum[0], sum[1], sum[2])) * with_moment(point.arm, point.normal).transpose();
  }
  link.sum_over_sharers(sums, numbers);

  // What each body does in this step.
  struct Yield {
    double k = 0;
    Vector6 acceleration = Vector6::Zero();
  };
  std::vector<Yield> yields(count);
  for (std::size_t b = 0; b < count; ++b) {
    if (!light_[bodies.all()[b].shape]) continue;
    const Eigen::Map<const Vector6> whole(&sums[numbers * b]), taken_up(&sums[numbers * b + 6]);
    const Eigen::Map<const Matrix6> matrix(&sums[numbers * b + 12]);
    const Matrix6 inertia = inertia_of(bodies.mass(b), bodies.all()[b].state.orientation);
    const double impedance = 2 * constants_.density * constants_.sound_speed;
    const double chi = impedance * horizon * largest_eigenvalue(inertia, matrix);
    const double share = chi > explicit_chi ? 1 - explicit_chi / chi : 0;
    const double k = share * impedance * horizon + constants_.density * constants_.particle_distance;
    const Vector6 push = bodies.push_without_load(b) + whole - k * taken_up;
    yields[b] = {k, SolvedMatrix(inertia + k * matrix).partialPivLu().solve(push)};
  }

  // dp on the water and, opposite, on the points.
  std::vector<double> along(points_.size());  // k times the acceleration of each point along its normal
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Point& point = points_[p];
    along[p] = yields[point.body].k * yields[point.body].acceleration.dot(with_moment(point.arm, point.normal));
  }
  pushes_.reset(points_.size());
  in_every_thread([&](int thread) {
    Triple* const pushes = pushes_.of_thread(thread);
    for (const Pair& pair : pairs_[thread]) {
      const double k = yields[points_[pair.point].body].k;
      const double dp = pair.side * along[pair.point] + k * pair.taken_up;
      for (int c = 0; c < 3; ++c) {
        acceleration[pair.water][c] += dp * pair.per_dp[c];
        pushes[pair.point][c] += dp * pair.per_dp[c];
      }
    }
  });
  pushes_.join();
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const Triple& push = pushes_.total()[p];
    const Vec3 force = -mass * Vec3(push[0], push[1], push[2]);
    load[points_[p].body] += {force, points_[p].arm.cross(force)};
  }
}

}  // namespace embacle::mps
