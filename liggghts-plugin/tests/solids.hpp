// A LIGGGHTS without files and screen for tests, with the plugin's styles.
#pragma once

#include <string>
#include <vector>

#include "bodies.hpp"
#include "stock.hpp"
#include "styles.hpp"

namespace embacle::liggghts {

class Solids {
 public:
  explicit Solids(MPI_Comm own = MPI_COMM_WORLD) {
    std::vector<std::string> words = {"test", "-screen", "/dev/null", "-log", "none"};
    std::vector<char*> argv;
    argv.reserve(words.size());
    for (std::string& word : words) argv.push_back(word.data());
    lammps_ = new LAMMPS_NS::LAMMPS(static_cast<int>(argv.size()), argv.data(), own);
    register_styles(lammps_);
  }
  ~Solids() { delete lammps_; }
  Solids(const Solids&) = delete;
  Solids& operator=(const Solids&) = delete;

  void run(const std::vector<std::string>& lines) {
    for (const std::string& line : lines) lammps_->input->one(line.c_str());
  }
  /// A box of 2 m about the origin with one material and free boundaries; fix multisphere in it.
  void prepare(const std::string& young = "5e7", const std::string& model = "hertz tangential history",
               double restitution = 0.5, double friction = 0.4, const std::string& restart_file = "") {
    run({"units si", "atom_style granular", "atom_modify map array", "boundary f f f", "newton off",
         "communicate single vel yes", "hard_particles yes"});
    if (restart_file.empty()) {
      run({"region box block -1 1 -1 1 -1 1 units box", "create_box 1 box"});
    } else {
      run({"read_restart " + restart_file});
    }
    run({"neighbor 0.01 bin", "neigh_modify delay 0 every 1 check yes",
         "fix m1 all property/global youngsModulus peratomtype " + young,
         "fix m2 all property/global poissonsRatio peratomtype 0.3",
         "fix m3 all property/global coefficientRestitution peratomtypepair 1 " + std::to_string(restitution),
         "fix m4 all property/global coefficientFriction peratomtypepair 1 " + std::to_string(friction),
         "pair_style gran model " + model, "pair_coeff * *", "fix motion all multisphere", "timestep 1e-5"});
  }
  [[nodiscard]] std::vector<coupling::SolidBody> bodies() {
    return gather_bodies(lammps_, find_multisphere(lammps_, "test"));
  }
  [[nodiscard]] LAMMPS_NS::LAMMPS* lammps() const { return lammps_; }

 private:
  LAMMPS_NS::LAMMPS* lammps_;
};

}  // namespace embacle::liggghts
