#include "checkpoint.hpp"

#include <array>

#include "hdf5_file.hpp"

namespace embacle::mps {
namespace {

namespace fs = std::filesystem;

/// Raised when the meaning of what stands in a checkpoint changes.
constexpr std::int64_t format_version = 4;
constexpr const char* format_name = "embacle_checkpoint";

hid_t type_of(const CheckpointTable& table) {
  return std::holds_alternative<std::vector<double>>(table.values) ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

std::span<const std::byte> bytes_of(const CheckpointTable& table) {
  return std::visit([](const auto& values) { return std::as_bytes(std::span(values)); }, table.values);
}

void write_text(hid_t file, const std::string& name, const std::string& text, const fs::path& path) {
  const Handle type(check(H5Tcopy(H5T_C_S1), path), H5Tclose);
  check(H5Tset_size(type, std::max<std::size_t>(1, text.size())), path);
  const Handle space(check(H5Screate(H5S_SCALAR), path), H5Sclose);
  const Handle set(check(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), path),
                   H5Dclose);
  check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), path);
}

/// Rank 0: all that is small, then the empty tables, space reserved. Returns where each table starts in the file.
std::vector<std::int64_t> lay_out(const fs::path& path, const CheckpointContent& content,
                                  const std::vector<std::int64_t>& rows) {
  std::vector<std::int64_t> starts;
  write_hdf5(path, [&](hid_t file) {
    write_attribute(file, format_name, H5T_NATIVE_INT64, &format_version, path);
    for (const auto& [name, value] : content.numbers)
      write_attribute(file, name.c_str(), H5T_NATIVE_DOUBLE, &value, path);
    for (const auto& [name, value] : content.counts)
      write_attribute(file, name.c_str(), H5T_NATIVE_INT64, &value, path);
    for (const auto& [name, values] : content.lists) write_list(file, name.c_str(), H5T_NATIVE_DOUBLE, values, path);
    for (const auto& [name, text] : content.texts) write_text(file, name, text, path);
    const Handle plan(check(H5Pcreate(H5P_DATASET_CREATE), path), H5Pclose);
    check(H5Pset_layout(plan, H5D_CONTIGUOUS), path);
    check(H5Pset_alloc_time(plan, H5D_ALLOC_TIME_EARLY), path);
    check(H5Pset_fill_time(plan, H5D_FILL_TIME_NEVER), path);
    for (std::size_t i = 0; i < content.tables.size(); ++i) {
      const CheckpointTable& table = content.tables[i];
      const std::array<hsize_t, 2> extent{static_cast<hsize_t>(rows[i]), table.width};
      const Handle space(check(H5Screate_simple(2, extent.data(), nullptr), path), H5Sclose);
      const Handle set(
          check(H5Dcreate2(file, table.name.c_str(), type_of(table), space, H5P_DEFAULT, plan, H5P_DEFAULT), path),
          H5Dclose);
      write_text_attribute(set, "columns", table.columns, path);
      starts.push_back(rows[i] > 0 ? static_cast<std::int64_t>(H5Dget_offset(set)) : 0);
    }
  });
  return starts;
}

/// Every rank: its rows of each table, down to the disk.
void write_rows(const fs::path& path, const CheckpointContent& content, const std::vector<std::int64_t>& starts,
                const std::vector<std::int64_t>& first) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC), path);
  int code = 0;
  for (std::size_t i = 0; i < starts.size() && code == 0; ++i) {
    const CheckpointTable& table = content.tables[i];
    const auto skipped = first[i] * static_cast<std::int64_t>(table.width * H5Tget_size(type_of(table)));
    code = write_at(file, bytes_of(table), starts[i] + skipped);
  }
  if (code == 0 && ::fsync(file) != 0) code = errno;
  if (const int closing = file.close(); code == 0) code = closing;
  if (code != 0) throw coupling::SystemError(cannot_write(path, code));
}

/// The old checkpoint becomes the previous one and the new one takes its place. The old one keeps its name until then,
/// by a second link to it; on a file system without links there is a moment with the previous one only.
void rotate(const fs::path& path) {
  const fs::path previous = previous_checkpoint(path);
  if (fs::exists(path)) {
    std::remove(beside(previous).c_str());
    const bool linked = ::link(path.c_str(), beside(previous).c_str()) == 0;
    if (std::rename((linked ? beside(previous) : path).c_str(), previous.c_str()) != 0)
      throw coupling::SystemError(cannot_write(previous, errno));
  }
  move_into_place(path);
  // The names are to survive a loss of power as well; a file system that cannot promise it is accepted.
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const Descriptor names(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), folder);
  ::fsync(names);
}

}  // namespace

fs::path checkpoint_path(const fs::path& folder) { return folder / "checkpoint.h5"; }

fs::path previous_checkpoint(const fs::path& path) {
  return path.parent_path() / (path.stem().string() + "-previous.h5");
}

void write_checkpoint(MPI_Comm comm, const fs::path& path, const CheckpointContent& content) {
  report_file_size_limit_as_error();
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  const int tables = static_cast<int>(content.tables.size());
  std::vector<std::int64_t> local(tables), rows(tables), first(tables), starts(tables);
  for (int i = 0; i < tables; ++i) {
    const CheckpointTable& table = content.tables[i];
    local[i] = static_cast<std::int64_t>(bytes_of(table).size() / (table.width * H5Tget_size(type_of(table))));
  }
  MPI_Allreduce(local.data(), rows.data(), tables, MPI_INT64_T, MPI_SUM, comm);
  MPI_Exscan(local.data(), first.data(), tables, MPI_INT64_T, MPI_SUM, comm);
  if (rank == 0) first.assign(tables, 0);
  const fs::path part = beside(path);
  try {
    in_agreement(comm, rank == 0, [&] { starts = lay_out(part, content, rows); });
    MPI_Bcast(starts.data(), tables, MPI_INT64_T, 0, comm);
    in_agreement(comm, true, [&] { write_rows(part, content, starts, first); });
    in_agreement(comm, rank == 0, [&] { rotate(path); });
  } catch (const coupling::SystemError&) {
    if (rank == 0) std::remove(part.c_str());
    throw;
  }
}

// ---------------------------------------------------------------------------------------------------------------------

struct CheckpointReader::Impl {
  explicit Impl(hid_t id) : file(id, H5Fclose) {}
  Handle file;
};

namespace {

[[noreturn]] void not_readable(const fs::path& path, const std::string& why) {
  const fs::path previous = previous_checkpoint(path);
  const bool another = path.filename() != previous.filename() && fs::exists(previous);
  throw coupling::InputError(path.string() + ": " + why +
                             (another ? "; the checkpoint before it is " + previous.string() : ""));
}

template <typename Result>
Result found(Result result, const fs::path& path, const std::string& name) {
  if (result < 0) not_readable(path, "has no " + name + ": it is damaged, or of another version of Embacle");
  return result;
}

void read_attribute(hid_t file, const std::string& name, hid_t type, void* value, const fs::path& path) {
  const QuietHdf5 quiet;
  const Handle attribute(found(H5Aopen(file, name.c_str(), H5P_DEFAULT), path, name), H5Aclose);
  found(H5Aread(attribute, type, value), path, name);
}

/// Rows and columns of a dataset; one column where it is a list.
std::array<hsize_t, 2> extent_of(hid_t set, const fs::path& path, const std::string& name) {
  const Handle space(found(H5Dget_space(set), path, name), H5Sclose);
  std::array<hsize_t, 2> extent{0, 1};
  const int dimensions = H5Sget_simple_extent_ndims(space);
  if (dimensions != 1 && dimensions != 2) not_readable(path, name + " is no table");
  found(H5Sget_simple_extent_dims(space, extent.data(), nullptr), path, name);
  return extent;
}

void read_rows(hid_t file, const std::string& name, hid_t type, std::int64_t first, std::int64_t count, void* out,
               std::size_t size, const fs::path& path) {
  const QuietHdf5 quiet;
  const Handle set(found(H5Dopen2(file, name.c_str(), H5P_DEFAULT), path, name), H5Dclose);
  const auto extent = extent_of(set, path, name);
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> block{static_cast<hsize_t>(count), extent[1]};
  if (first < 0 || count < 0 || start[0] + block[0] > extent[0] || size != block[0] * block[1])
    not_readable(path, name + " has not the size that the rest of the file says");
  if (count == 0) return;
  const Handle from(found(H5Dget_space(set), path, name), H5Sclose);
  found(H5Sselect_hyperslab(from, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr), path, name);
  const Handle to(found(H5Screate_simple(2, block.data(), nullptr), path, name), H5Sclose);
  found(H5Dread(set, type, to, from, H5P_DEFAULT, out), path, name);
}

}  // namespace

CheckpointReader::CheckpointReader(const fs::path& given) : path_(given) {
  if (fs::is_directory(given)) {
    path_ = checkpoint_path(given);
    if (!fs::exists(path_)) path_ = previous_checkpoint(path_);
    if (!fs::exists(path_)) {
      throw coupling::InputError("--restart: there is no checkpoint.h5 in the folder " + given.string() +
                                 " (see output.checkpoint_every)");
    }
  } else if (!fs::exists(given)) {
    throw coupling::InputError("--restart: there is no checkpoint " + given.string());
  }
  const QuietHdf5 quiet;
  const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) not_readable(path_, "is no whole HDF5 file (" + hdf5_reason() + ")");
  impl_ = std::make_unique<Impl>(file);
  if (count(format_name) != format_version)
    not_readable(path_, "is a checkpoint of another version of Embacle; continue it with that version");
}

CheckpointReader::~CheckpointReader() = default;

double CheckpointReader::number(const std::string& name) const {
  double value = 0;
  read_attribute(impl_->file, name, H5T_NATIVE_DOUBLE, &value, path_);
  return value;
}

std::int64_t CheckpointReader::count(const std::string& name) const {
  std::int64_t value = 0;
  read_attribute(impl_->file, name, H5T_NATIVE_INT64, &value, path_);
  return value;
}

std::vector<double> CheckpointReader::list(const std::string& name) const {
  const QuietHdf5 quiet;
  const Handle set(found(H5Dopen2(impl_->file, name.c_str(), H5P_DEFAULT), path_, name), H5Dclose);
  std::vector<double> values(extent_of(set, path_, name)[0]);
  if (!values.empty())
    found(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path_, name);
  return values;
}

std::string CheckpointReader::text(const std::string& name) const {
  const QuietHdf5 quiet;
  const Handle set(found(H5Dopen2(impl_->file, name.c_str(), H5P_DEFAULT), path_, name), H5Dclose);
  const Handle type(found(H5Dget_type(set), path_, name), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  found(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), path_, name);
  return text.c_str();  // an empty text is stored as one zero
}

std::int64_t CheckpointReader::rows(const std::string& table) const {
  const QuietHdf5 quiet;
  const Handle set(found(H5Dopen2(impl_->file, table.c_str(), H5P_DEFAULT), path_, table), H5Dclose);
  return static_cast<std::int64_t>(extent_of(set, path_, table)[0]);
}

void CheckpointReader::read(const std::string& table, std::int64_t first, std::int64_t count,
                            std::span<double> out) const {
  read_rows(impl_->file, table, H5T_NATIVE_DOUBLE, first, count, out.data(), out.size(), path_);
}

void CheckpointReader::read(const std::string& table, std::int64_t first, std::int64_t count,
                            std::span<std::int64_t> out) const {
  read_rows(impl_->file, table, H5T_NATIVE_INT64, first, count, out.data(), out.size(), path_);
}

}  // namespace embacle::mps
