#include "fix_floe_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "bodies.hpp"
#include "contact/floe_contacts.hpp"
#include "contact/floe_styles.hpp"
#include "words.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

using coupling::Vec3;

FixFloeRecord::FixFloeRecord(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  where_ = fmt::format("fix {} {}", id, style);
  Words words(where_, std::vector<std::string>(argv + 3, argv + argc));
  nevery = 1;
  while (!words.empty()) {
    const std::string name = words.word("a keyword");
    if (name == "every") {
      nevery = words.integer("every (steps between two lines)", 1);
    } else if (name == "file") {
      motions_.name = words.word("the name of a file after 'file'");
    } else if (name == "energies") {
      energies_.name = words.word("the name of a file after 'energies'");
    } else if (name == "walls") {
      walls_.name = words.word("the name of a file after 'walls'");
    } else {
      words.fail_unknown("keyword", name, {"every", "file", "energies", "walls"});
    }
  }
  if (motions_.name.empty() && energies_.name.empty() && walls_.name.empty())
    words.fail("needs 'file NAME', 'energies NAME' or 'walls NAME'");
  for (Table* table : {&motions_, &energies_, &walls_}) table->wanted = !table->name.empty();
  restart_global = 1;
}

void FixFloeRecord::open_tables() {
  open(motions_,
       "t [s],tag [-],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],"
       "wx [rad/s],wy [rad/s],wz [rad/s],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]\n");
  open(energies_, "t [s],kinetic [J],potential [J],elastic [J],friction [J]\n");
}

void FixFloeRecord::open(Table& table, const char* head) const {
  if (comm->me != 0 || !table.wanted) return;
  std::error_code problem;
  const auto size = std::filesystem::file_size(table.name, problem);
  const bool kept = !problem && table.keep >= 0 && size >= static_cast<std::uintmax_t>(table.keep);
  if (kept) std::filesystem::resize_file(table.name, static_cast<std::uintmax_t>(table.keep), problem);
  table.file = problem && kept ? nullptr : std::fopen(table.name.c_str(), kept ? "a" : "w");
  if (!table.file) {
    throw coupling::InputError(fmt::format("{}: cannot write '{}': {}", where_, table.name, std::strerror(errno)));
  }
  if (!kept) fmt::print(table.file, "{}", head);
}

void FixFloeRecord::close_line(const Table& table) const {
  if (std::fflush(table.file) != 0) {
    throw coupling::SystemError(fmt::format("{}: cannot write '{}': {}", where_, table.name, std::strerror(errno)));
  }
}

FixFloeRecord::~FixFloeRecord() {
  for (const Table* table : {&motions_, &energies_, &walls_}) {
    if (table->file) std::fclose(table->file);
  }
}

int FixFloeRecord::setmask() { return FixConst::END_OF_STEP; }

void FixFloeRecord::post_create() {
  multisphere_ = find_multisphere(lmp, where_);
  open_tables();
}

void FixFloeRecord::write_restart(std::FILE* file) {
  if (comm->me != 0) return;
  const auto length = [](const Table& table) {
    if (!table.file) return -1.0;
    std::fseek(table.file, 0, SEEK_END);
    return static_cast<double>(std::ftell(table.file));
  };
  const std::array<double, 4> record = {static_cast<double>(written_), length(motions_), length(energies_),
                                        length(walls_)};
  const int bytes = sizeof record;
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(record.data(), sizeof(double), record.size(), file);
}

void FixFloeRecord::restart(char* buffer) {
  std::array<double, 4> record{};
  std::memcpy(record.data(), buffer, sizeof record);
  written_ = static_cast<bigint>(record[0]);
  motions_.keep = static_cast<long>(record[1]);
  energies_.keep = static_cast<long>(record[2]);
  walls_.keep = static_cast<long>(record[3]);
}

void FixFloeRecord::setup(int /*vflag*/) { write(); }

void FixFloeRecord::end_of_step() { write(); }

void FixFloeRecord::write() {
  if (update->ntimestep == written_) return;
  written_ = update->ntimestep;
  if (motions_.wanted) write_bodies();
  if (energies_.wanted) write_energies();
  if (walls_.wanted) write_walls();
}

/// The walls are known when a run is set up, so the head of the table is written with its first line.
void FixFloeRecord::write_walls() {
  FloeContacts* contacts = floe_contacts(lmp);
  if (!contacts) {
    throw coupling::InputError(where_ + ": walls are those of 'pair_style gran model floe', which the script lacks");
  }
  const auto loads = contacts->take_wall_loads();
  if (comm->me != 0) return;
  if (!walls_.file) {
    std::string head = "t [s]";
    for (const std::string& name : contacts->wall_names()) {
      for (const char* part : {"fx [N]", "fy [N]", "fz [N]", "tx [N m]", "ty [N m]", "tz [N m]"})
        head += fmt::format(",{} {}", name, part);
    }
    open(walls_, (head + "\n").c_str());
  }
  fmt::print(walls_.file, "{:.12g}", update->get_cur_time());
  for (const coupling::Load& load : loads) {
    for (const Vec3& part : {load.force, load.torque})
      fmt::print(walls_.file, ",{:.9g},{:.9g},{:.9g}", part[0], part[1], part[2]);
  }
  fmt::print(walls_.file, "\n");
  close_line(walls_);
}

void FixFloeRecord::write_energies() {
  FloeContacts* contacts = floe_contacts(lmp);
  if (!contacts) {
    throw coupling::InputError(where_ + ": energies are those of 'pair_style gran model floe', which the script lacks");
  }
  const auto stored = contacts->stored_energy();
  std::array<double, 4> sums{0, 0, stored.pressure, stored.friction};
  Multisphere& bodies = multisphere_->data();
  double** inertia = bodies.extract_double_vector("inertia");
  const Vec3 gravity = gravity_of(lmp);
  for (int i = 0; i < bodies.n_body(); ++i) {
    Vec3 position, velocity, spin;
    std::array<double, 4> q{};
    bodies.xcm(position.data(), i);
    bodies.vcm(velocity.data(), i);
    bodies.omega(spin.data(), i);
    bodies.quat(q.data(), i);
    spin = coupling::Quaternion(q[0], q[1], q[2], q[3]).conjugate() * spin;
    const Vec3 principal = Eigen::Map<const Vec3>(inertia[i]);
    sums[0] += 0.5 * (bodies.mass(i) * velocity.squaredNorm() + spin.cwiseAbs2().dot(principal));
    sums[1] -= bodies.mass(i) * gravity.dot(position);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, world);
  if (!energies_.file) return;
  fmt::print(energies_.file, "{:.12g},{:.16g},{:.16g},{:.16g},{:.16g}\n", update->get_cur_time(), sums[0], sums[1],
             sums[2], sums[3]);
  close_line(energies_);
}

void FixFloeRecord::write_bodies() {
  Multisphere& bodies = multisphere_->data();
  double** resultant = bodies.extract_double_vector("fcm");
  double** moment = bodies.extract_double_vector("torque");
  std::vector<double> mine;
  for (const auto& body : owned_bodies(lmp, multisphere_)) {
    const auto i = mine.size() / 20;
    const auto& s = body.state;
    mine.push_back(static_cast<double>(body.tag));
    mine.insert(mine.end(), s.position.data(), s.position.data() + 3);
    mine.insert(mine.end(), {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()});
    mine.insert(mine.end(), s.velocity.data(), s.velocity.data() + 3);
    mine.insert(mine.end(), s.angular_velocity.data(), s.angular_velocity.data() + 3);
    mine.insert(mine.end(), resultant[i], resultant[i] + 3);
    mine.insert(mine.end(), moment[i], moment[i] + 3);
  }
  const std::vector<double> all = gather_on_all(world, mine);
  if (!motions_.file) return;
  std::vector<const double*> rows;
  for (std::size_t at = 0; at < all.size(); at += 20) rows.push_back(all.data() + at);
  std::sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return a[0] < b[0]; });
  for (const double* row : rows) {
    fmt::print(motions_.file, "{:.12g},{:.0f}", update->get_cur_time(), row[0]);
    for (int k = 1; k < 20; ++k) fmt::print(motions_.file, ",{:.12g}", row[k]);
    fmt::print(motions_.file, "\n");
  }
  close_line(motions_);
}

}  // namespace embacle::liggghts
