#include "handshake.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace embacle::coupling {

namespace {

void write(Writer& out, const FluidTerms& terms) {
  out.put(terms.gravity);
  out.put(terms.dimension);
  out.put(terms.scheme);
  out.put(terms.particle_distance);
  out.put(terms.point_depth);
  out.put(terms.reach);
  out.put(terms.reference_speed);
  out.put(terms.fluid_density);
  out.put(terms.windows_before);
}

void read(Reader& in, FluidTerms& terms) {
  in.get(terms.gravity);
  in.get(terms.dimension);
  in.get(terms.scheme);
  in.get(terms.particle_distance);
  in.get(terms.point_depth);
  in.get(terms.reach);
  in.get(terms.reference_speed);
  in.get(terms.fluid_density);
  in.get(terms.windows_before);
}

void write(Writer& out, const SolidTerms& terms) {
  out.put(terms.gravity);
  out.put(terms.units);
  out.put(terms.domain);
  out.put(terms.surface_pressure_every);
  out.put(static_cast<std::uint64_t>(terms.shapes.size()));
  for (const Shape& shape : terms.shapes) {
    out.put(shape.name);
    out.put(shape.kind);
    out.put(shape.size);
    out.put(shape.density);
    if (!shape.polyhedron) continue;
    std::vector<Vec3> corners, polygon;
    for (const Triangle& triangle : shape.polyhedron->surface.triangles()) {
      corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
    for (const auto& corner : shape.polyhedron->polygon) polygon.emplace_back(corner.x(), corner.y(), 0.0);
    out.put(corners);
    out.put(polygon);
  }
}

void read(Reader& in, SolidTerms& terms) {
  in.get(terms.gravity);
  in.get(terms.units);
  in.get(terms.domain);
  in.get(terms.surface_pressure_every);
  terms.shapes.resize(in.get<std::uint64_t>());
  for (Shape& shape : terms.shapes) {
    in.get(shape.name);
    in.get(shape.kind);
    in.get(shape.size);
    in.get(shape.density);
    if (shape.kind != ShapeKind::prism && shape.kind != ShapeKind::surface) continue;
    std::vector<Triangle> triangles;
    std::vector<Eigen::Vector2d> polygon;
    const auto corners = in.get<std::vector<Vec3>>();
    for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
      triangles.push_back({corners[k], corners[k + 1], corners[k + 2]});
    }
    for (const Vec3& corner : in.get<std::vector<Vec3>>()) polygon.emplace_back(corner.head<2>());
    shape.polyhedron = make_polyhedron(std::move(triangles), std::move(polygon));
  }
}

/// FNV-1a, 64 bits.
std::uint64_t hash(const Bytes& bytes) {
  std::uint64_t value = 14695981039346656037ULL;
  for (const std::byte byte : bytes) value = (value ^ static_cast<std::uint64_t>(byte)) * 1099511628211ULL;
  return value;
}

std::string text(const Vec3& v) { return fmt::format("({}, {}, {})", v.x(), v.y(), v.z()); }

std::string reasons_against(const Shape& shape) {
  const int lengths = shape.kind == ShapeKind::sphere ? 1 : shape.kind == ShapeKind::cylinder ? 2 : 3;
  for (int i = 0; i < lengths; ++i) {
    if (!(shape.size[i] > 0) || !std::isfinite(shape.size[i])) {
      return fmt::format("shape '{}' has the size {} m; every length must be > 0", shape.name, text(shape.size));
    }
  }
  if (!(shape.density > 0) || !std::isfinite(shape.density)) {
    return fmt::format("shape '{}' has the density {} kg/m3; it must be > 0", shape.name, shape.density);
  }
  return {};
}

/// Everything that keeps the two sides from working together; the same text on every rank of both sides.
std::vector<std::string> mismatches(const FluidTerms& fluid, const SolidTerms& solid) {
  std::vector<std::string> found;
  if (solid.units != "si") {
    found.push_back(fmt::format(
        "units differ: the water uses si, the solids use {}; set 'units si' in the solids' script", solid.units));
  }
  const double scale = std::max(fluid.gravity.norm(), solid.gravity.norm());
  if (!((fluid.gravity - solid.gravity).norm() <= 1e-6 * scale)) {
    found.push_back(fmt::format(
        "gravity differs: the water has {}, the solids have {} m/s2; set 'fix gravity' in the solids' script "
        "or fluid.gravity in the scene alike",
        text(fluid.gravity), text(solid.gravity)));
  }
  if (fluid.dimension != 2 && fluid.dimension != 3) {
    found.push_back(fmt::format("the water has {} dimensions; 2 or 3 are possible", fluid.dimension));
  }
  if (!(fluid.particle_distance > 0) || !(fluid.reach >= 0) || !(fluid.reference_speed >= 0)) {
    found.push_back(
        fmt::format("the water states a particle distance of {} m, a reach of {} m and a reference speed of {} "
                    "m/s; the first must be > 0, the others >= 0",
                    fluid.particle_distance, fluid.reach, fluid.reference_speed));
  }
  if (solid.surface_pressure_every < 0) {
    found.push_back(fmt::format("the solids ask for surface pressures every {} windows; 0 (never) or more is possible",
                                solid.surface_pressure_every));
  }
  std::set<std::string> names;
  for (const Shape& shape : solid.shapes) {
    if (std::string reason = reasons_against(shape); !reason.empty()) found.push_back(std::move(reason));
    if (!names.insert(shape.name).second) found.push_back(fmt::format("two shapes are called '{}'", shape.name));
  }
  return found;
}

void accept(const FluidTerms& fluid, bool fluid_agrees, const SolidTerms& solid, bool solid_agrees) {
  std::vector<std::string> reasons;
  if (!fluid_agrees) reasons.emplace_back("the ranks of the water were started with different scenes");
  if (!solid_agrees) reasons.emplace_back("the ranks of the solids were started with different scripts");
  if (reasons.empty()) reasons = mismatches(fluid, solid);
  if (!reasons.empty()) {
    throw InputError(fmt::format("the water and the solids do not fit together: {}", fmt::join(reasons, "; ")));
  }
}

/// What the other side's root states, on every rank of this side.
template <typename Theirs, typename Mine>
Theirs exchange(const Mine& mine, const Participants& participants, Side& side, Waiter& waiter, int other_root,
                int my_tag, int their_tag, bool& mine_agree, bool& theirs_agree) {
  Outbox outbox;
  Bytes& statement = outbox.prepare(1, waiter).front();
  Writer out(statement);
  write(out, mine);
  mine_agree = side.agree(hash(statement));
  out.put(mine_agree);

  Bytes answer;
  if (side.is_root()) {
    outbox.send(0, other_root, my_tag, participants.world);
    waiter.until([&] { return receive_if_there(participants.world, other_root, their_tag, answer); });
    waiter.until([&] { return outbox.completed(); });
  }
  side.broadcast(answer);
  Reader in(answer);
  Theirs theirs;
  read(in, theirs);
  in.get(theirs_agree);
  return theirs;
}

}  // namespace

SolidTerms shake_hands(const FluidTerms& mine, const Participants& participants, Side& side, Waiter& waiter) {
  bool fluid_agrees = false;
  bool solid_agrees = false;
  SolidTerms theirs = exchange<SolidTerms>(mine, participants, side, waiter, participants.solid_ranks.front(),
                                           tag_fluid_terms, tag_solid_terms, fluid_agrees, solid_agrees);
  accept(mine, fluid_agrees, theirs, solid_agrees);
  return theirs;
}

FluidTerms shake_hands(const SolidTerms& mine, const Participants& participants, Side& side, Waiter& waiter) {
  bool fluid_agrees = false;
  bool solid_agrees = false;
  FluidTerms theirs = exchange<FluidTerms>(mine, participants, side, waiter, participants.fluid_ranks.front(),
                                           tag_solid_terms, tag_fluid_terms, solid_agrees, fluid_agrees);
  accept(theirs, fluid_agrees, mine, solid_agrees);
  return theirs;
}

}  // namespace embacle::coupling
