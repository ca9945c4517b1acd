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
void LightBodies::for_pairs(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies,
                            const Visit& visit) const {
  const double scale = constants_.gradient_factor / constants_.density;
  for_each(particles.water, [&](std::size_t i, int thread) {
    const NeighbourRange range = neighbours.of_water(i);
    const double* x = particles.record[i].x;
    for (auto k = range.middle; k < range.end && *k != particles.sentinel(); ++k) {
      const Identity& identity = particles.identity[*k];
      if (identity.owner < first_owner_) continue;
      const auto b = static_cast<std::size_t>(identity.owner - first_owner_);
      const coupling::FluidBody& body = bodies.all()[b];
      if (!light_[body.shape]) continue;
      const double* place = particles.record[*k].x;
      Vec3 away = Vec3::Zero();
      for (int c = 0; c < constants_.dimension; ++c) away[c] = x[c] - place[c];
      const double distance = away.norm();
      if (distance >= constants_.support) continue;
      const double weight = constants_.kernel == KernelKind::wendland
                                ? Kernel<KernelKind::wendland>{1 / constants_.support}.gradient_weight(distance)
                                : Kernel<KernelKind::rational>{1 / constants_.support}.gradient_weight(distance);
      const Vec3 acceleration = scale * weight * away;  // of the water, for a unit of dp
      const Vec3 arm = Vec3(place[0], place[1], place[2]) - body.state.position;
      Vec3 normal = body.state.orientation * normal_[body.shape][identity.point];
      if (normal.dot(away) < 0) normal = -normal;  // a plate of one layer has water on both sides of its points
      visit(i, thread, b, acceleration, arm, normal);
    }
  });
}

void LightBodies::apply(const Particles& particles, const Neighbours& neighbours, const Bodies& bodies,
                        coupling::FluidLink& link, double horizon, std::vector<Triple>& acceleration,
                        std::vector<Load>& load) const {
  const std::size_t count = bodies.count();
  const double mass = constants_.particle_mass;

  // F and G of each body, over all ranks: 6 + 36 numbers.
  std::vector<std::vector<Matrix6>> parts(threads(), std::vector<Matrix6>(count, Matrix6::Zero()));
  for_pairs(particles, neighbours, bodies,
            [&](std::size_t, int thread, std::size_t b, const Vec3& per_dp, const Vec3& arm, const Vec3& normal) {
              parts[thread][b] += mass * with_moment(arm, per_dp) * with_moment(arm, normal).transpose();
            });
  constexpr int numbers = 42;
  std::vector<double> sums(numbers * count);
  for (std::size_t b = 0; b < count; ++b) {
    Eigen::Map<Vector6> whole(&sums[numbers * b]);
    Eigen::Map<Matrix6> matrix(&sums[numbers * b + 6]);
    whole << load[b].force, load[b].torque;
    matrix.setZero();
    for (const auto& part : parts) matrix += part[b];
  }
  link.sum_over_sharers(sums, numbers);

  // What each body does in this step.
  std::vector<Vector6> yields(count, Vector6::Zero());  ///< k times its acceleration
  for (std::size_t b = 0; b < count; ++b) {
    if (!light_[bodies.all()[b].shape]) continue;
    const Eigen::Map<const Vector6> whole(&sums[numbers * b]);
    const Eigen::Map<const Matrix6> matrix(&sums[numbers * b + 6]);
    const Matrix6 inertia = inertia_of(bodies.mass(b), bodies.all()[b].state.orientation);
    const double impedance = 2 * constants_.density * constants_.sound_speed;
    const double chi = impedance * horizon * largest_eigenvalue(inertia, matrix);
    const double share = chi > explicit_chi ? 1 - explicit_chi / chi : 0;
    const double k = share * impedance * horizon + constants_.density * constants_.particle_distance;
    const Vector6 push = bodies.push_without_load(b) + whole;
    yields[b] = k * (inertia + k * matrix).partialPivLu().solve(push);
  }

  std::vector<std::vector<Vector6>> reactions(threads(), std::vector<Vector6>(count, Vector6::Zero()));
  for_pairs(particles, neighbours, bodies,
            [&](std::size_t i, int thread, std::size_t b, const Vec3& per_dp, const Vec3& arm, const Vec3& normal) {
              const Vec3 change = yields[b].dot(with_moment(arm, normal)) * per_dp;
              for (int c = 0; c < constants_.dimension; ++c) acceleration[i][c] += change[c];
              reactions[thread][b] -= mass * with_moment(arm, change);
            });
  for (std::size_t b = 0; b < count; ++b) {
    for (const auto& part : reactions) {
      load[b].force += part[b].head<3>();
      load[b].torque += part[b].tail<3>();
    }
  }
}

}  // namespace embacle::mps
