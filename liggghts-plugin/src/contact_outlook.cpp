#include "contact_outlook.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "contact/floe_contacts.hpp"
#include "contact/floe_styles.hpp"
#include "embacle/coupling/types.hpp"
#include "stock_access.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::Vec3;
using VecMap = Eigen::Map<const Vec3>;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Largest effective modulus 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j over pairs of atom types [Pa]; 0 if the script
/// gives no material.
double stiffest_modulus(LAMMPS* lammps) {
  const int types = lammps->atom->ntypes;
  const auto find = [&](const char* name) {
    return static_cast<FixPropertyGlobal*>(
        lammps->modify->find_fix_property(name, "property/global", "peratomtype", types, 0, "couple/mps", false));
  };
  FixPropertyGlobal* young = find("youngsModulus");
  FixPropertyGlobal* poisson = find("poissonsRatio");
  if (!young || !poisson) return 0;
  double softest_compliance = infinity;
  for (int i = 0; i < types; ++i) {
    const double nu = poisson->get_values()[i];
    softest_compliance = std::min(softest_compliance, (1 - nu * nu) / young->get_values()[i]);
  }
  return 0.5 / softest_compliance;
}

/// Whether FloeContacts looks after a wall.
bool of_floes(FixWallGran* wall) { return wall->contact_match("model", "floe"); }

}  // namespace

double hertz_contact_time(double mass, double radius, double modulus, double speed, int contacts) {
  const double stiffened = modulus * contacts;
  return 2.87 * std::pow(mass * mass / (radius * stiffened * stiffened * speed), 0.2);
}

/// Collects over the scans: what can touch, and the quantities of the contact time.
struct ContactOutlook::Nearest {
  double window, acceleration, modulus, minimum_speed;
  bool may_touch = false;
  bool unlisted_may_touch = false;        ///< something outside the neighbour lists may touch
  double shortest = infinity;             ///< contact time of a single contact [s]
  std::unordered_map<int, int> contacts;  ///< spheres that can touch, per body

  /// A pair of `gap` [m] (negative: overlap) with relative velocity; `normal` unit vector between the centres.
  void consider(double gap, const Vec3& relative, const Vec3& normal, double mass, double radius, int body,
                int other_body) {
    if (gap > relative.norm() * window + acceleration * window * window) return;
    may_touch = true;
    double speed = std::max(minimum_speed, std::abs(relative.dot(normal)));
    if (gap < 0) {
      // A contact in progress: the approach speed that such an overlap stores as elastic energy,
      // 1/2 m v^2 = 8/15 E sqrt(R) delta^(5/2).
      speed = std::max(speed, std::sqrt(16.0 / 15.0 * modulus * std::sqrt(radius) * std::pow(-gap, 2.5) / mass));
    }
    shortest = std::min(shortest, hertz_contact_time(mass, radius, modulus, speed, 1));
    ++contacts[body];
    if (other_body >= 0) ++contacts[other_body];
  }
};

ContactOutlook::ContactOutlook(LAMMPS* lammps, FixMultisphere* multisphere, SubStepRule rule)
    : lammps_(lammps), multisphere_(multisphere), rule_(rule), modulus_(stiffest_modulus(lammps)) {
  if (lammps->force->pair && !lammps->force->pair->list) {
    throw coupling::InputError("fix couple/mps: needs a 'pair_style gran' with a neighbour list of its own");
  }
  if (lammps->force->pair && modulus_ <= 0) {
    throw coupling::InputError(
        "fix couple/mps: needs 'fix ID all property/global youngsModulus peratomtype ...' and '... poissonsRatio "
        "peratomtype ...' to choose the sub-steps of contacts");
  }
}

double ContactOutlook::largest_acceleration() const {
  // Of any point of a body: of its centre, plus from angular acceleration and rotation at the bounding radius.
  Multisphere& bodies = multisphere_->data();
  double** force = bodies.extract_double_vector("fcm");
  double** torque = bodies.extract_double_vector("torque");
  double** inertia = bodies.extract_double_vector("inertia");
  double largest = 0;
  for (int i = 0; i < bodies.n_body(); ++i) {
    Vec3 omega;
    bodies.omega(omega.data(), i);
    const double radius = bodies.r_bound(i);
    const double least = VecMap(inertia[i]).minCoeff();
    largest = std::max(largest, VecMap(force[i]).norm() / bodies.mass(i) +
                                    radius * (VecMap(torque[i]).norm() / least + omega.squaredNorm()));
  }
  return largest;
}

double ContactOutlook::largest_displacement() const {
  double** held = positions_at_neighbour_build(lammps_);
  if (!held) return infinity;
  double largest = 0;
  for (int i = 0; i < lammps_->atom->nlocal; ++i) {
    largest = std::max(largest, (VecMap(lammps_->atom->x[i]) - VecMap(held[i])).squaredNorm());
  }
  return std::sqrt(largest);
}

double ContactOutlook::mesh_speed() const {
  double speed = 0;
  for (int f = 0; f < lammps_->modify->nfix; ++f) {
    auto* wall = dynamic_cast<FixWallGran*>(lammps_->modify->fix[f]);
    for (int m = 0; wall && wall->is_mesh_wall() && m < wall->n_meshes(); ++m) {
      auto* mesh = wall->mesh_list()[m]->triMesh();
      if (!mesh->isMoving()) continue;
      // Before the first step the mesh does not know its speed.
      if (first_) return infinity;
      auto* velocity = mesh->prop().getElementProperty<MultiVectorContainer<double, 3, 3>>("v");
      for (int t = 0; velocity && t < mesh->sizeLocal(); ++t) {
        for (int node = 0; node < 3; ++node) speed = std::max(speed, VecMap((*velocity)(t)[node]).norm());
      }
    }
  }
  return speed;
}

void ContactOutlook::scan_pairs(Nearest& nearest) const {
  if (!lammps_->force->pair) return;
  const Atom* atom = lammps_->atom;
  const NeighList* list = lammps_->force->pair->list;
  for (int k = 0; k < list->inum; ++k) {
    const int i = list->ilist[k];
    const VecMap xi(atom->x[i]), vi(atom->v[i]);
    for (int n = 0; n < list->numneigh[i]; ++n) {
      const int j = list->firstneigh[i][n] & NEIGHMASK;
      const Vec3 apart = xi - VecMap(atom->x[j]);
      const double distance = apart.norm();
      const double gap = distance - atom->radius[i] - atom->radius[j];
      const double mass = atom->rmass[i] * atom->rmass[j] / (atom->rmass[i] + atom->rmass[j]);
      const double radius = atom->radius[i] * atom->radius[j] / (atom->radius[i] + atom->radius[j]);
      nearest.consider(gap, vi - VecMap(atom->v[j]), apart / distance, mass, radius, multisphere_->belongs_to(i),
                       multisphere_->belongs_to(j));
    }
  }
}

void ContactOutlook::scan_primitive_walls(Nearest& nearest) const {
  const Atom* atom = lammps_->atom;
  for (int f = 0; f < lammps_->modify->nfix; ++f) {
    auto* wall = dynamic_cast<FixWallGran*>(lammps_->modify->fix[f]);
    if (!wall || wall->is_mesh_wall() || !wall->primitiveWall() || of_floes(wall)) continue;
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & wall->groupbit)) continue;
      Vec3 delta = Vec3::Zero();
      const double gap = wall->primitiveWall()->resolveContact(atom->x[i], atom->radius[i], delta.data());
      const double distance = delta.norm();
      const Vec3 normal = distance > 0 ? Vec3(delta / distance) : Vec3::Zero();
      nearest.consider(gap, VecMap(atom->v[i]), normal, atom->rmass[i], atom->radius[i], multisphere_->belongs_to(i),
                       -1);
    }
  }
}

void ContactOutlook::scan_meshes(Nearest& nearest, double speed) const {
  const Atom* atom = lammps_->atom;
  for (int f = 0; f < lammps_->modify->nfix; ++f) {
    auto* wall = dynamic_cast<FixWallGran*>(lammps_->modify->fix[f]);
    for (int m = 0; wall && wall->is_mesh_wall() && !of_floes(wall) && m < wall->n_meshes(); ++m) {
      FixMeshSurface* surface = wall->mesh_list()[m];
      TriMesh* mesh = surface->triMesh();
      const FixNeighlistMesh* near = surface->meshNeighlist();
      const int triangles = mesh->sizeLocal() + mesh->sizeGhost();
      auto* velocity = mesh->prop().getElementProperty<MultiVectorContainer<double, 3, 3>>("v");
      for (int t = 0; near && t < triangles; ++t) {
        for (const int i : near->get_contact_list(t)) {
          if (i >= atom->nlocal) continue;
          Vec3 delta = Vec3::Zero();
          std::array<double, 3> weights{};
          int side = 0;
          const double gap =
              mesh->resolveTriSphereContactBary(i, t, atom->radius[i], atom->x[i], delta.data(), weights.data(), side);
          const double distance = delta.norm();
          const Vec3 normal = distance > 0 ? Vec3(delta / distance) : Vec3::Zero();
          Vec3 relative = VecMap(atom->v[i]);
          if (mesh->isMoving()) {
            if (std::isinf(speed)) {
              nearest.unlisted_may_touch = true;
            } else if (velocity) {
              relative -= VecMap((*velocity)(t)[0]);
            }
          }
          nearest.consider(gap, relative, normal, atom->rmass[i], atom->radius[i], multisphere_->belongs_to(i), -1);
        }
      }
    }
  }
}

SubSteps ContactOutlook::choose(double window) {
  const Atom* atom = lammps_->atom;
  std::array<double, 4> bound{largest_acceleration(), 0, 0, mesh_speed()};  // acceleration, speed, displacement, mesh
  for (int i = 0; i < atom->nlocal; ++i) bound[1] = std::max(bound[1], VecMap(atom->v[i]).norm());
  bound[2] = largest_displacement();
  MPI_Allreduce(MPI_IN_PLACE, bound.data(), static_cast<int>(bound.size()), MPI_DOUBLE, MPI_MAX, lammps_->world);
  const double acceleration = bound[0], speed = bound[1], displacement = bound[2], wall_speed = bound[3];

  Nearest nearest{window, acceleration, modulus_, rule_.minimum_speed, false, false, infinity, {}};
  bool meshes = false;
  for (int f = 0; f < lammps_->modify->nfix; ++f) {
    auto* wall = dynamic_cast<FixWallGran*>(lammps_->modify->fix[f]);
    meshes = meshes || (wall && wall->is_mesh_wall());
  }
  FloeContacts* floes = floe_contacts(lammps_);
  if (floes) {
    const FloeContactOutlook of_floes = floes->outlook(window, acceleration);
    nearest.may_touch = of_floes.may_touch;
    nearest.shortest = of_floes.contact_time;
  } else {
    scan_pairs(nearest);
  }
  scan_primitive_walls(nearest);
  scan_meshes(nearest, wall_speed);

  // Pairs outside the lists were at least a skin apart when the lists were built (static meshes: half a skin).
  const double motion = speed * window + 0.5 * acceleration * window * window;
  const double skin = lammps_->neighbor->skin;
  const auto rest_of_skin = [&](double moved, double mesh_moved) {
    double rest = infinity;
    if (lammps_->force->pair) rest = skin - 2 * moved - 2 * motion;
    if (meshes) {
      const double mesh_rest = std::isinf(wall_speed) ? -infinity
                               : wall_speed > 0       ? skin - moved - motion - mesh_moved - wall_speed * window
                                                      : 0.5 * skin - moved - motion;
      rest = std::min(rest, mesh_rest);
    }
    return rest;
  };
  if (rest_of_skin(displacement, mesh_travel_) < 0) nearest.unlisted_may_touch = true;
  rebuild_advisable_ = rest_of_skin(displacement + motion, mesh_travel_ + wall_speed * window) < motion;
  mesh_speed_now_ = std::isinf(wall_speed) ? 0 : wall_speed;
  first_ = false;

  int contacts = 1;
  for (const auto& [body, count] : nearest.contacts) contacts = std::max(contacts, count);
  std::array<double, 4> outlook{nearest.may_touch ? 1.0 : 0.0, nearest.unlisted_may_touch ? 1.0 : 0.0,
                                -nearest.shortest, static_cast<double>(contacts)};
  MPI_Allreduce(MPI_IN_PLACE, outlook.data(), static_cast<int>(outlook.size()), MPI_DOUBLE, MPI_MAX, lammps_->world);
  SubSteps result;
  const bool may_touch = outlook[0] > 0, unlisted = outlook[1] > 0;
  if (!may_touch && !unlisted) return result;
  result.skin_limited = !may_touch && !std::isinf(wall_speed);
  double contact_time = -outlook[2] * std::pow(outlook[3], -0.4);
  if (!may_touch) {
    // Unknown partners: two spheres of the lightest body and smallest sphere at the largest speed.
    std::array<double, 2> least{infinity, infinity};
    for (int i = 0; i < atom->nlocal; ++i) {
      least = {std::min(least[0], atom->rmass[i]), std::min(least[1], atom->radius[i])};
    }
    MPI_Allreduce(MPI_IN_PLACE, least.data(), 2, MPI_DOUBLE, MPI_MIN, lammps_->world);
    contact_time =
        hertz_contact_time(0.5 * least[0], 0.5 * least[1], modulus_, std::max(rule_.minimum_speed, 2 * speed), 1);
    if (floes) contact_time = std::min(contact_time, floes->shortest_contact_time());
  }
  result.count = std::max(1, static_cast<int>(std::ceil(window * rule_.resolution / contact_time)));
  return result;
}

void ContactOutlook::window_done(double window) {
  const bool rebuilt = lammps_->neighbor->ncalls != builds_;
  builds_ = lammps_->neighbor->ncalls;
  mesh_travel_ = (rebuilt ? 0 : mesh_travel_) + mesh_speed_now_ * window;
}

}  // namespace embacle::liggghts
