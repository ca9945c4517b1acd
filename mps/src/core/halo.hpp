// Moves particles between ranks: migration to the owner, and ghosts of what lies within reach of the neighbours.
#pragma once

#include <mpi.h>

#include <vector>

#include "core/decomposition.hpp"
#include "core/particles.hpp"

namespace embacle::mps {

class Halo {
 public:
  explicit Halo(MPI_Comm comm) : comm_(comm) {}

  /// Sends every traveller to the rank that owns its place. `anywhere`: after a new decomposition a particle may go to
  /// any rank, otherwise only to ranks within `reach`. Throws InstabilityError for a place that no rank owns (NaN) or
  /// that lies beyond the neighbours.
  void migrate(const Decomposition& decomposition, double reach, bool anywhere,
               std::vector<Traveller>& travellers) const;

  /// Ghosts of the water, then of the solid points: every own one within `reach` of a neighbour's box is copied there,
  /// and so are the images in periodic directions, also to this rank itself. Returns what the neighbours sent here; the
  /// plan stays for the updates, for which assemble() tells that the ghosts now stand behind the own particles.
  [[nodiscard]] std::vector<Traveller> exchange_water(const Decomposition& decomposition, double reach,
                                                      const Particles& particles);
  [[nodiscard]] std::vector<Traveller> exchange_solid(const Decomposition& decomposition, double reach,
                                                      const std::vector<Traveller>& solid, std::size_t first_index);
  void assemble(const Particles& particles);

  /// Positions and velocities of all ghosts.
  void update_motion(Particles& particles);
  /// Pressure and n/n0 of the water's ghosts / of the solid points' ghosts: sent, to arrive by finish(). One update at
  /// a time; what it sends may change in between, what it receives must not be read.
  void start_water_state(Particles& particles);
  void start_solid_pressure(Particles& particles);
  void finish();

  /// Rows of doubles that someone keeps for all particles: those of the water's ghosts.
  template <class Row>
  void update_water_rows(std::vector<Row>& rows) {
    constexpr int width = sizeof(Row) / sizeof(double);  // NOLINT(bugprone-sizeof-expression): rows of one, too
    start({reinterpret_cast<double*>(rows.data()), width, width, true, false, false});
    finish();
  }

  [[nodiscard]] std::int64_t bytes_sent() const { return bytes_sent_; }
  [[nodiscard]] std::int64_t messages_sent() const { return messages_sent_; }

 private:
  struct Link {
    Nearby partner;
    bool displaced = false;  ///< what is sent stands elsewhere for the partner, by `shift`
    double shift[3] = {0, 0, 0};
    std::vector<std::uint32_t> send_water, send_solid;
    std::size_t receive_water = 0, receive_solid = 0;              ///< counts
    std::size_t receive_water_begin = 0, receive_solid_begin = 0;  ///< first index
    std::vector<double> send_buffer, receive_buffer;
  };
  /// Appends a traveller, displaced as the link asks, if it then lies within reach of the partner's box.
  static bool add_if_near(const Link& link, const Box& box, double reach, Traveller traveller,
                          std::vector<Traveller>& outgoing);
  /// What an update copies: `width` doubles of each particle, `stride` doubles apart from `first` on.
  struct Columns {
    double* first;
    int stride, width;
    bool water, solid;
    bool positions;  ///< the first three are a position
  };
  void start(const Columns& columns);

  MPI_Comm comm_;
  std::vector<Nearby> partners_;
  std::vector<Link> links_;
  Columns columns_{};  ///< of the update on its way
  std::vector<MPI_Request> requests_;
  std::int64_t bytes_sent_ = 0;
  std::int64_t messages_sent_ = 0;
};

}  // namespace embacle::mps
