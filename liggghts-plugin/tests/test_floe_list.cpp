// Reading and checking descriptions of bodies, without LIGGGHTS.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>

#include "contact_outlook.hpp"
#include "floe_checks.hpp"
#include "floe_file.hpp"
#include "floe_list.hpp"
#include "floe_schedule.hpp"
#include "template_file.hpp"

namespace embacle::liggghts {
namespace {

using coupling::InputError;
using coupling::Vec3;

FloeList read(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  FloeList list = read_floe_list("fix floes floe/create", words, 2);
  for (FloeShape& shape : list.shapes) shape.cover();
  return list;
}

/// The message of the InputError that `action` must throw.
template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

void expect_parts(const std::string& message, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks: " << part;
}

TEST(FloeList, ReadsShapesAndBodies) {
  const FloeList list = read(
      "shape box 0.2 0.1 0.05 density 900 spacing 0.02 atom_type 2 position 1 2 3 rotate 0 0 2 90 velocity 4 5 6 "
      "position 0 0 0 omega 7 8 9 shape cylinder 0.1 0.3 mass 5 spacing 0.05 position 2 0 0 quaternion 0 1 0 0");
  ASSERT_EQ(list.shapes.size(), 2U);
  ASSERT_EQ(list.floes.size(), 3U);
  EXPECT_EQ(list.shapes[0].atom_type, 2);
  EXPECT_DOUBLE_EQ(list.shapes[1].shape.mass_properties().mass, 5.0);
  EXPECT_TRUE(list.floes[0].state.position.isApprox(Vec3(1, 2, 3)));
  EXPECT_LT((list.floes[0].state.orientation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_TRUE(list.floes[0].state.velocity.isApprox(Vec3(4, 5, 6)));
  EXPECT_TRUE(list.floes[1].state.angular_velocity.isApprox(Vec3(7, 8, 9)));
  EXPECT_EQ(list.floes[2].shape, 1);
  EXPECT_LT((list.floes[2].state.orientation * Vec3::UnitZ() + Vec3::UnitZ()).norm(), 1e-15);
}

TEST(FloeList, NamesTheMistake) {
  const std::string box = "shape box 1 1 1 density 900 spacing 0.1 ";
  expect_parts(message_of([&] { read(box + "positon 0 0 0"); }),
               {"'positon'", "did you mean 'position'", "quaternion"});
  expect_parts(message_of([&] { read("shape box 1 -1 1"); }), {"along y", "greater than zero", "-1"});
  expect_parts(message_of([&] { read("shape box 1 1 1 density 0"); }), {"density", "greater than zero"});
  expect_parts(message_of([&] { read(box + "position 0 0"); }), {"z component", "missing"});
  expect_parts(message_of([&] { read(box + "position 0 0 1.5x"); }), {"'1.5x'", "number"});
  expect_parts(message_of([&] { read(box + "position 0 0 nan"); }), {"'nan'"});
  expect_parts(message_of([&] { read("shape box 1 1 1 spacing 0.1 position 0 0 0"); }), {"'density'", "'mass'"});
  expect_parts(message_of([&] { read("shape box 1 1 1 density 900 position 0 0 0"); }), {"'spacing'"});
  expect_parts(message_of([&] { read(box + "atom_type 3 position 0 0 0"); }), {"atom_type 3", "2 type"});
  expect_parts(message_of([&] { read(box + "velocity 1 0 0"); }), {"'velocity' must come after 'position'"});
  expect_parts(message_of([&] { read(box + "position 0 0 0 density 800"); }), {"before its first body"});
  expect_parts(message_of([&] { read(box + "position 0 0 0 quaternion 1 1 0 0"); }), {"norm"});
  expect_parts(message_of([&] { read(box); }), {"no bodies"});
  expect_parts(message_of([&] { read("shape boks 1 1 1"); }), {"did you mean 'box'", "sphere", "cylinder"});
}

const std::string wedge = "shape prism 0.2 3 0 0 0.6 0 0 0.4 ";

TEST(FloeList, ReadsDiscsAndPrismsAndCounts) {
  const FloeList list =
      read("shape disc 0.3 0.1 density 900 spacing 0.1 position 0 0 0 " + wedge +
           "mass 10 spheres 12 position 1 0 0 rotate 0 0 1 90 position 2 0 0 quaternion 0 1 0 0 verbose yes");
  ASSERT_EQ(list.shapes.size(), 2U);
  EXPECT_TRUE(list.verbose);
  EXPECT_EQ(list.shapes[0].shape.kind, coupling::ShapeKind::cylinder);
  EXPECT_EQ(list.shapes[0].shape.size, Vec3(0.3, 0.1, 0));
  const coupling::Shape& prism = list.shapes[1].shape;
  EXPECT_EQ(list.shapes[1].spheres.size(), 12U);
  EXPECT_DOUBLE_EQ(prism.mass_properties().mass, 10);
  // Orientations are those of the frame in which the polygon was given: its first edge points along x there.
  const Vec3 along = prism.given_axes.conjugate() * Vec3::UnitX();  // in the body frame
  EXPECT_GT((along - Vec3::UnitX()).norm(), 0.1);                   // the principal axes are others
  EXPECT_LT((list.floes[1].state.orientation * along - Vec3::UnitY()).norm(), 1e-14);
  EXPECT_LT((list.floes[2].state.orientation * along - Vec3::UnitX()).norm(), 1e-14);
  const std::string report = covering_report(list.shapes[1]);
  expect_parts(report, {"prism of 3 corners", "volume 0.024 m3, mass 10 kg",
                        "centre of mass as given: 0.2 0.133333 0 m", "12 covering spheres", "outside the shape 0 %"});
}

TEST(FloeList, NamesMistakesInShapes) {
  const std::string rest = " density 900 spacing 0.1 position 0 0 0";
  expect_parts(message_of([&] { read("shape prism 0.2 2 0 0 1 0" + rest); }),
               {"corners of the prism", "at least 3", "'2'"});
  expect_parts(message_of([&] { read("shape prism 0.2 4 0 0 1 1 1 0 0 1" + rest); }),
               {"corner 1 to 2 meets", "3 to 4"});
  expect_parts(message_of([&] { read("shape prism 0.2 3 0 0 1 0 0" + rest); }), {"y [m] of corner 3", "'density'"});
  expect_parts(message_of([&] { read("shape prism 0 3 0 0 1 0 0 1" + rest); }), {"length [m] of the prism"});
  expect_parts(message_of([&] { read("shape disc 1" + rest); }), {"thickness [m] of the disc"});
  expect_parts(message_of([&] { read("shape stl /no/such.stl" + rest); }), {"fix floes", "STL file '/no/such.stl'"});
  expect_parts(message_of([&] { read(wedge + "scale 2" + rest); }), {"'scale' belongs to 'shape stl'"});
  expect_parts(message_of([&] { read(wedge + "density 900 spheres 0 position 0 0 0"); }), {"spheres", "'0'"});
  expect_parts(message_of([&] { read(wedge + "density 900 position 0 0 0"); }), {"'spacing'", "'spheres'"});
  expect_parts(message_of([&] { read(wedge + "sphere_radius 0.2" + rest); }),
               {"largest sphere inside (0.1 m)", "0.2 m"});
  expect_parts(message_of([&] { read("shape box 1 1 0.1 density 900 spheres 3 position 0 0 0"); }),
               {"at least 4 spheres"});
  expect_parts(message_of([&] { read("spheres 5"); }), {"'spheres' must come after 'shape'"});
  expect_parts(message_of([&] { read(wedge + rest + " verbose perhaps"); }), {"'perhaps'", "yes, no"});
}

class SolidFile : public testing::Test {
 protected:
  void SetUp() override {
    // A right tetrahedron with legs of 300, 200 and 100 mm.
    const double p[4][3] = {{0, 0, 0}, {300, 0, 0}, {0, 200, 0}, {0, 0, 100}};
    std::ofstream file(path_);
    file << "solid t\n";
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (const int k : {a, b, c}) file << "vertex " << p[k][0] << ' ' << p[k][1] << ' ' << p[k][2] << '\n';
      file << "endloop\nendfacet\n";
    }
    file << "endsolid t\n";
  }
  void TearDown() override { std::remove(path_.c_str()); }
  std::string path_ = testing::TempDir() + "embacle-solid.stl";
};

TEST_F(SolidFile, IsScaledAndHasTheExactMass) {
  const FloeList list = read("shape stl " + path_ + " scale 0.001 density 900 spheres 20 position 0 0 0 " +
                             "shape stl " + path_ + " scale 0.001 mass 2 spacing 0.03 position 1 0 0");
  ASSERT_EQ(list.shapes.size(), 2U);
  EXPECT_NEAR(list.shapes[0].shape.mass_properties().mass, 900 * 0.001, 1e-15);
  EXPECT_NEAR(list.shapes[1].shape.mass_properties().mass, 2, 1e-14);
  EXPECT_LT((list.shapes[0].shape.given_centre - Vec3(0.075, 0.05, 0.025)).norm(), 1e-15);
  EXPECT_EQ(list.shapes[0].spheres.size(), 20U);
}

TEST_F(SolidFile, MistakesNameFileAndLine) {
  const auto edit = [&](const std::string& from, const std::string& to) {
    std::ifstream in(path_);
    std::string text{std::istreambuf_iterator<char>(in), {}};
    text.replace(text.find(from), from.size(), to);
    std::ofstream(path_) << text;
  };
  edit("vertex 300 0 0", "vertex 3OO 0 0");
  expect_parts(message_of([&] { read("shape stl " + path_ + " density 900 spheres 20 position 0 0 0"); }),
               {"fix floes floe/create: " + path_ + ":6: '3OO' is not a number"});
  edit("vertex 3OO 0 0", "vertex 301 0 0");
  expect_parts(message_of([&] { read("shape stl " + path_ + " density 900 spheres 20 position 0 0 0"); }),
               {path_ + ":", "has no neighbour", "closed surfaces"});
}

TEST(Template, StatesTheExactBody) {
  const auto words = [](const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> result;
    for (std::string word; stream >> word;) result.push_back(word);
    return result;
  };
  const TemplateFile file = read_template(words("floe " + wedge + "density 900 spheres 12 id pts type 3 atom_type 2"));
  const auto mass = file.shape.shape.mass_properties();
  std::istringstream spheres(spheres_text(file));
  Vec3 place;
  double radius = 0;
  std::size_t lines = 0;
  while (spheres >> place.x() >> place.y() >> place.z() >> radius) {
    EXPECT_EQ(place, file.shape.spheres.at(lines).centre);
    EXPECT_EQ(radius, file.shape.spheres.at(lines).radius);
    ++lines;
  }
  EXPECT_EQ(lines, 12U);
  expect_parts(command_text(file),
               {"fix pts all particletemplate/multisphere", "atom_type 2 density constant 900", "nspheres 12",
                "spheres file floe.spheres scale 1.0 type 3", fmt::format("mass {:.17g}", mass.mass),
                fmt::format("inertia_tensor {:.17g} 0 0 {:.17g} 0 {:.17g} use_density", mass.inertia.x(),
                            mass.inertia.y(), mass.inertia.z())});
  expect_parts(message_of([&] { read_template({}); }), {"name of the files"});
  expect_parts(message_of([&] { read_template(words("floe " + wedge)); }), {"'density'", "the template"});
  expect_parts(message_of([&] { read_template(words("floe " + wedge + "density 1 spheres 9 tipe 2")); }),
               {"'tipe'", "did you mean 'type'"});
  expect_parts(message_of([&] { read_template(words("floe shape sphere 1 density 1")); }), {"single sphere"});
  expect_parts(message_of([&] { read_template(words("floe " + wedge + "density 1 spheres 9 seed 7")); }),
               {"seed", "10001"});
  expect_parts(message_of([&] { read_template(words("floe " + wedge + "density 1 spheres 9 seed 10011")); }),
               {"10011 is none"});
  EXPECT_NE(file.seed, read_template(words("floe " + wedge + "density 900 spheres 12")).seed);  // another type
}

class FloeFile : public testing::Test {
 protected:
  void write(const std::string& text) { std::ofstream(path_) << text; }
  void TearDown() override { std::remove(path_.c_str()); }
  std::string path_ = testing::TempDir() + "embacle-floes.csv";
};

TEST_F(FloeFile, ReadsColumnsInAnyOrder) {
  write(
      "# an ice field\nz [m],x,y,lx,ly,lz,mass "
      "[kg],vx,vy,vz\n3,1,2,0.5,0.4,0.1,18,0.1,0,0\n\n6,4,5,0.5,0.4,0.1,9,0,0,0\n");
  const auto rows = read_floe_file(path_);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_TRUE(rows[0].state.position.isApprox(Vec3(1, 2, 3)));
  EXPECT_EQ(rows[1].origin, path_ + ":5");
  const FloeList list = read("shape box 1 1 1 density 900 spacing 0.05 file " + path_);
  ASSERT_EQ(list.shapes.size(), 2U);  // the same size, but not the same density
  EXPECT_DOUBLE_EQ(list.shapes[0].shape.mass_properties().mass, 18);
  EXPECT_DOUBLE_EQ(list.shapes[1].shape.mass_properties().mass, 9);
}

TEST_F(FloeFile, NamesFileAndLine) {
  const auto message = [&](const std::string& text) {
    write(text);
    return message_of([&] { read_floe_file(path_); });
  };
  expect_parts(message("x,y,z\n1,2,3\n1,2,oops\n"), {path_ + ":3", "'oops'", "'z'"});
  expect_parts(message("x,y,z\n1,2\n"), {path_ + ":2", "2 values", "3 columns"});
  expect_parts(message("x,y,z\n1,2,\n"), {path_ + ":2", "'z'"});
  expect_parts(message("x,y,zz\n"), {path_ + ":1", "'zz'", "did you mean"});
  expect_parts(message("x,y\n"), {path_ + ":1", "'z' is missing"});
  expect_parts(message("x [mm],y,z\n"), {path_ + ":1", "in m, not in mm"});
  expect_parts(message("x,y,z,x\n"), {"appears twice"});
  expect_parts(message("x,y,z,qw,qx,qy\n"), {"'qz' is missing"});
  expect_parts(message("x,y,z,lx,ly,lz\n0,0,0,1,0,1\n"), {path_ + ":2", "'ly'", "greater than zero"});
  expect_parts(message("x,y,z\n"), {"no bodies"});
  expect_parts(message_of([] { read_floe_file("/no/such/file.csv"); }), {"/no/such/file.csv"});
}

TEST_F(FloeFile, OutlinesAreTheirOwnPrisms) {
  const std::string head = "t [s], x, y, z, outline [m], thickness [m], density\n";
  write(head +
        "2, 0, 0, 1, 0 0 0.4 0 0.4 0.2 0 0.2, 0.1, 900\n1, 1, 0, 1, 0 0 0.4 0 0.4 0.2 0 0.2, 0.1, 900\n"
        "1, 2, 0, 1, 0 0 0.3 0 0 0.3, 0.2, 900\n");
  const FloeList list = read("shape box 1 1 1 density 1 spacing 0.1 file " + path_ + " repeat 5");
  ASSERT_EQ(list.shapes.size(), 2U) << "equal floes are one shape";
  EXPECT_NEAR(list.shapes[0].shape.mass_properties().mass, 900 * 0.4 * 0.2 * 0.1, 1e-12);
  EXPECT_NEAR(list.shapes[1].shape.mass_properties().mass, 900 * 0.045 * 0.2, 1e-12);
  EXPECT_TRUE(list.floes[0].state.position.isApprox(Vec3(0, 0, 1))) << "the place of the centre of mass";
  EXPECT_EQ(list.floes[0].enters, 2);
  EXPECT_EQ(list.repeat, 5);
  write("x, y, z, outline, thickness, mass\n0, 0, 1, 0 0 0.4 0 0.4 0.2, 0.1, 7\n");
  const FloeList heavy = read("shape box 1 1 1 spacing 0.1 file " + path_);
  EXPECT_NEAR(heavy.shapes[0].shape.mass_properties().mass, 7, 1e-12);
  EXPECT_FALSE(heavy.floes[0].enters);

  const auto message = [&](const std::string& text, const std::string& more = "") {
    write(text);
    return message_of([&] { read("shape box 1 1 1 density 1 spacing 0.1 file " + path_ + more); });
  };
  expect_parts(message(head + "0,0,0,0,0 0 1 0 1,1,1\n"), {path_ + ":2", "5 numbers", "at least 3 corners"});
  expect_parts(message(head + "0,0,0,0,0 0 1 0 1 o,1,1\n"), {path_ + ":2", "'o'", "'outline'"});
  expect_parts(message(head + "0,0,0,0,0 0 1 0 1 1,0,1\n"), {"'thickness'", "greater than zero"});
  expect_parts(message(head + "0,0,0,0,0 0 1 1 1 0 0 1,1,1\n"), {path_ + ":2", "cross"});
  expect_parts(message("x,y,z,outline\n"), {"'thickness' is missing"});
  expect_parts(message("x,y,z,lx,ly,lz,outline,thickness\n"), {"not both"});
  expect_parts(message("x,y,z\n0,0,0\n", " repeat 5"), {"'repeat'", "column t"});
}

TEST(FloeSchedule, GivesEachWhenItsTimeHasComeAndKeepsWhoWaits) {
  FloeList list;
  for (const double time : {2.0, 1.0, 1.5}) {
    list.floes.emplace_back();
    list.floes.back().enters = time;
  }
  list.floes.emplace_back();  // is there from the start
  using Entries = std::vector<std::int64_t>;
  FloeSchedule once(list);
  EXPECT_TRUE(once.due(0.9).empty());
  EXPECT_EQ(once.due(1.5), (Entries{0, 1}));
  EXPECT_EQ(once.floe(0), 1U);
  EXPECT_EQ(once.floe(1), 2U);
  once.entered(0);
  EXPECT_EQ(once.due(2), (Entries{1, 2})) << "the one that waits comes first";
  EXPECT_EQ(once.waiting(), 2U);
  once.entered(1);
  once.entered(2);
  EXPECT_TRUE(once.due(1e9).empty());

  list.repeat = 10;
  FloeSchedule again(list), restored(list);
  EXPECT_EQ(again.due(11.2), (Entries{0, 1, 2, 3}));
  EXPECT_EQ(again.floe(3), 1U);
  again.entered(1);
  restored.restore(again.save());
  EXPECT_EQ(restored.due(11.5), (Entries{0, 2, 3, 4}));
  EXPECT_EQ(again.due(11.5), restored.due(11.5));
}

std::vector<PlacedFloe> placed(const FloeList& list) {
  std::vector<PlacedFloe> result;
  for (const Floe& floe : list.floes) result.push_back({&list.shapes[floe.shape], floe.state, floe.origin});
  return result;
}

TEST(FloeChecks, OverlapOfBoxesIsExact) {
  const std::string unit = "shape box 1 1 1 density 900 spacing 0.2 ";
  const auto depth = [&](const std::string& bodies) {
    const FloeList list = read(unit + bodies);
    const auto floes = placed(list);
    return overlap_depth(floes[0], floes[1]);
  };
  EXPECT_NEAR(depth("position 0 0 0 position 0.9 0.2 0"), 0.1, 1e-15);
  EXPECT_NEAR(depth("position 0 0 0 position 1.2 0 0"), -0.2, 1e-15);
  // Turned by 45 degrees a cube reaches sqrt(1/2) along x; its covering spheres do not reach that edge.
  const double reach = std::sqrt(0.5);
  EXPECT_NEAR(depth("position 0 0 0 position 1.2 0 0 rotate 0 0 1 45"), 0.5 + reach - 1.2, 1e-15);
  // Two edges that cross at a right angle: only the product of edge directions separates these.
  EXPECT_LT(depth("position 0 0 0 rotate 0 1 0 45 position 0 0 1.45 rotate 1 0 0 45"), 0);
  EXPECT_GT(depth("position 0 0 0 rotate 0 1 0 45 position 0 0 1.38 rotate 1 0 0 45"), 0);
}

TEST(FloeChecks, OverlapOfConvexPrismsIsExact) {
  const std::string triangle = "shape prism 0.2 3 0 0 1 0 0 1 density 900 spacing 0.1 ";  // centroid at a third
  const auto depth = [&](const std::string& bodies) {
    const FloeList list = read(triangle + bodies);
    const auto floes = placed(list);
    return overlap_depth(floes[0], floes[1]);
  };
  // Two triangles make a square: their long sides touch where the centres are sqrt(2)/3 apart.
  const auto facing = [&](double along) {
    return depth(fmt::format("position 0 0 0 position {0} {0} 0 rotate 0 0 1 180", along));
  };
  EXPECT_NEAR(facing(1.0 / 3 - 0.01), 0.01 * std::sqrt(2.0), 1e-12) << "its spheres do not reach the edges";
  EXPECT_NEAR(facing(1.0 / 3 + 0.01), -0.01 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(depth("position 0 0 0 position 0 0 0.19"), 0.01, 1e-12);
  EXPECT_LT(depth("position 0 0 0 position 0 0 0.2001"), 0);
  // A box and a prism; a shape that is not convex is judged by its spheres.
  const FloeList mixed =
      read("shape box 1 1 0.2 density 900 spacing 0.2 position 0 0 0 " + triangle + "position 0.8 0 0");
  EXPECT_NEAR(overlap_depth(placed(mixed)[0], placed(mixed)[1]), 0.5 + 1.0 / 3 - 0.8, 1e-12);
  const FloeList hook = read(
      "shape prism 0.2 6 0 0 1 0 1 0.2 0.2 0.2 0.2 1 0 1 density 900 spacing 0.05 position 0 0 0 "
      "shape box 0.2 0.2 0.2 density 900 spacing 0.05 position 0.35 0.35 0");
  EXPECT_LT(overlap_depth(placed(hook)[0], placed(hook)[1]), 0) << "in the hook's corner, but apart";
}

TEST(FloeChecks, NamesTheDeepestOverlap) {
  const FloeList touching =
      read("shape box 1 1 1 density 900 spacing 0.2 position 0 0 0 position 1 0 0 position 2 0 0");
  EXPECT_NO_THROW(check_overlaps("fix f", placed(touching), 0));
  const FloeList list = read(
      "shape box 1 1 1 density 900 spacing 0.2 position 0 0 0 position 0.95 0 0 position 5 0 0 position 5 0.7 0.1");
  expect_parts(message_of([&] { check_overlaps("fix f", placed(list), 0); }),
               {"2 pair(s)", "0.3 m", "body 3", "body 4", "(5, 0.7, 0.1)"});
  EXPECT_NO_THROW(check_overlaps("fix f", placed(list), 4));  // only old bodies
}

TEST(FloeChecks, BodiesMustBeInsideTheBox) {
  coupling::Box box{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  const FloeList inside = read("shape box 1 1 1 density 900 spacing 0.2 position 0.5 0 0");
  EXPECT_NO_THROW(check_inside("fix f", placed(inside), box, {false, false, false}));
  const FloeList turned = read("shape box 1 1 1 density 900 spacing 0.2 position 0.5 0 0 rotate 0 0 1 45");
  expect_parts(message_of([&] {
                 check_inside("fix f", placed(turned), box, {false, false, false});
               }),
               {"body 1", "x =", "1.20711", "-1 to 1"});
  EXPECT_NO_THROW(check_inside("fix f", placed(turned), box, {true, false, false}));
  const FloeList cylinder = read("shape cylinder 0.3 1 density 900 spacing 0.2 position 0 0 0 rotate 0 1 0 90");
  EXPECT_TRUE(
      cylinder.shapes[0].shape.extents(cylinder.floes[0].state.orientation).upper.isApprox(Vec3(0.5, 0.3, 0.3)));
}

TEST(ContactTime, FollowsHertz) {
  // A steel ball of radius 1 cm against a like one at 1 m/s: the integral of the equation of motion gives the same
  // time.
  const double radius = 0.005, modulus = 1e11, mass = 0.016, speed = 1;
  double gap = 0, velocity = -speed, time = 0;
  const double step = 1e-9, stiffness = 4.0 / 3.0 * modulus * std::sqrt(radius);
  do {
    velocity += step * stiffness * std::pow(std::max(0.0, -gap), 1.5) / mass;
    gap += step * velocity;
    time += step;
  } while (gap < 0);
  EXPECT_NEAR(hertz_contact_time(mass, radius, modulus, speed, 1) / time, 1, 0.002);
  EXPECT_NEAR(hertz_contact_time(mass, radius, modulus, speed, 16) / time, std::pow(16, -0.4), 0.002);
}

}  // namespace
}  // namespace embacle::liggghts
