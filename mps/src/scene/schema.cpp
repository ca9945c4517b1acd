#include "scene/schema.hpp"

namespace embacle::mps {
namespace {

constexpr Range positive{.lower = 0, .lower_open = true};
constexpr Range not_negative{.lower = 0};
constexpr Range between(double lower, double upper) { return {.lower = lower, .upper = upper}; }

/// Keys of the forms that walls and water can have, but for boxes.
template <class T>
void add_form(std::vector<Field<T>>& fields) {
  using Q = Quantity;
  const std::vector<Field<T>> keys{
      {{.name = "centre",
        .meaning = "middle of a cylinder or sphere (discs in 2-D)",
        .quantity = Q::length,
        .default_text = "none"},
       [](T& x) -> Target { return &x.form.centre; }},
      {{.name = "radius",
        .meaning = "of a cylinder or sphere",
        .quantity = Q::length,
        .range = positive,
        .default_text = "none"},
       [](T& x) -> Target { return &x.form.radius; }},
      {{.name = "length",
        .meaning = "of a cylinder along its axis, 3-D only",
        .quantity = Q::length,
        .range = positive,
        .default_text = "none"},
       [](T& x) -> Target { return &x.form.length; }},
      {{.name = "axis", .meaning = "direction of a cylinder or prism, 3-D only", .choices = {"x", "y", "z"}},
       [](T& x) -> Target { return &x.form.axis; }},
      {{.name = "polygon",
        .meaning = "corners of a prism, `[[0, 0], [1, 0], [1, \"20 cm\"]]`: x and y, or in 3-D the two coordinates "
                   "across its axis in the order x, y, z; it must not cross itself",
        .quantity = Q::length},
       [](T& x) -> Target { return &x.form.polygon; }},
      {{.name = "from",
        .meaning = "end of a prism along its axis, 3-D only",
        .quantity = Q::length,
        .default_text = "none"},
       [](T& x) -> Target { return &x.form.from; }},
      {{.name = "to", .meaning = "its other end", .quantity = Q::length, .default_text = "none"},
       [](T& x) -> Target { return &x.form.to; }},
      {{.name = "surface",
        .meaning =
            "of kind `stl`, 3-D only: file of a closed surface of triangles, STL in ASCII or binary, path relative "
            "to the scene file"},
       [](T& x) -> Target { return &x.form.surface; }},
      {{.name = "scale",
        .meaning = "of kind `stl`: factor from the lengths of the file to metres, 0.001 for millimetres",
        .range = positive},
       [](T& x) -> Target { return &x.form.scale; }},
  };
  fields.insert(fields.end(), keys.begin(), keys.end());
}

Schema make_schema() {
  using Q = Quantity;
  Schema s;
  s.root = {"",
            "Keys at the top of the file, before the first section.",
            {
                {{.name = "title", .meaning = "one line that says what the scene shows", .default_text = "none"},
                 [](Scene& x) -> Target { return &x.title; }},
                {{.name = "dimension",
                  .meaning = "number of space dimensions; in 2-D the plane is x-y, with y upwards",
                  .range = between(2, 3)},
                 [](Scene& x) -> Target { return &x.dimension; }},
            },
            {"parameters", "domain", "fluid", "numerics", "water", "wall", "opening", "sponge", "gauge", "coupling",
             "output", "run"}};
  s.domain = {
      "domain",
      "The box that holds everything. Water that leaves it ends the run with status 3, except where it is periodic.",
      {
          {{.name = "lower", .meaning = "lowest corner", .quantity = Q::length, .required = true},
           [](Scene& x) -> Target { return &x.domain.lower; }},
          {{.name = "upper", .meaning = "highest corner", .quantity = Q::length, .required = true},
           [](Scene& x) -> Target { return &x.domain.upper; }},
          {{.name = "periodic",
            .meaning = "directions in which water that leaves on one side enters on the other, and feels what is "
                       "there: for the time being without bodies. The domain's length there is a whole number "
                       "of particle distances; a tank is open there on both sides and as long as the domain; "
                       "gravity along it drives the water and makes no pressure",
            .choices = {"x", "y", "z"}},
           [](Scene& x) -> Target { return &x.periodic; }},
          {{.name = "thickness",
            .meaning = "2-D only: depth of the slice, to which loads on bodies refer",
            .quantity = Q::length,
            .range = positive},
           [](Scene& x) -> Target { return &x.thickness; }},
      },
      {}};
  s.fluid = {
      "fluid",
      "The liquid.",
      {
          {{.name = "density", .meaning = "density at rest", .quantity = Q::density, .range = positive},
           [](Fluid& x) -> Target { return &x.density; }},
          {{.name = "kinematic_viscosity",
            .meaning = "kinematic viscosity; 0 leaves the viscous term out (water at 20 °C: 1e-6 m2/s)",
            .quantity = Q::kinematic_viscosity,
            .range = not_negative},
           [](Fluid& x) -> Target { return &x.kinematic_viscosity; }},
          {{.name = "gravity",
            .meaning = "acceleration of gravity",
            .quantity = Q::acceleration,
            .default_text = "[0, 0, -9.81]; in 2-D [0, -9.81]"},
           [](Fluid& x) -> Target { return &x.gravity; }},
          {{.name = "central_force",
            .meaning = "k of an acceleration -k (x - `central_force_centre`) of the water beside gravity; 0 leaves "
                       "it out. The pressure at the start does not know of it: give it in a table",
            .quantity = Q::acceleration_per_length,
            .range = not_negative},
           [](Fluid& x) -> Target { return &x.central_force; }},
          {{.name = "central_force_centre", .meaning = "centre of that force", .quantity = Q::length},
           [](Fluid& x) -> Target { return &x.central_force_centre; }},
      },
      {}};
  s.numerics = {"numerics",
                "Resolution and the coefficients of the method. Only `particle_distance` has to be chosen. l0 is the "
                "particle distance.",
                {
                    {{.name = "particle_distance",
                      .meaning = "distance l0 of the particles at the start: the resolution",
                      .quantity = Q::length,
                      .range = positive,
                      .required = true},
                     [](Numerics& x) -> Target { return &x.particle_distance; }},
                    {{.name = "kernel", .meaning = "weight function", .choices = {"wendland", "rational"}},
                     [](Numerics& x) -> Target { return &x.kernel; }},
                    {{.name = "support",
                      .meaning = "radius of the kernel in l0; `wendland` from 2, `rational` up to 4",
                      .range = between(1.5, 5),
                      .default_text = "the kernel's own"},
                     [](Numerics& x) -> Target { return &x.support; }},
                    {{.name = "cfl",
                      .meaning = "Courant number: time step times (sound speed + reference speed) over l0",
                      .range = between(0.01, 2)},
                     [](Numerics& x) -> Target { return &x.cfl; }},
                    {{.name = "adaptive_step",
                      .meaning = "whether the time step becomes shorter while water or bodies are faster than the "
                                 "reference speed, or a blow accelerates the water; see docs/numerics.md"},
                     [](Numerics& x) -> Target { return &x.adaptive_step; }},
                    {{.name = "integrator",
                      .meaning = "`leapfrog`, or `symplectic`: every sweep twice a step; without solids, and "
                                 "without `shifting` and `continuity`; needs a `skin` of at least 0.1",
                      .choices = {"leapfrog", "symplectic"}},
                     [](Numerics& x) -> Target { return &x.integrator; }},
                    {{.name = "sound_speed",
                      .meaning = "numerical speed of sound; 0: ten times the reference speed",
                      .quantity = Q::speed,
                      .range = not_negative},
                     [](Numerics& x) -> Target { return &x.sound_speed; }},
                    {{.name = "reference_speed",
                      .meaning = "largest speed expected; 0: from the hydraulic head and the motions",
                      .quantity = Q::speed,
                      .range = not_negative},
                     [](Numerics& x) -> Target { return &x.reference_speed; }},
                    {{.name = "artificial_viscosity",
                      .meaning = "coefficient of the artificial viscosity",
                      .range = between(0, 1)},
                     [](Numerics& x) -> Target { return &x.artificial_viscosity; }},
                    {{.name = "density_diffusion",
                      .meaning = "coefficient of the density diffusion, in sound speed times l0; none: 0.06, with "
                                 "shifting 0.15",
                      .range = between(0, 1)},
                     [](Numerics& x) -> Target { return &x.density_diffusion; }},
                    {{.name = "diffusion",
                      .meaning = "what it acts on: the `dynamic` density, less its hydrostatic part, or `plain`",
                      .choices = {"dynamic", "plain"}},
                     [](Numerics& x) -> Target { return &x.diffusion; }},
                    {{.name = "wall_pressure",
                      .meaning = "pressure of walls and bodies: `extrapolated` from the water; its mean, "
                                 "`zero_gradient`; or by the `continuity` equation for their points, without "
                                 "solids",
                      .choices = {"extrapolated", "zero_gradient", "continuity"}},
                     [](Numerics& x) -> Target { return &x.wall_pressure; }},
                    {{.name = "regularisation",
                      .meaning = "what keeps the particles in order: `collision` of those that come too near, or "
                                 "`shifting` with corrected operators (and collisions), for internal flow; "
                                 "`plain_shifting`, the same with the plain operators; or `none`",
                      .choices = {"collision", "shifting", "plain_shifting", "none"}},
                     [](Numerics& x) -> Target { return &x.regularisation; }},
                    {{.name = "shifting",
                      .meaning = "strength of the shifting; needs one of the two kinds of it",
                      .range = between(0, 5)},
                     [](Numerics& x) -> Target { return &x.shifting; }},
                    {{.name = "collision_distance",
                      .meaning = "particles nearer than this, in l0, collide (with shifting: those near the free "
                                 "surface); 0 leaves the collision out",
                      .range = between(0, 1)},
                     [](Numerics& x) -> Target { return &x.collision_distance; }},
                    {{.name = "collision_restitution",
                      .meaning = "coefficient of restitution of these collisions; above 0.8 those that happen at once "
                                 "may gain energy",
                      .range = between(0, 0.8)},
                     [](Numerics& x) -> Target { return &x.collision_restitution; }},
                    {{.name = "turbulence",
                      .meaning = "eddy viscosity of what the particles do not resolve",
                      .choices = {"none", "smagorinsky"}},
                     [](Numerics& x) -> Target { return &x.turbulence; }},
                    {{.name = "smagorinsky",
                      .meaning = "its coefficient; needs `turbulence = \"smagorinsky\"`",
                      .range = between(0, 1)},
                     [](Numerics& x) -> Target { return &x.smagorinsky; }},
                    {{.name = "skin",
                      .meaning = "reserve of the neighbour list in l0: larger means rarer, but longer lists",
                      .range = between(0, 2)},
                     [](Numerics& x) -> Target { return &x.skin; }},
                    {{.name = "rebalance_imbalance",
                      .meaning = "share the particles out anew when the busiest rank has this times the mean work",
                      .range = between(1, 100)},
                     [](Numerics& x) -> Target { return &x.rebalance_imbalance; }},
                },
                {}};
  const Key name{
      .name = "name",
      .meaning = "its name, for messages, files and `--set`: letters, digits, _ and -; unique among its kind",
      .required = true,
      .label = true};
  s.water = {
      "water",
      "Water at the start, less what solids occupy: a box or another form that is filled, or particles from a table. "
      "Any "
      "number of them.",
      {
          {name, [](Water& x) -> Target { return &x.name; }},
          {{.name = "kind",
            .meaning = "`box`: the lattice of the particle distance between `lower` and `upper`; `table`: the "
                       "particles in `file`; the others: what of such a lattice lies in that form",
            .choices = {"box", "table", "cylinder", "sphere", "prism", "stl"}},
           [](Water& x) -> Target { return &x.kind; }},
          {{.name = "lower",
            .meaning = "lowest corner; required for a box",
            .quantity = Q::length,
            .default_text = "none"},
           [](Water& x) -> Target { return &x.region.lower; }},
          {{.name = "upper",
            .meaning = "highest corner; required for a box; one without volume is allowed and holds no water",
            .quantity = Q::length,
            .default_text = "none"},
           [](Water& x) -> Target { return &x.region.upper; }},
          {{.name = "file",
            .meaning = "required for a table: CSV file, path relative to the scene file, with a header line `x "
                       "[m], y [m], z [m], vx [m/s], vy [m/s], vz [m/s], p [Pa]` (in 2-D without z and vz; other "
                       "units are possible; the velocities, and the pressure, may be left out) and one row a "
                       "particle. Every particle has the mass of one particle distance cubed (in 2-D squared)",
            .default_text = "none"},
           [](Water& x) -> Target { return &x.table; }},
          {{.name = "fill_from",
            .meaning = "a place: only what is connected with it within the box or form, past no wall; for containers",
            .quantity = Q::length,
            .default_text = "none"},
           [](Water& x) -> Target { return &x.fill_from; }},
          {{.name = "velocity",
            .meaning = "velocity at the start, unless a table has velocities",
            .quantity = Q::speed},
           [](Water& x) -> Target { return &x.velocity; }},
          {{.name = "level",
            .meaning = "height of the water level against gravity, from which the first pressure is hydrostatic, "
                       "unless a table has pressures",
            .quantity = Q::length,
            .default_text = "top of the water"},
           [](Water& x) -> Target { return &x.level; }},
      },
      {},
      true};
  s.wall = {
      "wall",
      "A solid boundary. Any number of them.",
      {
          {name, [](Wall& x) -> Target { return &x.name; }},
          {{.name = "kind",
            .meaning = "`tank`: the water is inside of the box; `box`: the box is solid; likewise the others",
            .choices = {"tank", "box", "cylinder", "sphere", "prism", "stl"}},
           [](Wall& x) -> Target { return &x.kind; }},
          {{.name = "lower",
            .meaning = "lowest corner: of a tank's inner faces, of a box's outer faces; required for these",
            .quantity = Q::length,
            .default_text = "none"},
           [](Wall& x) -> Target { return &x.region.lower; }},
          {{.name = "upper", .meaning = "highest corner, likewise", .quantity = Q::length, .default_text = "none"},
           [](Wall& x) -> Target { return &x.region.upper; }},
          {{.name = "open",
            .meaning = "sides of a tank that have no wall",
            .choices = {"x-", "x+", "y-", "y+", "z-", "z+"}},
           [](Wall& x) -> Target { return &x.open; }},
          {{.name = "slip",
            .meaning = "whether the water slips along it; `false` needs a viscosity; see docs/numerics.md",
            .default_text = "mirrored velocities"},
           [](Wall& x) -> Target { return &x.slip; }},
          {{.name = "forces",
            .meaning =
                "whether force and torque of the water on it are recorded, in `structures/NAME.csv`, at the times "
                "of the gauges"},
           [](Wall& x) -> Target { return &x.forces; }},
      },
      {"motion"},
      true};
  add_form(s.water.fields);
  add_form(s.wall.fields);
  s.motion = {
      "wall.motion",
      "Prescribed motion of the wall it stands under: `velocity` or `table`, and `angular_velocity` or `angle_table`; "
      "or "
      "`surface_velocity` alone. A wall turns about its pivot, and the pivot is displaced. Water at the start fills "
      "the "
      "walls as they stand in the scene, before any motion.",
      {
          {{.name = "velocity",
            .meaning = "constant velocity between `start` and `stop`",
            .quantity = Q::speed,
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.velocity; }},
          {{.name = "start", .meaning = "when it starts to move", .quantity = Q::time, .range = not_negative},
           [](Motion& x) -> Target { return &x.start; }},
          {{.name = "stop",
            .meaning = "when it stops",
            .quantity = Q::time,
            .range = not_negative,
            .default_text = "never"},
           [](Motion& x) -> Target { return &x.stop; }},
          {{.name = "surface_velocity",
            .meaning = "constant velocity of its surface between `start` and `stop`, as of a belt or a lid: the wall "
                       "stays where it is and drags the water along by the viscosity, without slip",
            .quantity = Q::speed,
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.surface_velocity; }},
          {{.name = "table",
            .meaning = "CSV file of the displacement over time, path relative to the scene file: a header line "
                       "`t [s], x [m], y [m], z [m]` (in 2-D without z) and rows of rising time; held before and after",
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.table; }},
          {{.name = "angular_velocity",
            .meaning = "constant turn about `pivot` between `start` and `stop`, anticlockwise seen against the axis",
            .quantity = Q::angular_speed,
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.angular_velocity; }},
          {{.name = "angle_table",
            .meaning = "CSV file of the angle of turn over time, path relative to the scene file: a header line "
                       "`t [s], angle [rad]` (or `[deg]`) and rows of rising time; held before and after",
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.angle_table; }},
          {{.name = "pivot",
            .meaning = "a place on the axis about which the wall turns, before any motion; required for a turn",
            .quantity = Q::length,
            .default_text = "none"},
           [](Motion& x) -> Target { return &x.pivot; }},
          {{.name = "axis",
            .meaning = "direction of that axis, of any length but zero; 3-D only",
            .default_text = "[0, 0, 1]"},
           [](Motion& x) -> Target { return &x.axis; }},
          {{.name = "interpolation",
            .meaning = "between the rows of the tables: `linear`, or `cubic`, a spline that begins and ends at rest, "
                       "whose acceleration the water feels; take it for waves and sloshing",
            .choices = {"linear", "cubic"}},
           [](Motion& x) -> Target { return &x.interpolation; }},
      },
      {}};
  s.opening = {
      "opening",
      "A place where water enters or leaves (docs/open-boundaries.md). Any number of them; with `regularisation` other "
      "than shifting, the leapfrog, and no periodic direction along the flow.",
      {
          {name, [](Opening& x) -> Target { return &x.name; }},
          {{.name = "kind",
            .meaning = "`inflow`: water enters in the zone and leaves it into the reach; `outflow`: it enters the zone "
                       "from the reach and is taken away at its end; `drain`: it is taken away anywhere in the box, "
                       "as behind a weir",
            .choices = {"inflow", "outflow", "drain"},
            .required = true},
           [](Opening& x) -> Target { return &x.kind; }},
          {{.name = "direction",
            .meaning = "of the flow, level; not for a drain",
            .choices = {"-x", "+x", "-y", "+y", "-z", "+z"},
            .default_text = "none"},
           [](Opening& x) -> Target { return &x.direction; }},
          {{.name = "lower",
            .meaning = "lowest corner of the zone. Along the flow it is at least the support and one particle "
                       "distance long; across the flow and in height it holds all that passes",
            .quantity = Q::length,
            .required = true},
           [](Opening& x) -> Target { return &x.region.lower; }},
          {{.name = "upper", .meaning = "highest corner", .quantity = Q::length, .required = true},
           [](Opening& x) -> Target { return &x.region.upper; }},
          {{.name = "discharge",
            .meaning = "of an inflow: what enters (in 2-D through the domain's thickness). Of an outflow: what it lets "
                       "out when the water is at its level; without one, what keeps the water at that level in the "
                       "long run",
            .quantity = Q::discharge,
            .range = not_negative,
            .default_text = "none"},
           [](Opening& x) -> Target { return &x.discharge; }},
          {{.name = "hydrograph",
            .meaning = "instead: CSV file of the discharge over time, path relative to the scene file: a header line "
                       "`t [s], discharge [m3/s]` (or `[l/s]`) and rows of rising time; held before and after",
            .default_text = "none"},
           [](Opening& x) -> Target { return &x.hydrograph; }},
          {{.name = "level",
            .meaning = "height of the water; required for an outflow. Of an inflow without one it follows the water "
                       "in the reach",
            .quantity = Q::length,
            .default_text = "none"},
           [](Opening& x) -> Target { return &x.level; }},
          {{.name = "profile",
            .meaning = "velocity of an inflow over the height above the bed: `uniform`, `power` (1/7) or `parabolic`, "
                       "as of a laminar film",
            .choices = {"uniform", "power", "parabolic"}},
           [](Opening& x) -> Target { return &x.profile; }},
      },
      {},
      true};
  s.sponge = {
      "sponge",
      "A place where waves die out, before a wall or an outflow (docs/open-boundaries.md). Any number of them.",
      {
          {name, [](Sponge& x) -> Target { return &x.name; }},
          {{.name = "lower", .meaning = "lowest corner of the zone", .quantity = Q::length, .required = true},
           [](Sponge& x) -> Target { return &x.region.lower; }},
          {{.name = "upper", .meaning = "highest corner", .quantity = Q::length, .required = true},
           [](Sponge& x) -> Target { return &x.region.upper; }},
          {{.name = "direction",
            .meaning = "level, in which waves enter; the damping rises along it with the square of the way",
            .choices = {"-x", "+x", "-y", "+y", "-z", "+z"},
            .required = true},
           [](Sponge& x) -> Target { return &x.direction; }},
          {{.name = "damping_time",
            .meaning = "time in which a velocity falls to 1/e of itself at the far end",
            .quantity = Q::time,
            .range = not_negative,
            .default_text = "a twelfth of the time that a long wave in water as deep as the zone is high needs through "
                            "it: 2 % of its height come back"},
           [](Sponge& x) -> Target { return &x.damping_time; }},
          {{.name = "velocity", .meaning = "to which the water is damped, as that of a river", .quantity = Q::speed},
           [](Sponge& x) -> Target { return &x.velocity; }},
      },
      {},
      true};
  s.gauge = {
      "gauge",
      "A place where the water is recorded over time, in `gauges/NAME.csv`. Any number of them.",
      {
          {name, [](Gauge& x) -> Target { return &x.name; }},
          {{.name = "kind",
            .meaning = "`level`: height of the water in the column at `position`; `pressure`: pressure at `position`; "
                       "`front`: farthest connected water along `direction`",
            .choices = {"level", "pressure", "front"}},
           [](Gauge& x) -> Target { return &x.kind; }},
          {{.name = "position",
            .meaning = "point of the gauge; required except for `front`, which has none",
            .quantity = Q::length,
            .default_text = "none"},
           [](Gauge& x) -> Target { return &x.position; }},
          {{.name = "direction", .meaning = "of a `front` only: where it runs to; of any length but zero"},
           [](Gauge& x) -> Target { return &x.direction; }},
      },
      {},
      true};
  s.coupling = {
      "coupling",
      "The solids. Without this section the scene has none, and LIGGGHTS is not needed.",
      {
          {{.name = "script", .meaning = "LIGGGHTS input script, path relative to the scene file", .required = true},
           [](Coupling& x) -> Target { return &x.script; }},
          {{.name = "steps_per_window",
            .meaning = "fluid steps between two exchanges with the solids",
            .range = between(1, 10000)},
           [](Coupling& x) -> Target { return &x.steps_per_window; }},
          {{.name = "scheme",
            .meaning =
                "`serial`: fluid and solids take turns; `parallel`: they work at the same time, one window apart",
            .choices = {"serial", "parallel"}},
           [](Coupling& x) -> Target { return &x.scheme; }},
          {{.name = "loads",
            .meaning =
                "of the water on bodies: the exact `reaction`, or the sum of `pressure` times area and normal over "
                "their surface, which does not conserve momentum",
            .choices = {"reaction", "pressure"}},
           [](Coupling& x) -> Target { return &x.loads; }},
          {{.name = "predictor", .meaning = "the fluid predicts the bodies' motion within a window"},
           [](Coupling& x) -> Target { return &x.predictor; }},
      },
      {"variables"}};
  s.output = {"output",
              "What is written, and how often.",
              {
                  {{.name = "fields_every",
                    .meaning = "interval of the particle fields; 0: only the start and the end",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.fields_every; }},
                  {{.name = "bodies_every",
                    .meaning = "interval of `bodies.csv`; 0: a 1500th of the run",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.bodies_every; }},
                  {{.name = "gauges_every",
                    .meaning = "interval of the gauges; 0: a thousandth of the run",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.gauges_every; }},
                  {{.name = "energies_every",
                    .meaning = "interval of the energies; 0: a hundredth of the run",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.energies_every; }},
                  {{.name = "fields", .meaning = "whether particle fields are written at all"},
                   [](Output& x) -> Target { return &x.fields; }},
                  {{.name = "audit",
                    .meaning = "check conservation in every window, count what walls store (a reduction and a sweep)"},
                   [](Output& x) -> Target { return &x.audit; }},
                  {{.name = "checkpoint_every",
                    .meaning = "interval of the checkpoints in simulated time; 0: none",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.checkpoint_every; }},
                  {{.name = "checkpoint_wall",
                    .meaning = "the same in wall-clock time; both may be given",
                    .quantity = Q::time,
                    .range = not_negative},
                   [](Output& x) -> Target { return &x.checkpoint_wall; }},
                  {{.name = "pictures", .meaning = "times of PNG pictures", .quantity = Q::time, .range = not_negative},
                   [](Output& x) -> Target { return &x.pictures; }},
              },
              {}};
  s.run = {"run",
           "How long.",
           {{{.name = "end_time",
              .meaning = "simulated time at which the run ends",
              .quantity = Q::time,
              .range = positive,
              .required = true},
             [](Scene& x) -> Target { return &x.end_time; }}},
           {}};
  return s;
}

}  // namespace

const Schema& schema() {
  static const Schema instance = make_schema();
  return instance;
}

}  // namespace embacle::mps
