// Writes what a run produces, when it is due: fields, bodies, gauges, energies, progress, summary.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/diagnostics.hpp"
#include "output/csv.hpp"
#include "output/fields.hpp"
#include "output/summary.hpp"

namespace embacle::mps {

class Recorder {
 public:
  /// Creates the output folder. `restart`: if it stands in this folder, the files there are continued. Collective.
  Recorder(const Scene& scene, Simulation& simulation, std::filesystem::path folder,
           const CheckpointReader* restart = nullptr);

  /// Writes what is due at the present time. Collective.
  void record(bool last);
  /// Takes the measures of the present for the summary of a run that ends before its time. Collective.
  void measure_end();
  /// Adds what a restart needs to continue files and summary.
  void save(CheckpointContent& content) const;
  /// Everything about the run except what the caller adds; valid on every rank. Collective.
  [[nodiscard]] Json summary(const coupling::FluidLink* link, double wall_seconds);
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  /// When something is due: multiples of an interval.
  struct Clock {
    double every = 0;
    std::int64_t next = 0;
    bool due(double time, double tolerance) {
      if (every > 0 && time + tolerance < static_cast<double>(next) * every) return false;
      skip(time, tolerance);
      return true;
    }
    void skip(double time, double tolerance) {
      next = every > 0 ? static_cast<std::int64_t>((time + tolerance) / every) + 1 : next + 1;
    }
  };
  void open_files(std::optional<double> keep_until, std::vector<FrameRecord> earlier_frames);
  void restore(const CheckpointReader& checkpoint);
  void write_fields();
  void write_bodies();
  void write_gauges();
  void write_structures();
  void write_openings();
  void write_energies();
  void write_stage();  ///< stage.json: what pictures need to know of the scene
  void show_progress(bool last);
  /// Reasons not to trust the finished run, from its largest speed [m/s] and largest |rho/rho0 - 1|.
  [[nodiscard]] std::vector<std::string> doubts(double speed, double compression) const;

  const Scene& scene_;
  Simulation& simulation_;
  std::filesystem::path folder_;
  int rank_ = 0;
  std::unique_ptr<FieldWriter> fields_;
  std::unique_ptr<CsvWriter> bodies_, energies_;
  std::vector<std::unique_ptr<CsvWriter>> gauges_, structures_, openings_;
  std::unique_ptr<CsvWriter> arrivals_;  ///< bodies that came later, with their shapes
  double newest_listed_ = -1;            ///< tag of the newest body there or in shapes.json
  std::vector<double> passed_;           ///< through each opening, when it was last written [m3]
  double passed_at_ = 0;                 ///< then [s]
  Clock fields_clock_, bodies_clock_, gauges_clock_, structures_clock_, openings_clock_, energies_clock_;
  std::size_t next_picture_ = 0;
  WaterState start_, now_;
  std::int64_t interactions_ = 0, listed_ = 0;       ///< of the steps at which energies were written; on this rank
  double largest_energy_gain_ = 0;                   ///< over the start [J]
  double lowest_energy_ = 0;                         ///< so far [J]
  double largest_energy_rise_ = 0;                   ///< over the lowest before [J]
  double largest_energy_ = 0;                        ///< kinetic or elastic [J]
  double compressed_share_ = 0, compressed_at_ = 0;  ///< most water with a density off by 1 %, and when [s]
  std::int64_t most_outside_ = 0, most_inside_ = 0;
  double deepest_ = 0;
  double farthest_outside_ = 0;
  double began_, last_shown_ = -1e300;
  double began_at_ = 0;                ///< simulated time with which this run began
  double earlier_seconds_ = 0;         ///< of wall time, before the restart
  std::vector<double> restart_times_;  ///< simulated times of all restarts
};

}  // namespace embacle::mps
