#include "stock_access.hpp"

#include <map>
#include <string>

#include <granular_pair_style.h>
#include <granular_wall.h>

using namespace LAMMPS_NS;

namespace {

// An explicit instantiation may name private members (C++20, [temp.spec.general]/6), which makes this legal.
template <typename Key, typename Key::Type member>
struct Opened {
  friend typename Key::Type open(Key) { return member; }
};

#define EMBACLE_OPEN(KEY, CLASS, MEMBER, ...) \
  struct KEY {                                \
    using Type = __VA_ARGS__ CLASS::*;        \
    friend Type open(KEY);                    \
  };                                          \
  template struct Opened<KEY, &CLASS::MEMBER>

using FixMap = std::map<std::string, embacle::liggghts::FixCreator>;
EMBACLE_OPEN(FixMapKey, Modify, fix_map, FixMap*);
EMBACLE_OPEN(StepKey, FixMultisphere, dtv, double);
EMBACLE_OPEN(KickKey, FixMultisphere, dtf, double);
EMBACLE_OPEN(TurnKey, FixMultisphere, dtq, double);
EMBACLE_OPEN(WallStepKey, FixWallGran, dt_, double);
EMBACLE_OPEN(HoldKey, Neighbor, xhold, double**);
EMBACLE_OPEN(LineKey, Input, line, char*);
using CommandMap = std::map<std::string, embacle::liggghts::CommandCreator>;
EMBACLE_OPEN(CommandMapKey, Input, command_map, CommandMap*);
EMBACLE_OPEN(WallTypeKey, PrimitiveWall, wType, PRIMITIVE_WALL_DEFINITIONS::WallType);
EMBACLE_OPEN(WallPlaceKey, PrimitiveWall, param, double*);
EMBACLE_OPEN(ShearKey, FixWallGran, shear_, int);
EMBACLE_OPEN(ShearDirectionKey, FixWallGran, shearDim_, int);
EMBACLE_OPEN(ShearSpeedKey, FixWallGran, vshear_, double);

using PairFactory = LIGGGHTS::Utils::AbstractFactory<LIGGGHTS::PairStyles::IGranularPairStyle>;
using WallFactory = LIGGGHTS::Utils::AbstractFactory<LIGGGHTS::Walls::IGranularWall>;
using SelectorMap = std::map<std::string, embacle::liggghts::VariantSelector>;
EMBACLE_OPEN(PairSelectorKey, PairFactory, variantSelectorTable, SelectorMap);
EMBACLE_OPEN(WallSelectorKey, WallFactory, variantSelectorTable, SelectorMap);

}  // namespace

namespace embacle::liggghts {

void register_fix_style(LAMMPS* lammps, const std::string& style, FixCreator creator) {
  (*(lammps->modify->*open(FixMapKey{})))[style] = creator;
}

void replace_command(LAMMPS* lammps, const std::string& command, CommandCreator creator) {
  (*(lammps->input->*open(CommandMapKey{})))[command] = creator;
}

void set_time_step(LAMMPS* lammps, double step) {
  Update* update = lammps->update;
  if (step == update->dt) return;
  update->update_time();  // the clock so far ran with the old step
  update->dt = step;
  Modify* modify = lammps->modify;
  if (lammps->force->pair) lammps->force->pair->reset_dt();
  for (int i = 0; i < modify->nfix; ++i) {
    modify->fix[i]->reset_dt();
    if (auto* multisphere = dynamic_cast<FixMultisphere*>(modify->fix[i])) {
      multisphere->*open(StepKey{}) = step;
      multisphere->*open(KickKey{}) = 0.5 * step * lammps->force->ftm2v;
      multisphere->*open(TurnKey{}) = 0.5 * step;
    } else if (auto* wall = dynamic_cast<FixWallGran*>(modify->fix[i])) {
      wall->*open(WallStepKey{}) = step;
    }
  }
}

double** positions_at_neighbour_build(LAMMPS* lammps) { return lammps->neighbor->*open(HoldKey{}); }

PrimitivePlane primitive_plane(FixWallGran* wall) {
  PrimitivePlane plane;
  PrimitiveWall* primitive = wall->primitiveWall();
  const int type = primitive->*open(WallTypeKey{});
  if (type > PRIMITIVE_WALL_DEFINITIONS::ZPLANE) return plane;
  plane.axis = type;
  plane.place = (primitive->*open(WallPlaceKey{}))[0];
  if (wall->*open(ShearKey{})) plane.velocity[wall->*open(ShearDirectionKey{})] = wall->*open(ShearSpeedKey{});
  return plane;
}

void replace_variant_selectors(VariantSelector selector) {
  (LIGGGHTS::PairStyles::Factory::instance().*open(PairSelectorKey{}))["gran"] = selector;
  (LIGGGHTS::Walls::Factory::instance().*open(WallSelectorKey{}))["gran"] = selector;
}

std::string current_script_line(LAMMPS* lammps) {
  const char* line = lammps->input ? lammps->input->*open(LineKey{}) : nullptr;
  std::string text = line ? line : "";
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' ')) text.pop_back();
  return text;
}

}  // namespace embacle::liggghts
