#include "contact/floe_styles.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
// The order of these headers follows LIGGGHTS' own needs.
#include <lammps.h>

#include <comm.h>
#include <error.h>
#include <force.h>

#include <contact_interface.h>
#include <contact_models.h>
#include <granular_pair_style.h>
#include <granular_wall.h>
#include <pair_gran.h>

#include "contact/floe_contacts.hpp"
#include "stock_access.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::InputError;

namespace {

/// Of the 64 identifiers that LIGGGHTS' hash codes have room for; the stock models use the first dozen.
constexpr int floe_model = 40;
constexpr std::int64_t floe_hash = floe_model;  // other models off

const char* const contacts_id = "floe_contacts";

/// Keeps the contacts and writes what they remember into restart files.
class FixFloeContacts : public Fix {
 public:
  FixFloeContacts(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv), contacts_(lammps) {
    restart_global = 1;
  }
  int setmask() override { return 0; }
  void write_restart(FILE* file) override {
    const FloeContacts::Memory kept = contacts_.memory();
    if (comm->me != 0) return;
    const std::array<double, 2> counts = {static_cast<double>(kept.contacts.size()),
                                          static_cast<double>(kept.forces.size())};
    const int bytes = static_cast<int>((2 + kept.contacts.size() + kept.forces.size()) * sizeof(double));
    fwrite(&bytes, sizeof bytes, 1, file);
    fwrite(counts.data(), sizeof(double), 2, file);
    for (const auto* part : {&kept.contacts, &kept.forces}) {
      fwrite(part->data(), sizeof(double), part->size(), file);
    }
  }
  void restart(char* buffer) override {
    std::array<double, 2> counts{};
    std::memcpy(counts.data(), buffer, sizeof counts);
    FloeContacts::Memory kept;
    kept.contacts.resize(static_cast<std::size_t>(counts[0]));
    kept.forces.resize(static_cast<std::size_t>(counts[1]));
    buffer += sizeof counts;
    for (auto* part : {&kept.contacts, &kept.forces}) {
      std::memcpy(part->data(), buffer, part->size() * sizeof(double));
      buffer += part->size() * sizeof(double);
    }
    contacts_.remember(std::move(kept));
  }
  FloeContacts& contacts() { return contacts_; }

 private:
  FloeContacts contacts_;
};

FixFloeContacts* find_contacts(LAMMPS* lammps) {
  return dynamic_cast<FixFloeContacts*>(lammps->modify->find_fix_id(contacts_id));
}

class FloePairs : public LIGGGHTS::PairStyles::IGranularPairStyle, private Pointers {
 public:
  explicit FloePairs(LAMMPS* lammps) : Pointers(lammps) {}

  void settings(int count, char** words, LIGGGHTS::IContactHistorySetup* /*setup*/) override {
    if (count > 0) {
      throw InputError(
          fmt::format("pair_style gran model floe: has no option '{}'; allowed is 'pair_style gran model "
                      "floe'",
                      words[0]));
    }
  }
  void init_granular() override {
    if (!find_contacts(lmp)) {
      std::array<const char*, 3> words = {contacts_id, "all", "floe/contacts"};
      modify->add_fix(3, const_cast<char**>(words.data()));
    }
    find_contacts(lmp)->contacts().prepare();
  }
  void write_restart_settings(FILE* file) override {
    const std::int64_t hash = floe_hash;
    fwrite(&hash, sizeof hash, 1, file);
  }
  void read_restart_settings(FILE* file, const std::int64_t /*hash*/) override {
    std::int64_t hash = 0;
    if (comm->me == 0 && fread(&hash, sizeof hash, 1, file) != 1) {
      throw InputError("pair_style gran model floe: the restart file ends early");
    }
  }
  void compute_force(PairGran* pair, int energy, int virial, int /*add*/) override {
    pair->evflag = pair->vflag_fdotr = 0;
    if (energy || virial) pair->ev_setup(energy, virial);
    if (!pair->computeflag()) return;
    FloeContacts& contacts = find_contacts(lmp)->contacts();
    if (update->setupflag) {
      contacts.set_up();
    } else {
      contacts.compute();
    }
  }
  int get_history_offset(const std::string /*name*/) override { return -1; }
  double stressStrainExponent() override { return 1; }
  std::int64_t hashcode() override { return floe_hash; }
  bool contact_match(const std::string kind, const std::string model) override {
    return kind == "model" && model == "floe";
  }
};

/// The walls are read by FloeContacts; LIGGGHTS' own loop over spheres and walls finds nothing to do.
class FloeWall : public LIGGGHTS::Walls::IGranularWall, private Pointers {
 public:
  explicit FloeWall(LAMMPS* lammps) : Pointers(lammps) {}
  void settings(int count, char** words, LIGGGHTS::IContactHistorySetup* /*setup*/) override {
    if (count > 0) throw InputError(fmt::format("fix wall/gran model floe: has no option '{}'", words[0]));
  }
  void init_granular() override {
    auto* pair = dynamic_cast<PairGran*>(force->pair);
    if (!pair || !pair->contact_match("model", "floe")) {
      throw InputError("fix wall/gran model floe: needs 'pair_style gran model floe', which computes both");
    }
  }
  bool checkSurfaceIntersect(LIGGGHTS::ContactModels::SurfacesIntersectData& /*data*/) override { return false; }
  void compute_force(FixWallGran* /*wall*/, LIGGGHTS::ContactModels::SurfacesIntersectData& /*data*/,
                     bool /*intersect*/, double* /*velocity*/, FixMeshSurface* /*fix*/, int /*mesh_number*/,
                     TriMesh* /*mesh*/, int /*triangle*/) override {}
  int get_history_offset(std::string /*name*/) override { return -1; }
  bool contact_match(const std::string kind, const std::string model) override {
    return kind == "model" && model == "floe";
  }
};

LIGGGHTS::PairStyles::IGranularPairStyle* make_pairs(LAMMPS* lammps, PairGran* /*pair*/, std::int64_t /*hash*/) {
  return new FloePairs(lammps);
}
LIGGGHTS::Walls::IGranularWall* make_wall(LAMMPS* lammps, FixWallGran* /*fix*/, std::int64_t /*hash*/) {
  return new FloeWall(lammps);
}
Fix* make_contacts(LAMMPS* lammps, int argc, char** argv) { return new FixFloeContacts(lammps, argc, argv); }

/// As LIGGGHTS chooses, but what model floe does not know is refused: LIGGGHTS would silently take no contacts at all.
std::int64_t select(int& count, char**& words, Custom_contact_models custom) {
  const bool floe = count > 1 && std::string(words[0]) == "model" && std::string(words[1]) == "floe";
  const std::int64_t hash = LIGGGHTS::ContactModels::Factory::select(count, words, std::move(custom));
  if (floe && hash != floe_hash) {
    throw InputError(
        "model floe: brings its own friction (coefficientFriction) and cannot be combined with stock tangential, "
        "cohesion, rolling_friction or surface models; write 'model floe' alone");
  }
  return hash;
}

}  // namespace

void register_floe_styles(LAMMPS* lammps) {
  register_fix_style(lammps, "floe/contacts", &make_contacts);
  replace_variant_selectors(&select);  // each new LAMMPS object has set its own
  static bool done = false;
  if (done) return;
  done = true;
  LIGGGHTS::ContactModels::Factory::instance().addNormalModel("floe", floe_model);
  LIGGGHTS::PairStyles::Factory::instance().addStyle("gran", floe_model, &make_pairs);
  LIGGGHTS::Walls::Factory::instance().addStyle("gran", floe_model, &make_wall);
}

FloeContacts* floe_contacts(LAMMPS* lammps) {
  FixFloeContacts* fix = find_contacts(lammps);
  auto* pair = dynamic_cast<PairGran*>(lammps->force->pair);
  return fix && pair && pair->contact_match("model", "floe") ? &fix->contacts() : nullptr;
}

}  // namespace embacle::liggghts
