#include "fix_floe_tether.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bodies.hpp"
#include "words.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;
using coupling::InstabilityError;
using coupling::Vec3;

FixFloeTether::FixFloeTether(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  where_ = fmt::format("fix {} {}", id, style);
  Words words(where_, std::vector<std::string>(argv + 3, argv + argc));
  bool anchored = false;
  while (!words.empty()) {
    const std::string name = words.word("a keyword");
    if (name == "body") {
      tag_ = words.integer("body (tag)", 1);
    } else if (name == "at") {
      place_ = words.vector("at [m]");
    } else if (name == "to") {
      anchor_ = words.vector("to [m]");
      anchored = true;
    } else if (name == "rope" || name == "rod") {
      if (length_ > 0) words.fail("has more than one 'rope' or 'rod'");
      pushes_ = name == "rod";
      length_ = words.positive_number(fmt::format("{} (length [m])", name));
    } else if (name == "stiffness") {
      stiffness_ = words.positive_number("stiffness [N/m]");
    } else if (name == "damping") {
      damping_ = words.number("damping [N s/m]");
      if (damping_ < 0) words.fail(fmt::format("damping must not be negative, not {}", damping_));
    } else {
      words.fail_unknown("keyword", name, {"body", "at", "to", "rope", "rod", "stiffness", "damping"});
    }
  }
  if (tag_ == 0) words.fail("needs 'body TAG'");
  if (!anchored) words.fail("needs 'to X Y Z', the fixed place");
  if (length_ == 0) words.fail("needs 'rope LENGTH' or 'rod LENGTH'");
  if (stiffness_ == 0) words.fail("needs 'stiffness K' [N/m]");
  scalar_flag = 1;
  global_freq = 1;
}

int FixFloeTether::setmask() { return FixConst::POST_FORCE; }

void FixFloeTether::post_create() { multisphere_ = find_multisphere(lmp, where_); }

int FixFloeTether::find_body() const {
  Multisphere& bodies = multisphere_->data();
  return tag_ <= bodies.tag_max_body() ? bodies.map(tag_) : -1;
}

void FixFloeTether::init() {
  int owners = find_body() >= 0 ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &owners, 1, MPI_INT, MPI_SUM, world);
  if (owners == 0) {
    throw InputError(fmt::format("{}: there is no body {}; the largest tag is {}", where_, tag_,
                                 multisphere_->data().tag_max_body()));
  }
}

void FixFloeTether::post_force(int /*vflag*/) {
  tension_ = 0;
  const int local = find_body();
  if (local < 0) return;
  const auto body = owned_body(lmp, multisphere_, local).state;
  const Vec3 arm = body.orientation * place_;
  const Vec3 line = anchor_ - body.position - arm;
  const double distance = line.norm();
  if (!pushes_ && distance <= length_) return;
  if (distance < 1e-6 * length_) {
    throw InstabilityError(fmt::format(
        "{}: at step {} the rod to body {} is pressed down to nothing, and has no direction: the stiffness is too low",
        where_, update->ntimestep, tag_));
  }
  const Vec3 direction = line / distance;
  const double lengthening = -direction.dot(body.velocity + body.angular_velocity.cross(arm));
  tension_ = stiffness_ * (distance - length_) + damping_ * lengthening;
  if (!pushes_) tension_ = std::max(0.0, tension_);

  // How the body yields at the place: the explicit step follows the oscillation and the decay only if they are slow.
  Multisphere& bodies = multisphere_->data();
  const Vec3 turn = body.orientation.conjugate() * arm.cross(direction);
  const Vec3 inertia(bodies.extract_double_vector("inertia")[local]);
  const double yield = 1 / bodies.mass(local) + turn.cwiseQuotient(inertia).dot(turn);
  const double step = update->dt, fastest = std::max(std::sqrt(stiffness_ * yield), damping_ * yield);
  constexpr double coarsest = 0.5;  // beyond 2 the integration explodes
  if (step * fastest > coarsest) {
    throw InstabilityError(fmt::format(
        "{}: at step {} the time step of {:.3g} s is too long for stiffness {:.4g} N/m and damping {:.4g} N s/m on "
        "body {}: at most {:.3g} s",
        where_, update->ntimestep, step, stiffness_, damping_, tag_, coarsest / fastest));
  }
  const Vec3 pull = tension_ * direction;
  Eigen::Map<Vec3>(bodies.extract_double_vector("fcm")[local]) += pull;
  Eigen::Map<Vec3>(bodies.extract_double_vector("torque")[local]) += arm.cross(pull);
}

double FixFloeTether::compute_scalar() {
  double all = 0;
  MPI_Allreduce(&tension_, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

}  // namespace embacle::liggghts
