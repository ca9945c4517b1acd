// All contacts of model floe in one simulation: who is near whom, who touches, and the forces on the bodies.
#pragma once

#include <limits>
#include <map>

#include "bodies.hpp"
#include "contact/floe_law.hpp"

namespace embacle::liggghts {

/// How messages name the model.
inline const std::string floe_model_name = "pair_style gran model floe";

/// The state of the contacts, for those who choose time steps.
struct FloeContactOutlook {
  bool may_touch = false;  ///< some pair of this rank can close its gap within the time asked for
  /// Half a period [s] of the stiffest contact among them, face on face.
  double contact_time = std::numeric_limits<double>::infinity();
};

/// Contacts of whole bodies by their shapes (see Patch and contact_force); the covering spheres play no part.
///
/// Each rank treats the pairs of which it owns a body, in the order of their tags. A pair whose bodies have different
/// owners is computed by both from the same numbers. States cross ranks point to point along lists that are made when
/// LIGGGHTS builds its neighbour lists.
class FloeContacts {
 public:
  explicit FloeContacts(LAMMPS_NS::LAMMPS* lammps) : lammps_(lammps) {}

  /// Finds shapes, materials and walls. Collective; throws InputError.
  void prepare();
  /// Adds the contact forces and torques of a time step to the bodies of this rank. Collective.
  void compute();
  /// Likewise when a run is set up. A body that has not moved since the last step has that step's force, so that a run
  /// in parts, or one that is continued from a restart file, gives the same as one in a whole: velocities are half a
  /// step older within a step than between steps. Collective.
  void set_up();
  /// Of the pairs in the lists, for a time `window` [s] and no point's acceleration beyond `acceleration` [m/s^2].
  /// Collective.
  [[nodiscard]] FloeContactOutlook outlook(double window, double acceleration);
  /// Half a period [s] of the stiffest contact that two bodies of any shapes, or one and a wall, can have.
  [[nodiscard]] double shortest_contact_time() const;

  /// What all contacts store at present, of the places of the last step [J].
  struct Energy {
    double pressure = 0;  ///< between bodies and with planes
    double friction = 0;  ///< in the springs of friction
  };
  /// Of the contacts whose first body is this rank's. Throws InputError if there are meshes: the energy at their
  /// triangles is not known.
  [[nodiscard]] Energy stored_energy();

  /// The walls by the names of their meshes, or of their fix if they are planes.
  [[nodiscard]] std::vector<std::string> wall_names() const;
  /// Mean force [N] of the bodies on each wall, and torque about the origin [N m], since the last call; zero if no step
  /// was made. Collective.
  [[nodiscard]] std::vector<coupling::Load> take_wall_loads();

  /// What there is to remember between runs: on rank 0 of all ranks, elsewhere nothing. Collective.
  struct Memory {
    std::vector<double> contacts;  ///< ContactMemory of each pair that touches, with its key
    std::vector<double> forces;    ///< of the last step, with the places of the bodies
  };
  [[nodiscard]] Memory memory() const;
  /// To take up when lists are built next; each rank takes what concerns its bodies.
  void remember(Memory memory) { remembered_ = std::move(memory); }

 private:
  struct Body {
    coupling::BodyTag tag = 0;
    int shape = 0, owner = 0;
    int local = -1;  ///< index in fix multisphere; -1: owned by another rank
    coupling::Quaternion orientation = coupling::Quaternion::Identity();
    bool turned = false;  ///< whether axes, inverse mass and inertia are up to date
    coupling::Mat3 axes = coupling::Mat3::Identity();
    RigidMotion motion;
    double contacts = 0;  ///< that it had at the last step
    double fastest = 0;   ///< bound of the speed of its places [m/s]
  };
  /// What a shape brings into contacts.
  struct Material {
    ConvexShape shape;
    int atom_type = 1;
    double hardness = 0;                              ///< [Pa/m]
    double mass = 0;                                  ///< [kg]
    double face = 0;                                  ///< area of the largest face [m^2]
    coupling::Vec3 inertia = coupling::Vec3::Zero();  ///< principal [kg m^2]
  };
  struct Wall {
    LAMMPS_NS::FixWallGran* fix = nullptr;
    LAMMPS_NS::FixMeshSurface* mesh = nullptr;  ///< null: a plane
    int axis = 0;                               ///< of a plane
    double place = 0;                           ///< of a plane [m]
    coupling::Vec3 velocity = coupling::Vec3::Zero();
    int atom_type = 1;
  };
  struct Pair {
    int first, second;
    ContactMemory memory;
    double clear = 0;  ///< way [m] that the bodies must still go before they can touch; 0: not known
  };
  /// Contacts of a body with a mesh are one for each of six directions of the triangles.
  struct WallPair {
    int body, wall;
    std::vector<int> triangles;
    std::array<ContactMemory, 6> memory;
  };
  using Key = std::array<coupling::BodyTag, 3>;  ///< tag; other tag, or -1 - wall; direction

  /// Brings lists and states up to date.
  void update();
  void find_walls();
  void find_owned();
  void build_lists();
  void count_contacts();
  void share_states();
  void refresh();
  void find_wall_pairs(double margin);
  void collect(std::map<Key, ContactMemory>& memories) const;
  /// Brings what follows from the orientation up to date; only bodies that are near others need it.
  void turn(Body& body) const;
  [[nodiscard]] PosedShape posed(Body& body, const coupling::Vec3& origin) const;
  [[nodiscard]] coupling::Vec3 nearest_image(coupling::Vec3 difference) const;
  [[nodiscard]] const ContactMaterial& material(int first_type, int second_type) const {
    return contact_materials_[first_type - 1][second_type - 1];
  }
  [[nodiscard]] double wall_share(int body_type, int wall_type) const;
  /// Throws InstabilityError if the time step is too long for a patch, or its pressure near `strength`, the largest
  /// that a body can have; `other`: a body or -1 - wall.
  void check(const Patch& patch, double inverse_mass, double strength, coupling::BodyTag body,
             coupling::BodyTag other) const;
  /// Throws InstabilityError if a new contact is deeper than the speed of approach can explain. `hardness`: of the
  /// springs in a row; `way`: at most, in a step [m].
  void check_first_touch(const Patch& patch, double hardness, double way, double size, coupling::BodyTag body,
                         coupling::BodyTag other) const;
  /// Throws InstabilityError if bodies could pass through each other, or a plane, within a step.
  void check_way(double gap, double way, double thickness, coupling::BodyTag body, coupling::BodyTag other) const;
  void check_ways() const;
  /// Warns once if a body between others is so light that the damping of a heavy one's impact is cut short.
  void warn_of_light_between(const Patch& patch, const Body& first, const Body& second);
  [[nodiscard]] std::string names_of(coupling::BodyTag body, coupling::BodyTag other) const;
  /// Pressure [Pa] in the middle of a shape.
  [[nodiscard]] double strength(int shape) const {
    return 0.5 * materials_[shape].hardness * materials_[shape].shape.thickness;
  }
  void compute_all(bool advance);
  void compute_pair(Pair& pair, bool advance);
  void compute_wall(WallPair& pair, bool advance);
  [[nodiscard]] std::vector<double> last_forces() const;
  void take_up_forces(const std::vector<double>& records);
  void press_mesh(WallPair& pair, const PosedShape& shape, std::array<Patch, 6>& patches,
                  std::array<RigidMotion, 6>& motions) const;
  void add(const Body& body, const coupling::Vec3& force, const coupling::Vec3& torque);

  LAMMPS_NS::LAMMPS* lammps_;
  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  std::vector<Material> materials_;                              ///< by shape
  double gravity_ = 0;                                           ///< [m/s^2]
  double thinnest_ = 0;                                          ///< of the shapes [m]
  std::vector<double> young_;                                    ///< by atom type
  std::vector<std::vector<ContactMaterial>> contact_materials_;  ///< by atom types
  std::vector<Wall> walls_;
  std::vector<coupling::Load> wall_impulses_;  ///< of this rank's bodies on each wall [N s, N m s]
  double wall_time_ = 0;                       ///< in which they came about [s]
  std::vector<Body> bodies_;                   ///< owned ones first, then those of other ranks that are near
  std::size_t owned_ = 0;
  std::vector<Pair> pairs_;
  std::vector<WallPair> wall_pairs_;
  struct Exchange {
    int rank;
    std::vector<int> send, receive;  ///< indices into bodies_
    std::vector<double> sent, received;
  };
  std::vector<Exchange> exchanges_;
  /// Of the last step, by owned body.
  struct LastForce {
    coupling::Vec3 place = coupling::Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    coupling::Vec3 force = coupling::Vec3::Zero(), torque = coupling::Vec3::Zero();
  };
  std::vector<LastForce> last_;
  Memory remembered_;
  std::int64_t built_ = -1;
  Patch patch_;
  bool warned_of_light_ = false;
  double** forces_ = nullptr;   ///< where LIGGGHTS sums up those on owned bodies [N]
  double** torques_ = nullptr;  ///< likewise [N m]
};

}  // namespace embacle::liggghts
