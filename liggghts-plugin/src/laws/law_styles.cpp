// The only source that instantiates LIGGGHTS' contact model templates. It has its own lists of stock models
// (stock-lists/) in place of those that LIGGGHTS' build generates and the Debian package lacks, and no precompiled
// headers.
#include "laws/law_styles.hpp"

#include <mpi.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
// The order of these headers follows LIGGGHTS' own needs.
#include <lammps.h>

#include <atom.h>
#include <comm.h>
#include <error.h>
#include <fix_insert_stream.h>
#include <fix_mesh_surface.h>
#include <force.h>
#include <modify.h>
#include <update.h>

#include <contact_models.h>
#include <fix_wall_gran_base.h>
#include <global_properties.h>
#include <pair_gran_base.h>

#include "laws/contact_law.hpp"

namespace embacle::liggghts::laws {
namespace {

using namespace LAMMPS_NS;
namespace models = ::LIGGGHTS::ContactModels;
namespace pairs = ::LIGGGHTS::PairStyles;
namespace walls = ::LIGGGHTS::Walls;
using coupling::InputError;
using ::LIGGGHTS::IContactHistorySetup;
using models::ForceData;
using models::SurfacesCloseData;
using models::SurfacesIntersectData;

/// Of the 64 identifiers of a kind that LIGGGHTS' hash codes have room for; the stock models use the first dozen.
constexpr int contact_ratio_id = 41;
constexpr int river_ice_id = 42;

/// Global property of material pairs within [lower, upper], as a creator for LIGGGHTS' registry.
MatrixProperty* create_bounded(PropertyRegistry& registry, const char* name, const char* caller, double upper) {
  MatrixProperty* property = MODEL_PARAMS::createPerTypePairProperty(registry, name, caller);
  for (int i = 1; i <= registry.max_type(); ++i) {
    for (int j = 1; j <= registry.max_type(); ++j) {
      const double value = property->data[i][j];
      if (!(value >= 0 && value <= upper)) {
        throw InputError(
            fmt::format("{}: the property '{}' of the types {} and {} is {}, but must lie between 0 (no "
                        "damping) and {:.6g} (no rebound)",
                        caller, name, i, j, value, upper));
      }
    }
  }
  return property;
}

struct ContactRatio {
  static constexpr int id = contact_ratio_id;
  static constexpr const char* name = "contact_ratio";
  static constexpr const char* caller = "model contact_ratio";
  static constexpr const char* damping_name = "contactRatio";
  static MatrixProperty* create_damping(PropertyRegistry& registry, const char* who, bool /*checks*/) {
    return create_bounded(registry, damping_name, who, largest_ratio());
  }
  static double wall_length(double radius) { return radius; }
  static double length(double radius_i, double radius_j) { return effective_radius(radius_i, radius_j); }
  static double slip_velocity(double /*length*/) { return contact_ratio_slip_velocity; }
  static Coefficients coefficients(const Pair& pair, double overlap) { return contact_ratio_law(pair, overlap); }
};

struct RiverIce {
  static constexpr int id = river_ice_id;
  static constexpr const char* name = "river_ice";
  static constexpr const char* caller = "model river_ice";
  static constexpr const char* damping_name = "collisionDampingRatio";
  static MatrixProperty* create_damping(PropertyRegistry& registry, const char* who, bool /*checks*/) {
    return create_bounded(registry, damping_name, who, largest_ratio());
  }
  static double wall_length(double radius) { return radius; }
  static double length(double radius_i, double radius_j) { return effective_spacing(radius_i, radius_j); }
  static double slip_velocity(double length) { return river_ice_slip_velocity(length); }
  static Coefficients coefficients(const Pair& pair, double overlap) { return river_ice_law(pair, overlap); }
};

template <typename Law>
double length_of(const SurfacesCloseData& contact) {
  return contact.is_wall ? Law::wall_length(contact.radi) : Law::length(contact.radi, contact.radj);
}

void require_si(LAMMPS* lammps, const char* caller) {
  if (std::strcmp(lammps->update->unit_style, "si") != 0) {
    throw InputError(fmt::format("{}: the law is stated in SI units; write 'units si'", caller));
  }
}

/// Adds a force [N] on sphere i along the normal, and its reaction.
void add_normal(const SurfacesIntersectData& contact, ForceData& i, ForceData& j) {
  for (int d = 0; d < 3; ++d) {
    const double force = contact.Fn * contact.en[d];
    i.delta_F[d] += contact.is_wall ? force * contact.area_ratio : force;
    if (!contact.is_wall) j.delta_F[d] -= force;
  }
}

/// Adds a force [N] on sphere i across the contact, its reaction, and the torques of both at the contact point.
void add_tangential(const SurfacesIntersectData& contact, const Vec3& force, ForceData& i, ForceData& j) {
  const Vec3 normal(contact.en[0], contact.en[1], contact.en[2]);
  const Vec3 lever = -normal.cross(force);
  const double share = contact.is_wall ? contact.area_ratio : 1;
  for (int d = 0; d < 3; ++d) {
    i.delta_F[d] += share * force[d];
    i.delta_torque[d] += share * contact.cri * lever[d];
    if (contact.is_wall) continue;
    j.delta_F[d] -= force[d];
    j.delta_torque[d] += contact.crj * lever[d];
  }
}

template <typename Law>
class LawNormal : public models::NormalModelBase {
 public:
  LawNormal(LAMMPS* lammps, IContactHistorySetup* history, models::ContactModelBase* model)
      : NormalModelBase(lammps, history, model) {}

  void registerSettings(Settings& settings) final { settings.registerOnOff("limitForce", limit_force_, false); }
  void postSettings(IContactHistorySetup* /*history*/, models::ContactModelBase* /*model*/) final {}
  void connectToProperties(PropertyRegistry& registry) final {
    require_si(lmp, Law::caller);
    registry.registerProperty("Yeff", &MODEL_PARAMS::createYeff);
    registry.registerProperty(Law::damping_name, &Law::create_damping);
    registry.connect("Yeff", modulus_, Law::caller);
    registry.connect(Law::damping_name, damping_, Law::caller);
  }
  double stressStrainExponent() final { return 1.5; }

  void surfacesIntersect(SurfacesIntersectData& contact, ForceData& i_forces, ForceData& j_forces) final {
    if (contact.contact_flags) *contact.contact_flags |= models::CONTACT_NORMAL_MODEL;
    const Pair pair = {.modulus = modulus_[contact.itype][contact.jtype],
                       .length = length_of<Law>(contact),
                       .mass = contact.meff,
                       .damping = damping_[contact.itype][contact.jtype]};
    const Coefficients c = Law::coefficients(pair, contact.deltan);
    // vn < 0 while the surfaces approach: [T] 4.7 with the normal that points to sphere i.
    contact.Fn = c.normal_stiffness * contact.deltan - c.normal_damping * contact.vn;
    if (limit_force_ && contact.Fn < 0) contact.Fn = 0;
    contact.kn = c.normal_stiffness;
    contact.gamman = c.normal_damping;
    contact.kt = c.tangential_stiffness;
    contact.gammat = c.tangential_damping;
    add_normal(contact, i_forces, j_forces);
  }
  void surfacesClose(SurfacesCloseData& contact, ForceData& /*i*/, ForceData& /*j*/) final {
    if (contact.contact_flags) *contact.contact_flags &= ~models::CONTACT_NORMAL_MODEL;
  }
  void beginPass(SurfacesIntersectData& /*contact*/, ForceData& /*i*/, ForceData& /*j*/) final {}
  void endPass(SurfacesIntersectData& /*contact*/, ForceData& /*i*/, ForceData& /*j*/) final {}

 private:
  bool limit_force_ = false;
  double** modulus_ = nullptr;  ///< Y* [Pa] by types
  double** damping_ = nullptr;  ///< [-] by types
};

template <typename Law>
class LawTangential : public models::TangentialModelBase {
 public:
  LawTangential(LAMMPS* lammps, IContactHistorySetup* history, models::ContactModelBase* model)
      : TangentialModelBase(lammps, history, model) {
    offset_ = history->add_history_value("stretchx", "1");
    history->add_history_value("stretchy", "1");
    history->add_history_value("stretchz", "1");
    history->add_history_value("stretch_stiffness", "0");
  }

  void registerSettings(Settings& settings) final {
    settings.registerDoubleSetting("slip_velocity", slip_velocity_, std::numeric_limits<double>::quiet_NaN());
  }
  void postSettings(IContactHistorySetup* /*history*/, models::ContactModelBase* /*model*/) final {
    if (std::isnan(slip_velocity_) || (slip_velocity_ > 0 && std::isfinite(slip_velocity_))) return;
    throw InputError(fmt::format("tangential {}: slip_velocity is {}, but must be a number above 0 [m/s]", Law::name,
                                 slip_velocity_));
  }
  void connectToProperties(PropertyRegistry& registry) final {
    registry.registerProperty("coeffFrict", &MODEL_PARAMS::createCoeffFrict);
    registry.connect("coeffFrict", friction_, Law::caller);
  }

  void surfacesIntersect(const SurfacesIntersectData& contact, ForceData& i_forces, ForceData& j_forces) final {
    if (contact.contact_flags) *contact.contact_flags |= models::CONTACT_TANGENTIAL_MODEL;
    double* const kept = &contact.contact_history[offset_];
    Spring spring = {.stretch = Vec3(kept[0], kept[1], kept[2]), .stiffness = kept[3]};
    const Coefficients c = {.tangential_stiffness = contact.kt, .tangential_damping = contact.gammat};
    const bool advance = contact.computeflag && contact.shearupdate;
    const Vec3 normal(contact.en[0], contact.en[1], contact.en[2]);
    const Vec3 slip(contact.vtr1, contact.vtr2, contact.vtr3);
    const double limit = friction_[contact.itype][contact.jtype] * std::abs(contact.Fn);
    const double slip_velocity =
        std::isnan(slip_velocity_) ? Law::slip_velocity(length_of<Law>(contact)) : slip_velocity_;
    const Vec3 across = tangential_force(spring, c, normal, slip, limit, slip_velocity, update->dt, advance);
    if (advance) {
      for (int d = 0; d < 3; ++d) kept[d] = spring.stretch[d];
      kept[3] = spring.stiffness;
    }
    add_tangential(contact, across, i_forces, j_forces);
  }
  void surfacesClose(SurfacesCloseData& contact, ForceData& /*i*/, ForceData& /*j*/) final {
    if (contact.contact_flags) *contact.contact_flags &= ~models::CONTACT_TANGENTIAL_MODEL;
    if (!contact.contact_history) return;
    for (int k = 0; k < 4; ++k) contact.contact_history[offset_ + k] = 0;
  }
  void beginPass(SurfacesIntersectData& /*contact*/, ForceData& /*i*/, ForceData& /*j*/) final {}
  void endPass(SurfacesIntersectData& /*contact*/, ForceData& /*i*/, ForceData& /*j*/) final {}

 private:
  int offset_ = 0;               ///< of the spring in the contact history
  double slip_velocity_ = 0;     ///< [m/s]; not a number: the law's own
  double** friction_ = nullptr;  ///< [-] by types
};

}  // namespace
}  // namespace embacle::liggghts::laws

namespace LIGGGHTS::ContactModels {

#define EMBACLE_LAW(LAW)                                                              \
  template <>                                                                         \
  class NormalModel<embacle::liggghts::laws::LAW::id>                                 \
      : public embacle::liggghts::laws::LawNormal<embacle::liggghts::laws::LAW> {     \
    using LawNormal::LawNormal;                                                       \
  };                                                                                  \
  template <>                                                                         \
  class TangentialModel<embacle::liggghts::laws::LAW::id>                             \
      : public embacle::liggghts::laws::LawTangential<embacle::liggghts::laws::LAW> { \
    using LawTangential::LawTangential;                                               \
  }

EMBACLE_LAW(ContactRatio);
EMBACLE_LAW(RiverIce);

#undef EMBACLE_LAW

}  // namespace LIGGGHTS::ContactModels

namespace embacle::liggghts::laws {
namespace {

// LIGGGHTS takes its model of unregistered combinations from a private table (see stock_access.cpp for this idiom).
template <typename Interface, typename Parent>
using Creator = Interface* (*)(LAMMPS*, Parent*, std::int64_t);
template <typename Interface, typename Parent>
using StyleTable = std::map<std::pair<std::string, int>, Creator<Interface, Parent>>;

template <typename Interface>
using StyleFactory = ::LIGGGHTS::Utils::AbstractFactory<Interface>;

template <typename Key, typename Key::Type member>
struct Opened {
  friend typename Key::Type open(Key) { return member; }
};
template <typename Interface, typename Parent>
struct TableKey {
  using Type = StyleTable<Interface, Parent> StyleFactory<Interface>::*;
};
struct PairTableKey : TableKey<pairs::IGranularPairStyle, PairGran> {
  friend Type open(PairTableKey);
};
struct WallTableKey : TableKey<walls::IGranularWall, FixWallGran> {
  friend Type open(WallTableKey);
};
template struct Opened<PairTableKey, &StyleFactory<pairs::IGranularPairStyle>::styleTable>;
template struct Opened<WallTableKey, &StyleFactory<walls::IGranularWall>::styleTable>;

/// Six bits of a hash code: 0 the normal model, 1 the tangential model.
int identifier(std::int64_t hash, int position) { return static_cast<int>((hash >> (6 * position)) & 63); }

/// Refuses combinations of these laws that are not registered; others go where they went before.
template <typename Interface, typename Parent>
struct Fallback {
  static inline Creator<Interface, Parent> stock = nullptr;
  static Interface* create(LAMMPS* lammps, Parent* parent, std::int64_t hash) {
    for (const auto& [id, name] : {std::pair(ContactRatio::id, ContactRatio::name), {RiverIce::id, RiverIce::name}}) {
      if (identifier(hash, 0) == id) {
        throw InputError(
            fmt::format("model {0}: works with tangential {0}, history, no_history or off, and not with other "
                        "tangential models, nor "
                        "with cohesion, rolling_friction or surface models",
                        name));
      }
      if (identifier(hash, 1) == id) throw InputError(fmt::format("tangential {0}: works with model {0} only", name));
    }
    return stock(lammps, parent, hash);
  }
};

template <typename Style>
void add_style() {
  using Model = models::ContactModel<Style>;
  const int hash = static_cast<int>(Style::HASHCODE);
  pairs::Factory::instance().addStyle(
      "gran", hash, [](LAMMPS* lammps, PairGran* parent, std::int64_t code) -> pairs::IGranularPairStyle* {
        return new pairs::Granular<Model>(lammps, parent, code);
      });
  walls::Factory::instance().addStyle(
      "gran", hash, [](LAMMPS* lammps, FixWallGran* parent, std::int64_t code) -> walls::IGranularWall* {
        return new walls::Granular<Model>(lammps, parent, code);
      });
}

template <typename Law>
void add_law() {
  models::Factory::instance().addNormalModel(Law::name, Law::id);
  models::Factory::instance().addTangentialModel(Law::name, Law::id);
  add_style<models::GranStyle<Law::id, Law::id>>();
  add_style<models::GranStyle<Law::id, models::TANGENTIAL_HISTORY>>();
  add_style<models::GranStyle<Law::id, models::TANGENTIAL_NO_HISTORY>>();
  add_style<models::GranStyle<Law::id, models::TANGENTIAL_OFF>>();
}

template <typename Interface, typename Parent>
void add_fallback(StyleTable<Interface, Parent>& table) {
  auto& creator = table[{"gran", static_cast<int>(models::GranStyle<>::HASHCODE)}];
  if (creator == &Fallback<Interface, Parent>::create) return;
  Fallback<Interface, Parent>::stock = creator;
  creator = &Fallback<Interface, Parent>::create;
}

void add_fallbacks() {
  add_fallback<pairs::IGranularPairStyle, PairGran>(pairs::Factory::instance().*open(PairTableKey{}));
  add_fallback<walls::IGranularWall, FixWallGran>(walls::Factory::instance().*open(WallTableKey{}));
}

}  // namespace
}  // namespace embacle::liggghts::laws

namespace embacle::liggghts {

void register_law_styles() {
  static bool listed = false;
  if (!listed) {
    laws::add_law<laws::ContactRatio>();
    laws::add_law<laws::RiverIce>();
    listed = true;
  }
  laws::add_fallbacks();  // every new instance of LIGGGHTS writes its own fallbacks into the common table
}

}  // namespace embacle::liggghts
