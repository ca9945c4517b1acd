// A scene as the user stated it, checked and in SI units: plain data, no behaviour.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace embacle::mps {

/// Vectors in scenes always have three components; in 2-D the third is zero and the plane is x-y.
using Vec3d = std::array<double, 3>;

struct BoxRegion {
  Vec3d lower{};  ///< [m]
  Vec3d upper{};  ///< [m]
};

enum class Axis { x, y, z };

struct Triangle {
  std::array<Vec3d, 3> corner;  ///< [m], counterclockwise seen from outside
};

/// A closed surface.
struct Surface {
  std::filesystem::path file;
  std::vector<Triangle> triangles;
};

/// A shape other than a box. In 2-D cylinders and spheres are discs and a prism is a polygon.
struct Form {
  enum class Kind { none, cylinder, sphere, prism, stl };
  Kind kind = Kind::none;
  Vec3d centre{};                          ///< of a cylinder or sphere [m]
  double radius = 0;                       ///< likewise [m]
  double length = 0;                       ///< of a cylinder, along its axis [m]
  Axis axis = Axis::z;                     ///< of a cylinder or prism
  std::vector<Vec3d> polygon;              ///< corners of a prism in the two other directions, in their order [m]
  double from = 0, to = 0;                 ///< ends of a prism along its axis [m]
  double scale = 1;                        ///< from the lengths of the surface's file to metres
  std::shared_ptr<const Surface> surface;  ///< of kind stl, in metres
};

/// The box around a form.
[[nodiscard]] inline BoxRegion bounds(const Form& form, int dimension) {
  BoxRegion box;
  const auto along = static_cast<std::size_t>(form.axis);
  if (form.kind == Form::Kind::cylinder || form.kind == Form::Kind::sphere) {
    for (int c = 0; c < dimension; ++c) {
      const bool end = form.kind == Form::Kind::cylinder && dimension == 3 && c == static_cast<int>(along);
      const double half = end ? 0.5 * form.length : form.radius;
      box.lower[c] = form.centre[c] - half;
      box.upper[c] = form.centre[c] + half;
    }
    return box;
  }
  box.lower.fill(std::numeric_limits<double>::max());
  box.upper.fill(std::numeric_limits<double>::lowest());
  const auto enclose = [&](std::size_t c, double x) {
    box.lower[c] = std::min(box.lower[c], x);
    box.upper[c] = std::max(box.upper[c], x);
  };
  if (form.kind == Form::Kind::prism) {
    for (const Vec3d& corner : form.polygon) {
      enclose(along == 0 ? 1 : 0, corner[0]);
      enclose(along == 2 ? 1 : 2, corner[1]);
    }
    enclose(along, dimension == 3 ? form.from : 0.0);
    enclose(along, dimension == 3 ? form.to : 0.0);
  } else if (form.surface) {
    for (const Triangle& triangle : form.surface->triangles) {
      for (const Vec3d& corner : triangle.corner) {
        for (std::size_t c = 0; c < 3; ++c) enclose(c, corner[c]);
      }
    }
  }
  return box;
}

enum class KernelKind { wendland, rational };
/// What keeps particles in order.
enum class Regularisation { collision, shifting, plain_shifting, none };
[[nodiscard]] inline bool shifts(Regularisation kind) {
  return kind == Regularisation::shifting || kind == Regularisation::plain_shifting;
}
/// Default support in particle distances.
[[nodiscard]] inline double default_support(KernelKind) { return 3.1; }
/// What the density diffusion acts on: the density less its hydrostatic part, or all of it.
enum class Diffusion { dynamic, plain };
enum class Integrator { leapfrog, symplectic };
/// Model of the turbulence below the size of the particles.
enum class TurbulenceModel { none, smagorinsky };
/// Pressure of wall points: extrapolated from the water, its mean, or from a density by the continuity equation.
enum class WallPressure { extrapolated, zero_gradient, continuity };
enum class Scheme { serial, parallel };
/// Loads on bodies: the exact reaction of the pair forces, or the sum of p A n over their surface.
enum class Loads { reaction, pressure };
enum class GaugeKind { level, pressure, front };
/// Between the rows of a table of motion: straight lines, or a spline with continuous acceleration.
enum class Interpolation { linear, cubic };

/// Prescribed motion of a wall: constant velocity, of the wall or of its surface, between start and stop, or a table of
/// displacement; and a turn about a pivot that is displaced with it.
struct Motion {
  Vec3d velocity{};                                       ///< [m/s]
  double start = 0;                                       ///< [s]
  double stop = std::numeric_limits<double>::infinity();  ///< [s]
  /// Alternatively, of a wall that stays where it is: velocity of its surface, as of a belt or a lid [m/s].
  Vec3d surface_velocity{};
  /// Alternatively: rows of (time [s], displacement [m] in x, y, z), held outside.
  std::vector<std::pair<double, Vec3d>> table;
  /// Turn about `axis` through `pivot`, right-handed: constant between start and stop [rad/s].
  double angular_velocity = 0;
  /// Alternatively: rows of (time [s], angle [rad]), held outside.
  std::vector<std::pair<double, double>> angle_table;
  Vec3d pivot{};                                        ///< at time zero [m]
  Vec3d axis{0, 0, 1};                                  ///< of unit length
  Interpolation interpolation = Interpolation::linear;  ///< of both tables

  [[nodiscard]] bool turns() const { return angular_velocity != 0 || !angle_table.empty(); }
  /// Whether the wall changes its place.
  [[nodiscard]] bool moves() const { return !table.empty() || velocity != Vec3d{} || turns(); }
};

/// A solid boundary: `tank` = the inside of a box, open on the sides listed in `open`; `box` = a solid box; or a solid
/// of another form.
struct Wall {
  enum class Kind { tank, box, cylinder, sphere, prism, stl };
  std::string name;
  Kind kind = Kind::box;
  BoxRegion region;  ///< inner faces of a tank, outer faces of a box, the box around another form [m]
  Form form;
  std::vector<std::string> open;  ///< of a tank: "x-", "x+", "y-", "y+", "z-", "z+"
  std::optional<Motion> motion;
  /// Whether the water slips along it where the fluid has a viscosity; unset: see docs/numerics.md.
  std::optional<bool> slip;
  bool forces = false;  ///< whether the water's force on it is recorded
  int line = 0;         ///< line of the scene file, for messages
};

/// Particles at the start, one a row of a file.
struct WaterTable {
  struct Row {
    Vec3d position{};     ///< [m]
    Vec3d velocity{};     ///< [m/s]
    double pressure = 0;  ///< [Pa]
    int line = 0;         ///< of the file, for messages
  };
  std::filesystem::path file;
  std::vector<Row> rows;
  bool has_velocity = false;
  bool has_pressure = false;
};

/// Water that fills a box or another form at the start, or particles from a table (all less what solids occupy).
struct Water {
  enum class Kind { box, table, cylinder, sphere, prism, stl };
  std::string name;
  Kind kind = Kind::box;
  /// [m]; of a box that is empty (zero thickness), no particles; of a table, the box that its particles fill; else
  /// around the form.
  BoxRegion region;
  WaterTable table;
  Form form;
  std::optional<Vec3d> fill_from;  ///< only what is connected with this place [m]
  Vec3d velocity{};                ///< initial [m/s]
  /// Level [m] along the direction against gravity from which the initial pressure is hydrostatic; the region's top if
  /// unset. Not for a table that has pressures.
  std::optional<double> level;
  int line = 0;
};

struct Gauge {
  std::string name;
  GaugeKind kind = GaugeKind::level;
  Vec3d position{};          ///< level: horizontal position of the column; pressure: the point; front: unused [m]
  Vec3d direction{1, 0, 0};  ///< front: direction in which the farthest connected water is sought
  int line = 0;
};

/// Rows of (time [s], discharge [m^3/s]), held outside.
struct Hydrograph {
  std::vector<std::pair<double, double>> rows;
};

enum class Direction { x_minus, x_plus, y_minus, y_plus, z_minus, z_plus };
[[nodiscard]] inline int axis_of(Direction direction) { return static_cast<int>(direction) / 2; }
[[nodiscard]] inline double sign_of(Direction direction) { return static_cast<int>(direction) % 2 == 0 ? -1 : 1; }

/// Velocity of an inflow over its height: uniform, the 1/7 power, or that of a laminar film.
enum class Profile { uniform, power, parabolic };

/// A zone at the end of the water through which it enters or leaves, or in which it is taken away.
struct Opening {
  enum class Kind { inflow, outflow, drain };
  std::string name;
  Kind kind = Kind::inflow;
  BoxRegion region;                         ///< [m]
  Direction direction = Direction::x_plus;  ///< of the flow
  std::optional<double> discharge;          ///< [m^3/s]
  Hydrograph hydrograph;                    ///< instead of the discharge
  std::optional<double> level;              ///< of the water [m]
  Profile profile = Profile::uniform;       ///< of an inflow
  int line = 0;

  /// [m^3/s]; zero where none is stated
  [[nodiscard]] double discharge_at(double time) const {
    const auto& rows = hydrograph.rows;
    if (rows.empty()) return discharge.value_or(0);
    const auto after =
        std::upper_bound(rows.begin(), rows.end(), time, [](double t, const auto& row) { return t < row.first; });
    if (after == rows.begin()) return rows.front().second;
    if (after == rows.end()) return rows.back().second;
    const auto before = std::prev(after);
    return std::lerp(before->second, after->second, (time - before->first) / (after->first - before->first));
  }
};

struct Sponge {
  std::string name;
  BoxRegion region;                         ///< [m]
  Direction direction = Direction::x_plus;  ///< in which the damping grows
  double damping_time = 0;                  ///< at the far end [s]; 0: from the region (core/sponges.hpp)
  Vec3d velocity{};                         ///< to which it damps [m/s]
  int line = 0;
};

struct Fluid {
  double density = 1000;           ///< [kg/m^3]
  double kinematic_viscosity = 0;  ///< [m^2/s]; 0 leaves the viscous term out
  Vec3d gravity{0, 0, -9.81};      ///< [m/s^2]; in 2-D {0, -9.81, 0}
  double central_force = 0;        ///< k of the acceleration -k (x - centre) [1/s^2]; 0 leaves it out
  Vec3d central_force_centre{};    ///< [m]
};

struct Numerics {
  double particle_distance = 0;  ///< l0 [m], required
  KernelKind kernel = KernelKind::wendland;
  double support = 0;          ///< r_e / l0; 0: the kernel's default
  double cfl = 0.5;            ///< of c0 + reference speed
  bool adaptive_step = false;  ///< shorter steps while something moves faster than expected
  Integrator integrator = Integrator::leapfrog;
  double sound_speed = 0;      ///< c0 [m/s]; 0: ten times the reference speed
  double reference_speed = 0;  ///< largest speed expected [m/s]; 0: from the hydraulic head and motions
  double artificial_viscosity = 0.01;
  /// delta' of notes: coefficient of c0 l0. None: 0.06, where particles are shifted 0.15 (docs/numerics.md).
  std::optional<double> density_diffusion;
  [[nodiscard]] double diffusion_coefficient() const {
    return density_diffusion.value_or(shifts(regularisation) ? 0.15 : 0.06);
  }
  Diffusion diffusion = Diffusion::dynamic;
  WallPressure wall_pressure = WallPressure::extrapolated;
  Regularisation regularisation = Regularisation::collision;
  double shifting = 1;              ///< strength
  double collision_distance = 0.9;  ///< in l0; 0 leaves the collision out
  double collision_restitution = 0.5;
  TurbulenceModel turbulence = TurbulenceModel::none;
  double smagorinsky = 0.12;         ///< coefficient Cs of the length Cs l0
  double skin = 0.25;                ///< of the neighbour list, in l0
  double rebalance_imbalance = 1.1;  ///< re-decompose when the largest rank has this times the mean work
};

struct Coupling {
  std::filesystem::path script;                  ///< LIGGGHTS input; empty: no solids
  std::map<std::string, std::string> variables;  ///< passed to the script as -var name value
  int steps_per_window = 1;
  Scheme scheme = Scheme::serial;
  Loads loads = Loads::reaction;
  bool predictor = true;
};

struct Output {
  double fields_every = 0;    ///< [s]; 0: only the start and the end
  double bodies_every = 0;    ///< [s]; 0: a 1500th of the run
  double gauges_every = 0;    ///< [s]; 0: a thousandth of the run
  double energies_every = 0;  ///< [s]; 0: a hundredth of the run
  bool fields = true;
  bool audit = false;            ///< check conservation every window (costs a reduction a window)
  double checkpoint_every = 0;   ///< simulated time [s]; 0: none
  double checkpoint_wall = 0;    ///< wall-clock time [s]; 0: none
  std::vector<double> pictures;  ///< times [s] of PNG snapshots
};

struct Scene {
  std::filesystem::path file;  ///< absolute path of the scene file
  std::string title;
  int dimension = 3;
  BoxRegion domain;  ///< particles that leave it end the run with status 3 [m]
  /// Directions, "x" "y" "z", in which what leaves the domain on one side enters on the other.
  std::vector<std::string> periodic;
  double thickness = 1;  ///< 2-D only: depth of the slice for loads on bodies [m]
  Fluid fluid;
  Numerics numerics;
  std::vector<Water> water;
  std::vector<Wall> walls;
  std::vector<Opening> openings;
  std::vector<Sponge> sponges;
  std::vector<Gauge> gauges;
  Coupling coupling;
  Output output;
  double end_time = 0;                       ///< [s]
  std::map<std::string, double> parameters;  ///< the scene's own parameters, after --set, in SI

  [[nodiscard]] bool coupled() const { return !coupling.script.empty(); }
  /// The axis that is closest to upright.
  [[nodiscard]] int upright() const {
    const Vec3d& g = fluid.gravity;
    int axis = dimension - 1;
    for (int c = 0; c < dimension; ++c) {
      if (std::abs(g[c]) > std::abs(g[axis])) axis = c;
    }
    return axis;
  }
  [[nodiscard]] bool is_periodic(int axis) const {
    return std::find(periodic.begin(), periodic.end(), std::string(1, "xyz"[axis])) != periodic.end();
  }
  /// The part of gravity that pressure can balance [m/s^2]: along a periodic direction it drives the water round.
  [[nodiscard]] Vec3d static_gravity() const {
    Vec3d result = fluid.gravity;
    for (int axis = 0; axis < 3; ++axis) {
      if (is_periodic(axis)) result[axis] = 0;
    }
    return result;
  }
};

}  // namespace embacle::mps
