// The rules between the keys of a scene: what no single key can be checked for. Included by reader.cpp only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "scene/schema.hpp"
#include "scene/units.hpp"

namespace embacle::mps {

/// Support radii [l0] for which a kernel is usable. Below 2 the Wendland kernel hardly sees the second neighbours;
/// beyond 4 the rational kernel, singular at zero, gains nothing over its neighbours' noise.
[[nodiscard]] inline Range support_range(KernelKind kernel) {
  return kernel == KernelKind::wendland ? Range{.lower = 2, .upper = 5} : Range{.lower = 1.5, .upper = 4};
}

/// What the rules between keys need to know of the file, and where they report. Paths are those of the messages
/// ("water.upstream.level").
struct RuleContext {
  std::function<bool(const std::string& path)> given;       ///< the file or an override has this key
  std::function<bool(const std::string& path)> overridden;  ///< an override has set this key
  std::function<bool(const std::string& path)> sound;       ///< neither the key nor anything below it has a problem
  std::function<void(const std::vector<std::string>& paths, const std::string& problem)> report;
};

/// Checks the order of corners, that everything is inside the domain, and keys that exclude each other.
class Rules {
 public:
  Rules(const Scene& scene, const RuleContext& context) : scene_(scene), context_(context) {}

  void check() {
    domain_sound_ =
        context_.sound("domain") && context_.sound("dimension") && check_corners("domain", scene_.domain, true);
    if (scene_.dimension == 3 && context_.given("domain.thickness"))
      context_.report({"domain.thickness"}, "only for 2-D scenes; leave it out or set dimension = 2");
    check_numerics();
    check_central_force();
    check_periodic();
    each("water", scene_.water, [this](const std::string& path, const Water& water) { check_water(path, water); });
    each("wall", scene_.walls, [this](const std::string& path, const Wall& wall) { check_wall(path, wall); });
    each("opening", scene_.openings,
         [this](const std::string& path, const Opening& opening) { check_opening(path, opening); });
    each("sponge", scene_.sponges,
         [this](const std::string& path, const Sponge& sponge) { check_sponge(path, sponge); });
    each("gauge", scene_.gauges, [this](const std::string& path, const Gauge& gauge) { check_gauge(path, gauge); });
    check_output();
  }

 private:
  static constexpr std::array<char, 3> axis_names{'x', 'y', 'z'};

  /// Visits the elements that were read without a problem, each name once.
  template <class T, class F>
  void each(const std::string& kind, const std::vector<T>& elements, F&& f) {
    std::set<std::string> seen;
    for (const T& element : elements) {
      const std::string path = kind + "." + element.name;
      if (!element.name.empty() && seen.insert(element.name).second && context_.sound(path)) f(path, element);
    }
  }

  std::string text(const Vec3d& v) const {
    std::string result = "[" + rounded(v[0]);
    for (int axis = 1; axis < scene_.dimension; ++axis) result += ", " + rounded(v[axis]);
    return result + "]";
  }

  bool check_corners(const std::string& path, const BoxRegion& region, bool volume_needed) {
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const double lower = region.lower[axis];
      const double upper = region.upper[axis];
      if (lower < upper || (lower == upper && !volume_needed)) continue;
      context_.report({path + ".upper", path + ".lower"},
                      std::string("in ") + axis_names[axis] + " upper (" + number_text(upper) + " m) must be " +
                          (volume_needed ? "greater than" : "at least") + " lower (" + number_text(lower) + " m)");
      return false;
    }
    return true;
  }

  /// Rounding of sums of parameters must not put something outside that stands exactly on the border.
  bool inside_domain(const Vec3d& point) const {
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const double slack = 1e-9 * (scene_.domain.upper[axis] - scene_.domain.lower[axis]);
      if (point[axis] < scene_.domain.lower[axis] - slack || point[axis] > scene_.domain.upper[axis] + slack)
        return false;
    }
    return true;
  }

  void check_inside(const std::string& path, const std::string& key, const Vec3d& point) {
    if (!domain_sound_ || inside_domain(point)) return;
    context_.report({path + "." + key, "domain.lower", "domain.upper"}, text(point) + " m is outside of the domain, " +
                                                                            text(scene_.domain.lower) + " to " +
                                                                            text(scene_.domain.upper) + " m");
  }

  void check_region(const std::string& path, const BoxRegion& region, bool volume_needed) {
    if (!check_corners(path, region, volume_needed)) return;
    check_inside(path, "lower", region.lower);
    check_inside(path, "upper", region.upper);
  }

  void check_numerics() {
    const Numerics& n = scene_.numerics;
    if (context_.given("numerics.support") && context_.sound("numerics.support") && context_.sound("numerics.kernel")) {
      const Range range = support_range(n.kernel);
      if (!range.contains(n.support))
        context_.report({"numerics.support", "numerics.kernel"},
                        number_text(n.support) + " does not suit the " +
                            (n.kernel == KernelKind::wendland ? "wendland" : "rational") +
                            " kernel; allowed: " + range.text());
    }
    if (context_.given("numerics.smagorinsky") && context_.sound("numerics.turbulence") &&
        n.turbulence != TurbulenceModel::smagorinsky)
      context_.report({"numerics.smagorinsky", "numerics.turbulence"}, "belongs to turbulence = \"smagorinsky\"");
    if (n.wall_pressure == WallPressure::continuity && scene_.coupled())
      context_.report({"numerics.wall_pressure", "coupling.script"},
                      "continuity is for walls only, and the scene has solids (coupling.script), whose points keep no "
                      "density; allowed: extrapolated");
    if (n.integrator == Integrator::symplectic) check_symplectic();
    if (!domain_sound_ || !context_.sound("numerics.particle_distance")) return;
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const double extent = scene_.domain.upper[axis] - scene_.domain.lower[axis];
      if (n.particle_distance <= extent) continue;
      context_.report({"numerics.particle_distance", "domain.lower", "domain.upper"},
                      number_text(n.particle_distance) + " m is more than the domain's extent in " + axis_names[axis] +
                          ", " + number_text(extent) + " m");
      return;
    }
  }

  void check_symplectic() {
    const Numerics& n = scene_.numerics;
    const auto refuse = [this](bool wrong, const std::string& other, const std::string& why) {
      if (wrong) context_.report({"numerics.integrator", other}, "symplectic " + why);
    };
    refuse(scene_.coupled(), "coupling.script", "is for scenes without solids (coupling.script); allowed: leapfrog");
    refuse(shifts(n.regularisation), "numerics.regularisation", "does not go with shifting; allowed: leapfrog");
    refuse(n.wall_pressure == WallPressure::continuity, "numerics.wall_pressure",
           "does not go with wall_pressure = \"continuity\"; allowed: leapfrog");
    refuse(n.skin < 0.1, "numerics.skin", "needs a skin of at least 0.1");
  }

  /// It acts on the water alone, and not along directions without a place of their own.
  void check_central_force() {
    const std::string path = "fluid.central_force";
    if (context_.given(path + "_centre") && !context_.given(path))
      context_.report({path + "_centre"}, "is of a central_force, and there is none; leave it out");
    if (scene_.fluid.central_force == 0) return;
    if (!scene_.periodic.empty())
      context_.report({path, "domain.periodic"}, "is not possible in a periodic domain; leave out one");
    if (scene_.coupled())
      context_.report({path, "coupling.script"}, "acts on the water only, and the scene has solids; leave out one");
  }

  /// Lengths of 1e-6 particle distances are rounding.
  static bool same_place(double a, double b, double particle_distance) {
    return std::abs(a - b) <= 1e-6 * particle_distance;
  }

  /// A computed length without the digits of its rounding.
  static std::string rounded(double length) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.12g", length);
    return number_text(std::strtod(digits.data(), nullptr));
  }

  void check_periodic() {
    const std::string path = "domain.periodic";
    if (scene_.periodic.empty() || !context_.sound(path)) return;
    const std::set<std::string> axes(scene_.periodic.begin(), scene_.periodic.end());
    if (axes.size() < scene_.periodic.size()) context_.report({path}, "names a direction twice");
    if (scene_.dimension == 2 && axes.contains("z"))
      return context_.report({path}, "a 2-D scene has no direction z; allowed: x, y");
    if (context_.given("coupling"))
      context_.report({path}, "bodies in a periodic domain are not possible yet; leave out this or [coupling]");
    if (!domain_sound_ || !context_.sound("numerics")) return;
    const double l0 = scene_.numerics.particle_distance;
    const double needed = 2 * (support() + scene_.numerics.skin * l0);
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      if (!scene_.is_periodic(axis)) continue;
      const double length = scene_.domain.upper[axis] - scene_.domain.lower[axis];
      const double whole = std::round(length / l0) * l0;
      const std::string what =
          std::string("the domain's length in ") + axis_names[axis] + ", " + rounded(length) + " m, ";
      if (!same_place(length, whole, l0))
        context_.report({path, "domain.lower", "domain.upper", "numerics.particle_distance"},
                        what + "is no whole number of particle distances (" + number_text(l0) +
                            " m); nearest: " + rounded(whole) + " m");
      if (length < needed)
        context_.report({path, "domain.lower", "domain.upper", "numerics.particle_distance"},
                        what + "is less than twice the support and skin; allowed: >= " + rounded(needed) + " m");
    }
  }

  /// [m]
  double support() const {
    const Numerics& n = scene_.numerics;
    return n.particle_distance * (n.support > 0 ? n.support : default_support(n.kernel));
  }

  void check_periodic_wall(const std::string& path, const Wall& wall) {
    if (scene_.periodic.empty() || !domain_sound_ || !context_.sound("numerics") || !context_.sound("domain")) return;
    const double l0 = scene_.numerics.particle_distance;
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const double lower = wall.region.lower[axis];
      const double upper = wall.region.upper[axis];
      const std::string name(1, axis_names[axis]);
      if (wall.kind == Wall::Kind::box && upper - lower < (std::floor(support() / l0 + 1e-9) - 0.5) * l0)
        context_.report({path + ".upper", path + ".lower", "domain.periodic"},
                        "in " + name + " the wall is thinner than the support (" + rounded(support()) +
                            " m), which is not possible in a periodic domain yet; make it as thick as that");
      if (wall.kind == Wall::Kind::box || !scene_.is_periodic(axis)) continue;
      for (const char* sign : {"-", "+"})
        if (std::find(wall.open.begin(), wall.open.end(), name + sign) == wall.open.end())
          context_.report({path + ".open", "domain.periodic"},
                          "the domain is periodic in " + name + ", so a tank must be open at " + name + sign);
      if (!same_place(lower, scene_.domain.lower[axis], l0) || !same_place(upper, scene_.domain.upper[axis], l0))
        context_.report({path + ".upper", path + ".lower", "domain.periodic"},
                        "the domain is periodic in " + name + ", so a tank must reach from end to end, " +
                            number_text(scene_.domain.lower[axis]) + " m to " + number_text(scene_.domain.upper[axis]) +
                            " m");
    }
  }

  /// Keys that say where something of a kind is: those it needs are there, and no others. `own`: of the kinds that are
  /// no forms.
  bool check_keys(const std::string& path, const std::string& what, const std::array<std::string, 6>& kinds,
                  const std::map<std::string, std::set<std::string>>& own, const std::string& kind) {
    const bool space = scene_.dimension == 3;
    std::map<std::string, std::set<std::string>> needed = own;
    needed["cylinder"] = {"centre", "radius"};
    needed["sphere"] = {"centre", "radius"};
    needed["prism"] = {"polygon"};
    needed["stl"] = {"surface"};
    std::map<std::string, std::set<std::string>> possible = needed;
    possible["stl"].insert("scale");
    for (const char* key : {"length", "axis"}) possible["cylinder"].insert(key);
    for (const char* key : {"from", "to", "axis"}) possible["prism"].insert(key);
    if (space) {
      needed["cylinder"].insert("length");
      needed["prism"].insert({"from", "to"});
    }
    bool sound = true;
    const auto report = [&](const std::string& at, const std::string& problem) {
      context_.report({at}, problem);
      sound = false;
    };
    if (!space && kind == "stl") report(path + ".kind", "a 2-D scene has no surfaces; a prism is a polygon there");
    for (const std::string& key : needed[kind])
      if (!context_.given(path + "." + key))
        report(path, "the key '" + key + "' is required for " + what + " of this kind (" + kind + ")");
    std::set<std::string> all;
    for (const auto& [name, keys] : possible) all.insert(keys.begin(), keys.end());
    for (const std::string& key : all) {
      if (!context_.given(path + "." + key)) continue;
      const bool across = key == "length" || key == "axis" || key == "from" || key == "to";
      if (!possible[kind].contains(key)) {
        std::string owners;
        for (const std::string& name : kinds)
          if (possible[name].contains(key)) owners += (owners.empty() ? "" : ", ") + name;
        report(path + "." + key, "does not belong to " + what + " of kind " + kind +
                                     "; leave it out (kinds that have it: " + owners + ")");
      } else if (!space && across) {
        report(path + "." + key, "only for 3-D scenes; leave it out");
      }
    }
    return sound;
  }

  void check_form(const std::string& path, const Form& form, const BoxRegion& region) {
    if (form.kind == Form::Kind::prism) {
      if (scene_.dimension == 3 && form.from >= form.to)
        return context_.report({path + ".to", path + ".from"}, number_text(form.to) + " m must be greater than from (" +
                                                                   number_text(form.from) + " m)");
      if (const std::string problem = polygon_problem(form.polygon); !problem.empty())
        return context_.report({path + ".polygon"}, problem);
    }
    if (!domain_sound_ || (inside_domain(region.lower) && inside_domain(region.upper))) return;
    context_.report({path, "domain.lower", "domain.upper"},
                    "from " + text(region.lower) + " to " + text(region.upper) + " m it reaches out of the domain, " +
                        text(scene_.domain.lower) + " to " + text(scene_.domain.upper) + " m");
  }

  static std::string polygon_problem(const std::vector<Vec3d>& corners) {
    const std::size_t n = corners.size();
    if (n < 3) return "has " + std::to_string(n) + " corners; allowed: at least 3";
    const auto turn = [](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
      return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    };
    const auto corner = [&](std::size_t k) -> const Vec3d& { return corners[k % n]; };
    for (std::size_t i = 0; i < n; ++i) {
      if (corner(i) == corner(i + 1))
        return "corners " + std::to_string(i + 1) + " and " + std::to_string((i + 1) % n + 1) + " are the same";
      for (std::size_t j = i + 2; j < n; ++j) {
        if ((j + 1) % n == i) continue;  // neighbours share a corner
        const Vec3d &a = corner(i), &b = corner(i + 1), &c = corner(j), &d = corner(j + 1);
        if (turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0 &&
            (turn(a, b, c) != 0 || turn(a, b, d) != 0))
          return "the edges from corners " + std::to_string(i + 1) + " and " + std::to_string(j + 1) + " on cross";
      }
    }
    double area = 0;
    for (std::size_t k = 0; k < n; ++k) area += corner(k)[0] * corner(k + 1)[1] - corner(k + 1)[0] * corner(k)[1];
    return area == 0 ? "its corners are on one line" : "";
  }

  void check_water(const std::string& path, const Water& water) {
    static const std::array<std::string, 6> kinds{"box", "table", "cylinder", "sphere", "prism", "stl"};
    static const std::map<std::string, std::set<std::string>> own{{"box", {"lower", "upper"}}, {"table", {"file"}}};
    const bool complete = check_keys(path, "water", kinds, own, kinds[static_cast<std::size_t>(water.kind)]);
    if (water.kind == Water::Kind::table && water.fill_from)
      context_.report({path + ".fill_from"}, "does not belong to water of kind table; leave it out");
    if (!complete) return;
    if (water.kind == Water::Kind::table)
      check_water_table(path, water);
    else if (water.kind == Water::Kind::box)
      check_region(path, water.region, false);
    else
      check_form(path, water.form, water.region);
    if (water.fill_from) check_inside(path, "fill_from", *water.fill_from);
    if (water.level && scene_.static_gravity() == Vec3d{} && context_.sound("fluid.gravity"))
      context_.report({path + ".level"}, scene_.fluid.gravity == Vec3d{}
                                             ? "a level needs gravity, and fluid.gravity is zero; leave it out"
                                             : "fluid.gravity acts only along periodic directions; leave it out");
  }

  void check_water_table(const std::string& path, const Water& water) {
    for (const WaterTable::Row& row : water.table.rows) {
      if (!domain_sound_ || inside_domain(row.position)) continue;
      context_.report({path + ".file", "domain.lower", "domain.upper"},
                      water.table.file.filename().string() + ":" + std::to_string(row.line) + ": " +
                          text(row.position) + " m is outside of the domain, " + text(scene_.domain.lower) + " to " +
                          text(scene_.domain.upper) + " m");
      break;
    }
    if (water.table.has_velocity && context_.given(path + ".velocity"))
      context_.report({path + ".velocity"}, "the table has velocities; leave it out, here or there");
    if (water.table.has_pressure && context_.given(path + ".level"))
      context_.report({path + ".level"}, "the table has pressures; leave it out, or leave them out");
  }

  void check_wall(const std::string& path, const Wall& wall) {
    static const std::array<std::string, 6> kinds{"tank", "box", "cylinder", "sphere", "prism", "stl"};
    static const std::map<std::string, std::set<std::string>> own{{"box", {"lower", "upper"}},
                                                                  {"tank", {"lower", "upper"}}};
    const bool complete = check_keys(path, "a wall", kinds, own, kinds[static_cast<std::size_t>(wall.kind)]);
    if (wall.kind != Wall::Kind::tank && context_.given(path + ".open"))
      context_.report({path + ".open"}, "only a tank has open sides; leave it out or set kind = \"tank\"");
    if (complete && wall.kind <= Wall::Kind::box) {
      check_region(path, wall.region, true);
      check_periodic_wall(path, wall);
    } else if (complete) {
      check_form(path, wall.form, wall.region);
    }
    if (wall.kind == Wall::Kind::tank) {
      const std::set<std::string> open(wall.open.begin(), wall.open.end());
      if (open.size() < wall.open.size()) context_.report({path + ".open"}, "names a side twice");
      if (static_cast<int>(open.size()) == 2 * scene_.dimension)
        context_.report({path + ".open"}, "all sides are open: nothing is left of the tank");
      if (scene_.dimension == 2 && (open.contains("z-") || open.contains("z+")))
        context_.report({path + ".open"}, "a 2-D tank has no sides in z; allowed: x-, x+, y-, y+");
    }
    if (wall.motion) check_motion(path + ".motion", *wall.motion);
    if (wall.motion) check_turn(path, wall);
    check_friction(path, wall);
  }

  /// Water without viscosity slips along everything.
  void check_friction(const std::string& path, const Wall& wall) {
    const std::string surface = path + ".motion.surface_velocity";
    if (context_.given(surface) && wall.slip.value_or(false))
      context_.report({path + ".slip", surface},
                      "a wall with a velocity of its surface drags the water: leave out one");
    if (scene_.fluid.kinematic_viscosity > 0 || !context_.sound("fluid.kinematic_viscosity")) return;
    const char* const viscosity =
        "needs a viscosity, and fluid.kinematic_viscosity is zero; leave it out, or state one";
    if (!wall.slip.value_or(true)) context_.report({path + ".slip", "fluid.kinematic_viscosity"}, viscosity);
    if (context_.given(surface)) context_.report({surface, "fluid.kinematic_viscosity"}, viscosity);
  }

  void check_motion(const std::string& path, const Motion& motion) {
    const auto given = [&](const char* key) { return context_.given(path + key); };
    const bool has_table = given(".table"), has_velocity = given(".velocity"), has_surface = given(".surface_velocity");
    const bool turns = given(".angular_velocity") || given(".angle_table");
    const int kinds = (has_table ? 1 : 0) + (has_velocity ? 1 : 0) + (has_surface ? 1 : 0);
    if (kinds > 1 || (kinds == 0 && !turns))
      context_.report({has_table     ? path + ".table"
                       : has_surface ? path + ".surface_velocity"
                                     : path},
                      kinds > 1 ? "a motion has either a table or a velocity, of the wall or of its surface, not both"
                                : "needs a velocity, a surface_velocity or a table, or an angular_velocity or an "
                                  "angle_table");
    const bool constant = has_velocity || has_surface || given(".angular_velocity");
    for (const char* key : {".start", ".stop"})
      if (!constant && (kinds == 1 || turns) && given(key))
        context_.report({path + key},
                        "belongs to a motion by velocity, and this one has a table, which says when; leave it out");
    if (constant && motion.stop <= motion.start)
      context_.report({path + ".stop", path + ".start"},
                      number_text(motion.stop) + " s must be after start (" + number_text(motion.start) + " s)");
    if (given(".interpolation") && !has_table && !given(".angle_table"))
      context_.report({path + ".interpolation"}, "is of tables, and there is none; leave it out");
  }

  /// A turn: its keys, and the walls that can.
  void check_turn(const std::string& wall_path, const Wall& wall) {
    const std::string path = wall_path + ".motion";
    const bool constant = context_.given(path + ".angular_velocity"), table = context_.given(path + ".angle_table");
    const std::string key = path + (table ? ".angle_table" : ".angular_velocity");
    if (!constant && !table) {
      for (const char* own : {".pivot", ".axis"})
        if (context_.given(path + own))
          context_.report({path + own},
                          "is of a turn (angular_velocity, angle_table), and there is none; leave it out");
      return;
    }
    if (constant && table) context_.report({key}, "a turn has either an angle_table or an angular_velocity, not both");
    if (context_.given(path + ".surface_velocity"))
      context_.report({path + ".surface_velocity", key},
                      "belongs to a wall that stays where it is; leave out the turn");
    if (!context_.given(path + ".pivot")) context_.report({key}, "the key 'pivot' is required for a wall that turns");
    if (scene_.dimension == 2 && context_.given(path + ".axis"))
      context_.report({path + ".axis"}, "only for 3-D scenes; leave it out");
    if (wall.motion->axis == Vec3d{}) context_.report({path + ".axis"}, "must not be zero");
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const std::string name(1, axis_names[axis]);
      if (scene_.is_periodic(axis) && std::abs(wall.motion->axis[axis]) != 1)
        context_.report({key, "domain.periodic"}, "the domain is periodic in " + name +
                                                      ", where a wall cannot turn but about an axis in that direction");
      const double thickness = wall.region.upper[axis] - wall.region.lower[axis];
      if (wall.kind == Wall::Kind::box &&
          thickness < (std::floor(support() / scene_.numerics.particle_distance + 1e-9) - 0.5) *
                          scene_.numerics.particle_distance)
        context_.report({key}, "in " + name + " the wall is thinner (" + rounded(thickness) + " m) than the support (" +
                                   rounded(support()) +
                                   " m), and such a wall cannot turn yet; make it as thick as that, or shorten the "
                                   "support");
    }
  }

  void check_opening(const std::string& path, const Opening& opening) {
    using Kind = Opening::Kind;
    static constexpr std::array<const char*, 3> kinds{"an inflow", "an outflow", "a drain"};
    const std::string what = kinds[static_cast<std::size_t>(opening.kind)];
    const auto given = [&](const char* key) { return context_.given(path + key); };
    const auto refuse = [&](bool wrong, const char* key) {
      if (wrong && given(key)) context_.report({path + key}, "does not belong to " + what + "; leave it out");
    };
    const auto require = [&](bool missing, const std::string& key) {
      if (missing) context_.report({path}, "the key " + key + " is required for " + what);
    };
    const bool drain = opening.kind == Kind::drain, inflow = opening.kind == Kind::inflow;
    for (const char* key : {".direction", ".discharge", ".hydrograph", ".level"}) refuse(drain, key);
    refuse(!inflow, ".profile");
    require(!drain && !given(".direction"), "'direction'");
    require(opening.kind == Kind::outflow && !given(".level"), "'level'");
    require(inflow && !given(".discharge") && !given(".hydrograph"), "'discharge' or 'hydrograph'");
    if (given(".discharge") && given(".hydrograph"))
      context_.report({path + ".hydrograph", path + ".discharge"}, "an opening has either of them, not both");
    check_region(path, opening.region, true);
    if (shifts(scene_.numerics.regularisation))
      context_.report({path, "numerics.regularisation"}, "does not go with shifting; allowed: collision, none");
    if (scene_.numerics.integrator == Integrator::symplectic)
      context_.report({path, "numerics.integrator"}, "does not go with symplectic; allowed: leapfrog");
    if (!drain && given(".direction")) check_flow(path, opening);
  }

  /// Through an inflow or outflow.
  void check_flow(const std::string& path, const Opening& opening) {
    const int axis = axis_of(opening.direction);
    const std::string name(1, axis_names[axis]);
    if (axis >= scene_.dimension)
      return context_.report({path + ".direction"}, "a 2-D scene has no direction z; allowed: -x, +x");
    if (scene_.fluid.gravity[scene_.upright()] > 0)
      return context_.report({path, "fluid.gravity"}, "needs gravity downwards, against the axis");
    if (axis == scene_.upright() || scene_.fluid.gravity == Vec3d{})
      return context_.report({path + ".direction", "fluid.gravity"}, "must be level, across gravity");
    if (scene_.is_periodic(axis))
      return context_.report({path + ".direction", "domain.periodic"}, "the domain is periodic in " + name);
    const double height = opening.level.value_or(opening.region.upper[scene_.upright()]);
    if (height <= opening.region.lower[scene_.upright()] || height > opening.region.upper[scene_.upright()])
      context_.report({path + ".level", path + ".lower", path + ".upper"},
                      rounded(height) + " m is not within the zone's height");
    if (!domain_sound_ || !context_.sound("numerics")) return;
    const double l0 = scene_.numerics.particle_distance;
    const double length = opening.region.upper[axis] - opening.region.lower[axis];
    if (length < support() + l0 - 1e-6 * l0)
      context_.report({path + ".upper", path + ".lower"}, "in " + name + " the zone is " + rounded(length) +
                                                              " m long; allowed: at least the support and a particle "
                                                              "distance, " +
                                                              rounded(support() + l0) + " m");
    const double beyond = sign_of(opening.direction) > 0 ? scene_.domain.upper[axis] - opening.region.upper[axis]
                                                         : opening.region.lower[axis] - scene_.domain.lower[axis];
    if (opening.kind == Opening::Kind::outflow && beyond < l0 - 1e-6 * l0)
      context_.report({path + (sign_of(opening.direction) > 0 ? ".upper" : ".lower"), "domain.lower", "domain.upper"},
                      "behind the zone the domain must go on for at least one particle distance");
  }

  void check_sponge(const std::string& path, const Sponge& sponge) {
    check_region(path, sponge.region, true);
    if (axis_of(sponge.direction) == scene_.upright() || axis_of(sponge.direction) >= scene_.dimension)
      context_.report({path + ".direction"},
                      std::string("must be level; allowed: ") + (scene_.dimension == 2 ? "-x, +x" : "-x, +x, -y, +y"));
    if (scene_.fluid.gravity == Vec3d{} && sponge.damping_time == 0)
      context_.report({path, "fluid.gravity"}, "without gravity there is no default: state 'damping_time'");
  }

  void check_gauge(const std::string& path, const Gauge& gauge) {
    const bool front = gauge.kind == GaugeKind::front;
    const bool has_position = context_.given(path + ".position");
    if (front && has_position)
      context_.report({path + ".position"}, "a front has a direction, no position; leave it out");
    if (!front && !has_position) context_.report({path}, "the key 'position' is required for a gauge of this kind");
    if (!front && has_position) check_inside(path, "position", gauge.position);
    if (!front && context_.given(path + ".direction"))
      context_.report({path + ".direction"}, "only a front has a direction; leave it out");
    if (front && gauge.direction == Vec3d{}) context_.report({path + ".direction"}, "must not be zero");
    for (int axis = 0; front && axis < scene_.dimension; ++axis)
      if (scene_.is_periodic(axis) && gauge.direction[axis] != 0)
        context_.report({path + ".direction", "domain.periodic"},
                        std::string("the domain is periodic in ") + axis_names[axis] + ", where no front has an end");
  }

  /// A run that is cut short from the command line may have pictures after its end: they are just not taken.
  void check_output() {
    if (!context_.sound("run.end_time") || !context_.sound("output.pictures")) return;
    const std::vector<double>& times = scene_.output.pictures;
    if (times.empty() || times.back() <= scene_.end_time || context_.overridden("run.end_time")) return;
    context_.report({"output.pictures"}, number_text(times.back()) + " s is after the end of the run (run.end_time = " +
                                             number_text(scene_.end_time) + " s)");
  }

  const Scene& scene_;
  const RuleContext& context_;
  bool domain_sound_ = false;
};

}  // namespace embacle::mps
