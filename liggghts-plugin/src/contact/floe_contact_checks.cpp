// What a time step cannot resolve: stopped, or warned of.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "contact/floe_contacts.hpp"

namespace embacle::liggghts {

using coupling::BodyTag;

void FloeContacts::check(const Patch& patch, double inverse_mass, double strength, BodyTag body, BodyTag other) const {
  const double frequency = std::sqrt(patch.stiffness * inverse_mass), step = lammps_->update->dt;
  const double pressure = patch.highest;
  constexpr double coarsest = 0.5;  // six steps a contact; beyond 2 the integration explodes
  constexpr double deepest = 0.8;   // of the way to the middle of a body, beyond which it is pushed out at the back
  if (step * frequency <= coarsest && pressure <= deepest * strength) return;
  const std::string who = names_of(body, other);
  if (pressure > deepest * strength) {
    throw coupling::InstabilityError(fmt::format(
        "{}: at step {} {} press into each other almost to the middle, with {:.3g} Pa: youngsModulus is too "
        "low for their speed, or the time step of {:.3g} s too long",
        floe_model_name, lammps_->update->ntimestep, who, pressure, step));
  }
  throw coupling::InstabilityError(fmt::format(
      "{}: at step {} the time step of {:.3g} s is too long for the contact of {}, which lasts {:.3g} s: at "
      "most {:.3g} s, better {:.1g} s; or a lower youngsModulus",
      floe_model_name, lammps_->update->ntimestep, step, who, std::numbers::pi / frequency, coarsest / frequency,
      std::numbers::pi / 20 / frequency));
}

std::string FloeContacts::names_of(BodyTag body, BodyTag other) const {
  return other > 0 ? fmt::format("the bodies {} and {}", body, other)
                   : fmt::format("body {} and fix {}", body, walls_[-1 - other].fix->id);
}

void FloeContacts::check_first_touch(const Patch& patch, double hardness, double way, double size, BodyTag body,
                                     BodyTag other) const {
  constexpr double rounding = 2e-3;  // of a body's size: the flat sides of a mantle
  if (patch.highest / hardness <= 3 * way + rounding * size) return;
  throw coupling::InstabilityError(fmt::format(
      "{}: at step {} {} overlap by {:.3g} m all at once, more than their speed explains: were they created in each "
      "other?",
      floe_model_name, lammps_->update->ntimestep, names_of(body, other), patch.highest / hardness));
}

void FloeContacts::check_way(double gap, double way, double thickness, BodyTag body, BodyTag other) const {
  if (gap >= way || way <= 0.5 * thickness) return;
  throw coupling::InstabilityError(fmt::format(
      "{}: at step {} {} could pass through each other unseen: they approach by up to {:.3g} m in a time "
      "step of {:.3g} s, more than half the thickness of {:.3g} m",
      floe_model_name, lammps_->update->ntimestep, names_of(body, other), way, lammps_->update->dt, thickness));
}

void FloeContacts::check_ways() const {
  // Who is not in the lists is farther than two skins.
  const double most = std::max(lammps_->neighbor->skin, 0.5 * thinnest_);
  for (std::size_t b = 0; b < owned_; ++b) {
    const double way = bodies_[b].fastest * lammps_->update->dt;
    if (way <= most) continue;
    throw coupling::InstabilityError(
        fmt::format("{}: at step {} body {} moves by up to {:.3g} m in a time step of {:.3g} s, more than the skin of "
                    "'neighbor' and "
                    "half the thickness of a body: it could pass through others unseen",
                    floe_model_name, lammps_->update->ntimestep, bodies_[b].tag, way, lammps_->update->dt));
  }
}

void FloeContacts::warn_of_light_between(const Patch& patch, const Body& first, const Body& second) {
  const Body &light = first.motion.inverse_mass > second.motion.inverse_mass ? first : second,
             &heavy = &light == &first ? second : first;
  if (warned_of_light_ || light.contacts < 2 || light.local < 0) return;
  // Damping takes at most what a step resolves of the light one's motion. The heavy one's impact lasts sqrt(ratio)
  // times as long, and what it lacks grows with sqrt(ratio) w dt, w being the light one's frequency. Where the square
  // of that is `most`, a restitution of 0.59 becomes 0.61 (validation/floe-extreme).
  constexpr double most = 2.5;
  const double ratio = light.motion.inverse_mass / heavy.motion.inverse_mass, dt = lammps_->update->dt;
  const double measure = ratio * patch.stiffness * light.motion.inverse_mass * dt * dt;
  if (ratio < 10 || measure <= most) return;
  warned_of_light_ = true;
  lammps_->error->warning(
      FLERR,
      fmt::format(
          "{}: at step {} body {} is pressed by body {}, {:.3g} times as heavy, and touches others: with a time step "
          "of {:.3g} s the heavy one rebounds more than coefficientRestitution says; it needs {:.2g} s (no "
          "further warnings of this kind)",
          floe_model_name, lammps_->update->ntimestep, light.tag, heavy.tag, ratio, dt, dt * std::sqrt(most / measure))
          .c_str());
}

}  // namespace embacle::liggghts
