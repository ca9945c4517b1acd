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

/// Up to this the explicit load is accurate.
constexpr double explicit_chi = 0.5;

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
  const Matrix6 symmetric = 0.5 * (matrix + matrix.transpose());
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6>(symmetric, mass, Eigen::EigenvaluesOnly).eigenvalues()[5];
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

template <class Visit>
void LightBodies::for_pairs(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies, bool first,
                            const Visit& visit) const {
  const double scale = constants_.gradient_factor / constants_.density;
  const auto weight = [&](double distance) {
    return constants_.kernel == KernelKind::wendland
               ? Kernel<KernelKind::wendland>{1 / constants_.support}.gradient_weight(distance)
               : Kernel<KernelKind::rational>{1 / constants_.support}.gradient_weight(distance);
  };
  const std::vector<std::uint32_t>& nearby = bodies.water_nearby();
  for_each(nearby.size(), [&](std::size_t n, int thread) {
    const std::size_t i = nearby[n];
    const NeighbourRange range = neighbours.of_water(i);
    const Record& water = particles.record[i];
    for (auto k = range.middle; k < range.end && *k != particles.sentinel(); ++k) {
      const Identity& identity = particles.identity[*k];
      if (identity.owner < first_owner_) continue;
      const auto b = static_cast<std::size_t>(identity.owner - first_owner_);
      const coupling::FluidBody& body = bodies.all()[b];
      if (!light_[body.shape]) continue;
      const Record& point = particles.record[*k];
      Vec3 away = Vec3::Zero(), approach = Vec3::Zero();
      for (int c = 0; c < constants_.dimension; ++c) {
        away[c] = water.x[c] - point.x[c];
        approach[c] = point.v[c] - water.v[c];
      }
      const double distance = away.norm();
      if (distance >= constants_.support) continue;
      Pair pair;
      pair.body = b;
      const double now = weight(distance);
      pair.per_dp = scale * now * away;
      pair.arm = Vec3(point.x[0], point.x[1], point.x[2]) - body.state.position;
      pair.normal = body.state.orientation * normal_[body.shape][identity.point];
      if (pair.normal.dot(away) < 0) pair.normal = -pair.normal;  // a plate of one layer has water on both sides
      const double before = distance + constants_.step * approach.dot(away) / distance;  // a step ago
      const double growth = first ? 1.0 : 1 - weight(before) * before / (now * distance);
      pair.taken_up = std::max(0.0, growth) / constants_.step * approach.dot(pair.normal);
      visit(i, thread, pair);
    }
  });
}

void LightBodies::apply(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies,
                        coupling::FluidLink& link, double horizon, bool first, std::vector<Triple>& acceleration,
                        std::vector<Load>& load) const {
  const std::size_t count = bodies.count();
  const double mass = constants_.particle_mass;

  // F, H and G of each body, over all ranks: 6 + 6 + 36 numbers.
  struct Sums {
    Vector6 taken_up = Vector6::Zero();
    Matrix6 matrix = Matrix6::Zero();
  };
  std::vector<std::vector<Sums>> parts(threads(), std::vector<Sums>(count));
  for_pairs(particles, neighbours, bodies, first, [&](std::size_t, int thread, const Pair& pair) {
    const Vector6 push = mass * with_moment(pair.arm, pair.per_dp);
    parts[thread][pair.body].taken_up += pair.taken_up * push;
    parts[thread][pair.body].matrix += push * with_moment(pair.arm, pair.normal).transpose();
  });
  constexpr int numbers = 48;
  std::vector<double> sums(numbers * count);
  for (std::size_t b = 0; b < count; ++b) {
    Eigen::Map<Vector6> whole(&sums[numbers * b]), taken_up(&sums[numbers * b + 6]);
    Eigen::Map<Matrix6> matrix(&sums[numbers * b + 12]);
    whole << load[b].force, load[b].torque;
    taken_up.setZero();
    matrix.setZero();
    for (const auto& part : parts) {
      taken_up += part[b].taken_up;
      matrix += part[b].matrix;
    }
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
    yields[b] = {k, (inertia + k * matrix).partialPivLu().solve(push)};
  }

  std::vector<std::vector<Vector6>> reactions(threads(), std::vector<Vector6>(count, Vector6::Zero()));
  for_pairs(particles, neighbours, bodies, first, [&](std::size_t i, int thread, const Pair& pair) {
    const Yield& yield = yields[pair.body];
    const double dp = yield.k * (yield.acceleration.dot(with_moment(pair.arm, pair.normal)) + pair.taken_up);
    const Vec3 change = dp * pair.per_dp;
    for (int c = 0; c < constants_.dimension; ++c) acceleration[i][c] += change[c];
    reactions[thread][pair.body] -= mass * with_moment(pair.arm, change);
  });
  for (std::size_t b = 0; b < count; ++b) {
    for (const auto& part : reactions) {
      load[b].force += part[b].head<3>();
      load[b].torque += part[b].tail<3>();
    }
  }
}

}  // namespace embacle::mps
