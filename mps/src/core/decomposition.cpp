#include "core/decomposition.hpp"

#include <zoltan.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace embacle::mps {

namespace {

struct Points {
  int dimension;
  std::vector<double> positions;
  const std::vector<float>* weights;
};

const Points& points_of(void* data) { return *static_cast<const Points*>(data); }

int number_of_dimensions(void* data, int* error) {
  *error = ZOLTAN_OK;
  return points_of(data).dimension;
}

int number_of_points(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(points_of(data).weights->size());
}

void point_list(void* data, int, int, ZOLTAN_ID_PTR global_ids, ZOLTAN_ID_PTR, int, float* weights, int* error) {
  const Points& points = points_of(data);
  for (std::size_t i = 0; i < points.weights->size(); ++i) {
    global_ids[i] = static_cast<ZOLTAN_ID_TYPE>(i);
    weights[i] = (*points.weights)[i];
  }
  *error = ZOLTAN_OK;
}

void point_positions(void* data, int, int, int count, ZOLTAN_ID_PTR global_ids, ZOLTAN_ID_PTR, int dimension,
                     double* positions, int* error) {
  const Points& points = points_of(data);
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < dimension; ++c) {
      positions[i * dimension + c] = points.positions[3 * static_cast<std::size_t>(global_ids[i]) + c];
    }
  }
  *error = ZOLTAN_OK;
}

void check(int status, const char* what) {
  if (status != ZOLTAN_OK && status != ZOLTAN_WARN) throw std::runtime_error(std::string("Zoltan failed in ") + what);
}

}  // namespace

Decomposition::Decomposition(MPI_Comm comm, const Periodic& periodic, double tie_shear)
    : comm_(comm), periodic_(periodic), tie_shear_(tie_shear) {
  MPI_Comm_rank(comm, &rank_);
  MPI_Comm_size(comm, &size_);
  const double inf = std::numeric_limits<double>::infinity();
  boxes_.resize(size_);
  for (int r = 0; r < size_; ++r) set_box(r, coupling::Vec3::Constant(-inf), coupling::Vec3::Constant(inf));
}

void Decomposition::set_box(int rank, const coupling::Vec3& lower, const coupling::Vec3& upper) {
  boxes_[rank] = {lower, upper};
  for (int c = 0; c < 3; ++c) {
    if (!periodic_.in(c)) continue;
    const double end = periodic_.lower[c] + periodic_.length[c];
    boxes_[rank].lower[c] = std::clamp(lower[c], periodic_.lower[c], end);
    boxes_[rank].upper[c] = std::clamp(upper[c], periodic_.lower[c], end);
  }
}

void Decomposition::partition(int dimension, const std::vector<double>& positions, const std::vector<float>& weights) {
  if (size_ == 1) return;
  float version = 0;
  check(Zoltan_Initialize(0, nullptr, &version), "Zoltan_Initialize");
  Zoltan_Struct* zoltan = Zoltan_Create(comm_);
  Points points{dimension, positions, &weights};
  for (std::size_t i = 0; i < positions.size(); ++i) {
    points.positions[i] = sheared(positions.data() + i / 3 * 3, static_cast<int>(i % 3));
  }
  for (const auto& [key, value] : {std::pair{"DEBUG_LEVEL", "0"},
                                   {"LB_METHOD", "RCB"},
                                   {"NUM_GID_ENTRIES", "1"},
                                   {"NUM_LID_ENTRIES", "0"},
                                   {"OBJ_WEIGHT_DIM", "1"},
                                   {"KEEP_CUTS", "1"},
                                   {"RETURN_LISTS", "NONE"},
                                   {"RCB_OUTPUT_LEVEL", "0"},
                                   {"RCB_RECTILINEAR_BLOCKS", "1"},
                                   {"IMBALANCE_TOL", "1.01"}}) {
    check(Zoltan_Set_Param(zoltan, key, value), key);
  }
  Zoltan_Set_Num_Geom_Fn(zoltan, number_of_dimensions, &points);
  Zoltan_Set_Geom_Multi_Fn(zoltan, point_positions, &points);
  Zoltan_Set_Num_Obj_Fn(zoltan, number_of_points, &points);
  Zoltan_Set_Obj_List_Fn(zoltan, point_list, &points);
  int changes = 0, gid_entries = 0, lid_entries = 0, imports = 0, exports = 0;
  ZOLTAN_ID_PTR import_gids = nullptr, import_lids = nullptr, export_gids = nullptr, export_lids = nullptr;
  int *import_procs = nullptr, *import_parts = nullptr, *export_procs = nullptr, *export_parts = nullptr;
  check(Zoltan_LB_Partition(zoltan, &changes, &gid_entries, &lid_entries, &imports, &import_gids, &import_lids,
                            &import_procs, &import_parts, &exports, &export_gids, &export_lids, &export_procs,
                            &export_parts),
        "Zoltan_LB_Partition");
  Zoltan_LB_Free_Part(&import_gids, &import_lids, &import_procs, &import_parts);
  Zoltan_LB_Free_Part(&export_gids, &export_lids, &export_procs, &export_parts);
  const double inf = std::numeric_limits<double>::infinity();
  for (int part = 0; part < size_; ++part) {
    int dim = 0;
    double lower[3], upper[3];
    check(Zoltan_RCB_Box(zoltan, part, &dim, &lower[0], &lower[1], &lower[2], &upper[0], &upper[1], &upper[2]),
          "Zoltan_RCB_Box");
    for (int c = 0; c < 3; ++c) {
      const bool used = c < dimension;
      lower[c] = used && std::abs(lower[c]) < 1e30 ? lower[c] : -inf;
      upper[c] = used && std::abs(upper[c]) < 1e30 ? upper[c] : inf;
    }
    set_box(part, {lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]});
  }
  Zoltan_Destroy(&zoltan);
}

double Decomposition::sheared(const double* x, int axis) const {
  // Factors without a common measure: no two points of a lattice plane tie again.
  return x[axis] + tie_shear_ * (x[(axis + 1) % 3] + x[(axis + 2) % 3] / std::numbers::phi);
}

bool Decomposition::owns(int rank, const double* x) const {
  const Box& box = boxes_[rank];
  for (int c = 0; c < 3; ++c) {
    // At the ends of a periodic direction the shear must not lead out of the domain.
    const bool first = periodic_.in(c) && box.lower[c] <= periodic_.lower[c];
    const bool last = periodic_.in(c) && box.upper[c] >= periodic_.lower[c] + periodic_.length[c];
    const double place = sheared(x, c);
    if (!((first || place >= box.lower[c]) && (last || place < box.upper[c]))) return false;
  }
  return true;
}

int Decomposition::owner(const double* x, int guess) const {
  if (owns(guess, x)) return guess;
  for (int r = 0; r < size_; ++r) {
    if (owns(r, x)) return r;
  }
  return -1;
}

bool within_reach(const Box& a, const Box& b, double reach) {
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    const double gap = std::max({0.0, a.lower[c] - b.upper[c], b.lower[c] - a.upper[c]});
    square += gap * gap;
  }
  return square <= reach * reach;
}

std::vector<Nearby> Decomposition::nearby(double reach) const {
  const auto displaced = [&](const Box& box, const std::array<int, 3>& image, int sign) {
    Box result = box;
    for (int c = 0; c < 3; ++c) {
      result.lower[c] += sign * image[c] * periodic_.length[c];
      result.upper[c] += sign * image[c] * periodic_.length[c];
    }
    return result;
  };
  const int most[3] = {periodic_.in(0) ? 1 : 0, periodic_.in(1) ? 1 : 0, periodic_.in(2) ? 1 : 0};
  std::vector<Nearby> result;
  for (int r = 0; r < size_; ++r) {
    for (int k = -most[2]; k <= most[2]; ++k) {
      for (int j = -most[1]; j <= most[1]; ++j) {
        for (int i = -most[0]; i <= most[0]; ++i) {
          const std::array<int, 3> image{i, j, k};
          if (r == rank_ && image == std::array<int, 3>{}) continue;
          // Of the two boxes always the same one is displaced, so that both ranks find the same in spite of rounding.
          const bool near = image < std::array<int, 3>{} ? within_reach(displaced(boxes_[r], image, -1), own(), reach)
                                                         : within_reach(displaced(own(), image, 1), boxes_[r], reach);
          if (near) result.push_back({r, image});
        }
      }
    }
  }
  return result;
}

std::vector<int> Decomposition::neighbours(double reach) const {
  std::vector<int> result;
  for (const Nearby& other : nearby(reach)) {
    if (other.rank != rank_ && (result.empty() || result.back() != other.rank)) result.push_back(other.rank);
  }
  return result;
}

}  // namespace embacle::mps
