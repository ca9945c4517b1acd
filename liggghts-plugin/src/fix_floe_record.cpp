#include "fix_floe_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "bodies.hpp"
#include "words.hpp"

using namespace LAMMPS_NS;

namespace embacle::liggghts {

FixFloeRecord::FixFloeRecord(LAMMPS* lammps, int argc, char** argv) : Fix(lammps, argc, argv) {
  where_ = fmt::format("fix {} {}", id, style);
  Words words(where_, std::vector<std::string>(argv + 3, argv + argc));
  nevery = 1;
  while (!words.empty()) {
    const std::string name = words.word("a keyword");
    if (name == "every") {
      nevery = words.integer("every (steps between two lines)", 1);
    } else if (name == "file") {
      file_name_ = words.word("the name of a file after 'file'");
    } else {
      words.fail_unknown("keyword", name, {"every", "file"});
    }
  }
  if (file_name_.empty()) words.fail("needs 'file NAME'");
  restart_global = 1;
}

void FixFloeRecord::open() {
  std::error_code problem;
  const auto size = std::filesystem::file_size(file_name_, problem);
  const bool kept = !problem && keep_ >= 0 && size >= static_cast<std::uintmax_t>(keep_);
  if (kept) std::filesystem::resize_file(file_name_, static_cast<std::uintmax_t>(keep_), problem);
  file_ = problem && kept ? nullptr : std::fopen(file_name_.c_str(), kept ? "a" : "w");
  if (!file_) {
    throw coupling::InputError(fmt::format("{}: cannot write '{}': {}", where_, file_name_, std::strerror(errno)));
  }
  if (kept) return;
  fmt::print(file_,
             "t [s],tag [-],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],"
             "wx [rad/s],wy [rad/s],wz [rad/s],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]\n");
}

FixFloeRecord::~FixFloeRecord() {
  if (file_) std::fclose(file_);
}

int FixFloeRecord::setmask() { return FixConst::END_OF_STEP; }

void FixFloeRecord::post_create() {
  multisphere_ = find_multisphere(lmp, where_);
  if (comm->me == 0) open();
}

void FixFloeRecord::write_restart(std::FILE* file) {
  if (comm->me != 0) return;
  std::fseek(file_, 0, SEEK_END);
  const std::array<double, 2> record = {static_cast<double>(std::ftell(file_)), static_cast<double>(written_)};
  const int bytes = sizeof record;
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(record.data(), sizeof(double), record.size(), file);
}

void FixFloeRecord::restart(char* buffer) {
  std::array<double, 2> record{};
  std::memcpy(record.data(), buffer, sizeof record);
  keep_ = static_cast<long>(record[0]);
  written_ = static_cast<bigint>(record[1]);
}

void FixFloeRecord::setup(int /*vflag*/) { write(); }

void FixFloeRecord::end_of_step() { write(); }

void FixFloeRecord::write() {
  if (update->ntimestep == written_) return;
  written_ = update->ntimestep;
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
  if (!file_) return;
  std::vector<const double*> rows;
  for (std::size_t at = 0; at < all.size(); at += 20) rows.push_back(all.data() + at);
  std::sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return a[0] < b[0]; });
  for (const double* row : rows) {
    fmt::print(file_, "{:.12g},{:.0f}", update->get_cur_time(), row[0]);
    for (int k = 1; k < 20; ++k) fmt::print(file_, ",{:.12g}", row[k]);
    fmt::print(file_, "\n");
  }
  if (std::fflush(file_) != 0) {
    throw coupling::SystemError(fmt::format("{}: cannot write '{}': {}", where_, file_name_, std::strerror(errno)));
  }
}

}  // namespace embacle::liggghts
