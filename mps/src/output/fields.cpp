#include "fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "files.hpp"
#include "hdf5_file.hpp"

// Frames are written as hdf5_file.hpp explains: no collective I/O, HDF5's own part in memory.

namespace embacle::mps {
namespace {

namespace fs = std::filesystem;

/// One dataset of a frame: how it is stored, what XDMF calls it, and this rank's part of it.
struct Dataset {
  const char* name;
  const char* unit;
  hid_t type;
  std::size_t components;
  std::span<const std::byte> data;

  [[nodiscard]] std::size_t bytes_per_particle() const { return H5Tget_size(type) * components; }
};
constexpr std::size_t dataset_count = 6;
using Datasets = std::array<Dataset, dataset_count>;

Datasets datasets_of(const FieldFrame& frame, hid_t id_type, std::span<const std::byte> ids) {
  return {{{"position", "m", H5T_NATIVE_FLOAT, 3, std::as_bytes(frame.position)},
           {"velocity", "m/s", H5T_NATIVE_FLOAT, 3, std::as_bytes(frame.velocity)},
           {"pressure", "Pa", H5T_NATIVE_FLOAT, 1, std::as_bytes(frame.pressure)},
           {"type", "0 fluid, 1 wall, 2 body", H5T_NATIVE_INT8, 1, std::as_bytes(frame.type)},
           {"body_tag", "-1 for none", H5T_NATIVE_INT32, 1, std::as_bytes(frame.body_tag)},
           {"ids", "number within the frame", id_type, 1, ids}}};
}

/// Rank 0: the file with its attributes and empty datasets, space reserved. Returns where each dataset starts in the
/// file.
std::array<std::int64_t, dataset_count> lay_out(const fs::path& path, const FieldFrame& frame, const Datasets& datasets,
                                                std::int64_t particles) {
  std::array<std::int64_t, dataset_count> starts{};
  write_hdf5(path, [&](hid_t file) {
    write_attribute(file, "time", H5T_NATIVE_DOUBLE, &frame.time, path);
    write_attribute(file, "step", H5T_NATIVE_INT64, &frame.step, path);
    write_attribute(file, "particles", H5T_NATIVE_INT64, &particles, path);
    const Handle plan(check(H5Pcreate(H5P_DATASET_CREATE), path), H5Pclose);
    check(H5Pset_layout(plan, H5D_CONTIGUOUS), path);
    check(H5Pset_alloc_time(plan, H5D_ALLOC_TIME_EARLY), path);
    check(H5Pset_fill_time(plan, H5D_FILL_TIME_NEVER), path);
    for (std::size_t i = 0; i < datasets.size(); ++i) {
      const Dataset& dataset = datasets[i];
      const std::array<hsize_t, 2> extent{static_cast<hsize_t>(particles), dataset.components};
      const Handle space(check(H5Screate_simple(dataset.components > 1 ? 2 : 1, extent.data(), nullptr), path),
                         H5Sclose);
      const Handle set(check(H5Dcreate2(file, dataset.name, dataset.type, space, H5P_DEFAULT, plan, H5P_DEFAULT), path),
                       H5Dclose);
      write_text_attribute(set, "unit", dataset.unit, path);
      // An empty dataset has no place, and nothing is written into it.
      starts[i] = particles > 0 ? static_cast<std::int64_t>(H5Dget_offset(set)) : 0;
    }
  });
  return starts;
}

/// Every rank: its slab of each dataset, `first` being the number of particles on lower ranks.
void write_slabs(const fs::path& path, const Datasets& datasets, const std::array<std::int64_t, dataset_count>& starts,
                 std::int64_t first) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC), path);
  int code = 0;
  for (std::size_t i = 0; i < datasets.size() && code == 0; ++i) {
    const auto skipped = first * static_cast<std::int64_t>(datasets[i].bytes_per_particle());
    code = write_at(file, datasets[i].data, starts[i] + skipped);
  }
  if (const int closing = file.close(); code == 0) code = closing;
  if (code != 0) throw coupling::SystemError(cannot_write(path, code));
}

std::string frame_number(std::size_t index) { return fmt::format("{:06}", index); }

/// fields.h5: all frames as external links, with their times and steps.
void write_master(const fs::path& path, const std::vector<FrameRecord>& frames) {
  write_hdf5(beside(path), [&](hid_t file) {
    std::vector<double> times;
    std::vector<std::int64_t> steps;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      times.push_back(frames[i].time);
      steps.push_back(frames[i].step);
      const std::string number = frame_number(i);
      check(H5Lcreate_external(("fields/" + number + ".h5").c_str(), "/", file, ("frame_" + number).c_str(),
                               H5P_DEFAULT, H5P_DEFAULT),
            path);
    }
    write_list(file, "times", H5T_NATIVE_DOUBLE, times, path);
    write_list(file, "steps", H5T_NATIVE_INT64, steps, path);
  });
  move_into_place(path);
}

/// fields.xdmf. ParaView's Xdmf3 reader shows no points without explicit ids as connectivity.
void write_xdmf(const fs::path& path, const std::vector<FrameRecord>& frames) {
  std::string text =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto n = frames[i].particles;
    const auto item = [&](const char* name, const char* number_type, int precision, bool vector) {
      return fmt::format(
          R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}{}">fields/{}.h5:/{}</DataItem>)",
          number_type, precision, n, vector ? " 3" : "", frame_number(i), name);
    };
    const auto attribute = [&](const char* name, const char* number_type, int precision, bool vector) {
      return fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", name,
                         vector ? "Vector" : "Scalar", item(name, number_type, precision, vector));
    };
    text += fmt::format("      <Grid Name=\"frame_{}\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n",
                        frame_number(i), frames[i].time);
    text += fmt::format(
        "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\">{}</Topology>\n",
        n, item("ids", "Int", n > std::numeric_limits<std::int32_t>::max() ? 8 : 4, false));
    text += fmt::format("        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", item("position", "Float", 4, true));
    text += attribute("velocity", "Float", 4, true);
    text += attribute("pressure", "Float", 4, false);
    text += attribute("type", "Char", 1, false);
    text += attribute("body_tag", "Int", 4, false);
    text += "      </Grid>\n";
  }
  text += "    </Grid>\n  </Domain>\n</Xdmf>\n";
  write_whole_file(path, text);
}

void write_indices(const fs::path& folder, const std::vector<FrameRecord>& frames) {
  write_master(folder / "fields.h5", frames);
  write_xdmf(folder / "fields.xdmf", frames);
}

/// The numbers first, first + 1, ... of this rank's particles within the frame, as Integer.
template <typename Integer>
std::vector<Integer> numbered(std::int64_t first, std::size_t count) {
  std::vector<Integer> numbers(count);
  std::iota(numbers.begin(), numbers.end(), static_cast<Integer>(first));
  return numbers;
}

}  // namespace

struct FieldWriter::Impl {
  MPI_Comm comm = MPI_COMM_NULL;
  int rank = 0;
  fs::path folder;
  std::vector<FrameRecord> frames;
};

FieldWriter::FieldWriter(MPI_Comm comm, fs::path folder, std::vector<FrameRecord> earlier)
    : impl_(std::make_unique<Impl>()) {
  report_file_size_limit_as_error();
  impl_->comm = comm;
  MPI_Comm_rank(comm, &impl_->rank);
  impl_->folder = std::move(folder);
  impl_->frames = std::move(earlier);
  in_agreement(comm, impl_->rank == 0, [&] {
    std::error_code code;
    fs::create_directories(impl_->folder / "fields", code);
    if (code) throw coupling::SystemError(cannot_write(impl_->folder / "fields", code.value()));
    for (const char* index : {"fields.h5", "fields.xdmf"}) {  // of an earlier run: would list frames now overwritten
      fs::remove(impl_->folder / index, code);
      if (code) throw coupling::SystemError(cannot_write(impl_->folder / index, code.value()));
    }
    if (impl_->frames.empty()) return;
    std::size_t later = impl_->frames.size();
    while (fs::remove(impl_->folder / "fields" / (frame_number(later) + ".h5"), code)) ++later;
    write_indices(impl_->folder, impl_->frames);
  });
}

FieldWriter::~FieldWriter() = default;

int FieldWriter::frames() const { return static_cast<int>(impl_->frames.size()); }

const std::vector<FrameRecord>& FieldWriter::records() const { return impl_->frames; }

void FieldWriter::write(const FieldFrame& frame) {
  const std::size_t count = frame.pressure.size();
  assert(frame.position.size() == 3 * count && frame.velocity.size() == 3 * count);
  assert(frame.type.size() == count && frame.body_tag.size() == count);

  const MPI_Comm comm = impl_->comm;
  const auto local = static_cast<std::int64_t>(count);
  std::int64_t particles = 0;
  std::int64_t first = 0;
  MPI_Allreduce(&local, &particles, 1, MPI_INT64_T, MPI_SUM, comm);
  MPI_Exscan(&local, &first, 1, MPI_INT64_T, MPI_SUM, comm);
  if (impl_->rank == 0) first = 0;

  const bool wide = particles > std::numeric_limits<std::int32_t>::max();
  const auto narrow_ids = numbered<std::int32_t>(first, wide ? 0 : count);
  const auto wide_ids = numbered<std::int64_t>(first, wide ? count : 0);
  const Datasets datasets =
      datasets_of(frame, wide ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32,
                  wide ? std::as_bytes(std::span(wide_ids)) : std::as_bytes(std::span(narrow_ids)));

  const fs::path path = impl_->folder / "fields" / (frame_number(impl_->frames.size()) + ".h5");
  const fs::path part = beside(path);
  auto records = impl_->frames;
  records.push_back({frame.time, frame.step, particles});
  try {
    std::array<std::int64_t, dataset_count> starts{};
    in_agreement(comm, impl_->rank == 0, [&] { starts = lay_out(part, frame, datasets, particles); });
    MPI_Bcast(starts.data(), static_cast<int>(starts.size()), MPI_INT64_T, 0, comm);
    in_agreement(comm, local > 0, [&] { write_slabs(part, datasets, starts, first); });
    in_agreement(comm, impl_->rank == 0, [&] {
      move_into_place(path);
      write_indices(impl_->folder, records);
    });
  } catch (const coupling::SystemError&) {
    if (impl_->rank == 0) {  // give the space back: the frames before stay readable
      std::error_code ignored;
      fs::remove(part, ignored);
      fs::remove(beside(impl_->folder / "fields.h5"), ignored);
    }
    throw;
  }
  impl_->frames = std::move(records);
}

}  // namespace embacle::mps
