#include "bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::Mat3;
using coupling::SolidBody;
using coupling::Vec3;

namespace {

/// Whether this rank's subdomain holds the point: each point of the box belongs to exactly one rank.
bool holds(const Domain* domain, const double* point) {
  for (int k = 0; k < 3; ++k) {
    const bool last = domain->subhi[k] >= domain->boxhi[k];
    if (point[k] < domain->sublo[k]) return false;
    if (last ? point[k] > domain->subhi[k] : point[k] >= domain->subhi[k]) return false;
  }
  return true;
}

/// Modify::setup() would set the arrays of fixes that are new to it a second time, and so erase which body an atom
/// belongs to. Does that setting now, for the atoms there are; new atoms get theirs as they are created.
void settle_new_fixes(LAMMPS* lammps) {
  Modify* modify = lammps->modify;
  for (int i = 0; i < modify->nfix; ++i) {
    Fix* fix = modify->fix[i];
    if (!fix || !fix->just_created || !fix->create_attribute || fix->recent_restart) continue;
    fix->pre_set_arrays();
    for (int j = 0; j < lammps->atom->nlocal; ++j) {
      if (lammps->atom->mask[j] & fix->groupbit) fix->set_arrays(j);
    }
    fix->just_created = 0;
  }
}

void add_body(Multisphere& bodies, const FloeShape& description, const Floe& floe, int type, int tag) {
  const auto properties = description.shape.mass_properties();
  const Mat3 axes = floe.state.orientation.toRotationMatrix();
  Vec3 centre = floe.state.position, velocity = floe.state.velocity, omega = floe.state.angular_velocity;
  Vec3 inertia = properties.inertia, bound_offset = Vec3::Zero();
  Vec3 ex = axes.col(0), ey = axes.col(1), ez = axes.col(2);
  std::array<bool, 3> free_motion = {true, true, true};
  double reach = 0;
  for (const auto& sphere : description.spheres) reach = std::max(reach, sphere.centre.norm() + sphere.radius);
  bodies.add_body(static_cast<int>(description.spheres.size()), centre.data(), bound_offset.data(), reach,
                  velocity.data(), omega.data(), properties.mass, description.shape.density, description.atom_type,
                  type, inertia.data(), ex.data(), ey.data(), ez.data(), nullptr, free_motion.data(),
                  free_motion.data());
  const int local = bodies.n_body() - 1;
  bodies.prop().getElementProperty<ScalarContainer<int>>("id_multisphere")->set(local, tag);
}

void add_spheres(LAMMPS* lammps, FixMultisphere* multisphere, const FloeShape& description, const Floe& floe, int tag,
                 int group_bit, FixPropertyAtom* sphere_index) {
  Atom* atom = lammps->atom;
  const double mass = description.shape.mass_properties().mass;
  for (std::size_t s = 0; s < description.spheres.size(); ++s) {
    const auto& sphere = description.spheres[s];
    const Vec3 arm = floe.state.orientation * sphere.centre;
    const Vec3 velocity = floe.state.velocity + floe.state.angular_velocity.cross(arm);
    Vec3 place = floe.state.position + arm;
    tagint image = (static_cast<tagint>(IMGMAX) << IMG2BITS) | (static_cast<tagint>(IMGMAX) << IMGBITS) | IMGMAX;
    lammps->domain->remap(place.data(), image);
    if (!holds(lammps->domain, place.data())) continue;
    atom->avec->create_atom(description.atom_type, place.data());
    const int i = atom->nlocal - 1;
    atom->mask[i] = 1 | group_bit;
    atom->image[i] = image;
    atom->radius[i] = sphere.radius;
    atom->density[i] = description.shape.density;
    atom->rmass[i] = mass;  // contact models of a multisphere use the mass of the whole body
    for (int k = 0; k < 3; ++k) {
      atom->v[i][k] = velocity[k];
      atom->omega[i][k] = floe.state.angular_velocity[k];
    }
    for (int j = 0; j < lammps->modify->nfix; ++j) {
      if (lammps->modify->fix[j]->create_attribute) lammps->modify->fix[j]->set_arrays(i);
    }
    Vec3 displacement = sphere.centre;
    multisphere->set_body_displace(i, displacement.data(), tag, 1.0 / static_cast<double>(description.spheres.size()));
    sphere_index->vector_atom[i] = static_cast<double>(s);
  }
}

}  // namespace

FixMultisphere* find_multisphere(LAMMPS* lammps, const std::string& where) {
  FixMultisphere* found = nullptr;
  for (int i = 0; i < lammps->modify->nfix; ++i) {
    auto* candidate = dynamic_cast<FixMultisphere*>(lammps->modify->fix[i]);
    if (candidate && found) throw coupling::InputError(where + ": the script has more than one fix multisphere");
    if (candidate) found = candidate;
  }
  if (!found) {
    throw coupling::InputError(where + ": needs 'fix ID all multisphere' before it, the fix that moves the bodies");
  }
  return found;
}

namespace {

/// After bodies and spheres came or went on any rank.
void count_anew(LAMMPS* lammps, Multisphere& bodies) {
  Atom* atom = lammps->atom;
  bigint local = atom->nlocal;
  MPI_Allreduce(&local, &atom->natoms, 1, MPI_LMP_BIGINT, MPI_SUM, lammps->world);
  if (atom->tag_enable) {
    atom->tag_extend();
    if (atom->map_style) {
      atom->nghost = 0;
      atom->map_init();
      atom->map_set();
    }
  }
  bodies.calc_nbody_all();
  bodies.generate_map();
  bodies.reset_forces(true);
}

}  // namespace

int create_bodies(LAMMPS* lammps, FixMultisphere* multisphere, const std::vector<FloeShape>& shapes,
                  const std::vector<Floe>& floes, int shape_offset, int group_bit, FixPropertyAtom* sphere_index,
                  int last_tag) {
  settle_new_fixes(lammps);
  Multisphere& bodies = multisphere->data();
  Atom* atom = lammps->atom;
  const int first_tag = std::max(bodies.tag_max_body(), last_tag) + 1;
  const int atoms_before = atom->nlocal;
  for (std::size_t b = 0; b < floes.size(); ++b) {
    const Floe& floe = floes[b];
    const FloeShape& description = shapes[floe.shape];
    const int tag = first_tag + static_cast<int>(b);
    if (holds(lammps->domain, floe.state.position.data())) {
      add_body(bodies, description, floe, first_floe_type + shape_offset + floe.shape, tag);
    }
    add_spheres(lammps, multisphere, description, floe, tag, group_bit, sphere_index);
  }
  bigint created = atom->nlocal - atoms_before, created_all = 0, expected = 0;
  MPI_Allreduce(&created, &created_all, 1, MPI_LMP_BIGINT, MPI_SUM, lammps->world);
  for (const Floe& floe : floes) expected += static_cast<bigint>(shapes[floe.shape].spheres.size());
  if (created_all != expected) {
    throw coupling::RunError(coupling::ExitStatus::internal,
                             fmt::format("created {} of {} covering spheres", created_all, expected));
  }
  count_anew(lammps, bodies);
  return first_tag + static_cast<int>(floes.size()) - 1;
}

void remove_bodies(LAMMPS* lammps, FixMultisphere* multisphere, const std::vector<coupling::BodyTag>& tags) {
  Atom* atom = lammps->atom;
  const auto leaves = [&](int tag) { return std::ranges::find(tags, tag) != tags.end(); };
  for (int i = 0; i < atom->nlocal;) {
    if (leaves(multisphere->belongs_to(i))) {
      atom->avec->copy(atom->nlocal - 1, i, 1);
      --atom->nlocal;
    } else {
      ++i;
    }
  }
  Multisphere& bodies = multisphere->data();
  for (int i = 0; i < bodies.n_body();) {
    if (leaves(bodies.tag(i))) {
      bodies.remove_body(i);
    } else {
      ++i;
    }
  }
  count_anew(lammps, bodies);
}

SolidBody owned_body(LAMMPS* lammps, FixMultisphere* multisphere, int local) {
  Multisphere& bodies = multisphere->data();
  auto* types = bodies.prop().getElementProperty<ScalarContainer<int>>("clumptype");
  auto* images = bodies.prop().getElementProperty<ScalarContainer<tagint>>("imagebody");
  const Domain* domain = lammps->domain;
  SolidBody body;
  body.tag = bodies.tag(local);
  body.shape = (*types)(local) >= first_floe_type ? (*types)(local)-first_floe_type : -1;
  bodies.xcm(body.state.position.data(), local);
  bodies.vcm(body.state.velocity.data(), local);
  bodies.omega(body.state.angular_velocity.data(), local);
  std::array<double, 4> q{};
  bodies.quat(q.data(), local);
  body.state.orientation = coupling::Quaternion(q[0], q[1], q[2], q[3]);
  const tagint image = (*images)(local);
  body.state.position +=
      Vec3(((image & IMGMASK) - IMGMAX) * domain->xprd, ((image >> IMGBITS & IMGMASK) - IMGMAX) * domain->yprd,
           ((image >> IMG2BITS) - IMGMAX) * domain->zprd);
  return body;
}

std::vector<SolidBody> owned_bodies(LAMMPS* lammps, FixMultisphere* multisphere) {
  std::vector<SolidBody> result(multisphere->n_body());
  for (int i = 0; i < multisphere->n_body(); ++i) result[i] = owned_body(lammps, multisphere, i);
  return result;
}

Vec3 gravity_of(LAMMPS* lammps) {
  Vec3 acceleration = Vec3::Zero();
  if (auto* fix = static_cast<FixGravity*>(lammps->modify->find_fix_style_strict("gravity", 0))) {
    fix->get_gravity(acceleration.data());
  }
  return acceleration;
}

std::vector<double> gather_on_all(MPI_Comm world, const std::vector<double>& mine) {
  int ranks = 0;
  MPI_Comm_size(world, &ranks);
  if (ranks == 1) return mine;
  std::vector<int> counts(ranks), starts(ranks, 0);
  int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<double> all(starts.back() + counts.back());
  if (all.empty()) return all;
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, world);
  return all;
}

std::vector<SolidBody> gather_bodies(LAMMPS* lammps, FixMultisphere* multisphere) {
  constexpr int width = 15;  // tag, shape, state without contact
  std::vector<double> mine;
  for (const SolidBody& body : owned_bodies(lammps, multisphere)) {
    const auto& s = body.state;
    mine.insert(mine.end(), {static_cast<double>(body.tag), static_cast<double>(body.shape)});
    mine.insert(mine.end(), s.position.data(), s.position.data() + 3);
    mine.insert(mine.end(), s.orientation.coeffs().data(), s.orientation.coeffs().data() + 4);
    mine.insert(mine.end(), s.velocity.data(), s.velocity.data() + 3);
    mine.insert(mine.end(), s.angular_velocity.data(), s.angular_velocity.data() + 3);
  }
  const std::vector<double> all = gather_on_all(lammps->world, mine);
  std::vector<SolidBody> result(all.size() / width);
  for (std::size_t b = 0; b < result.size(); ++b) {
    const double* at = all.data() + b * width;
    SolidBody& body = result[b];
    body.tag = static_cast<coupling::BodyTag>(at[0]);
    body.shape = static_cast<int>(at[1]);
    body.state.position = Vec3(at[2], at[3], at[4]);
    body.state.orientation.coeffs() = Eigen::Vector4d(at[5], at[6], at[7], at[8]);
    body.state.velocity = Vec3(at[9], at[10], at[11]);
    body.state.angular_velocity = Vec3(at[12], at[13], at[14]);
  }
  std::sort(result.begin(), result.end(), [](const SolidBody& a, const SolidBody& b) { return a.tag < b.tag; });
  return result;
}

}  // namespace embacle::liggghts
