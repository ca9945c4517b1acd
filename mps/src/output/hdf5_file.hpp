// What the writers of HDF5 files share. Included by fields.cpp and checkpoint.cpp only.
//
// Why no collective I/O: HDF5's and MPI-IO's collective calls may wait for ever when one rank fails in their midst
// (disk full, quota, too many open files). Here rank 0 alone creates a file, with contiguous datasets whose space
// is reserved; then every rank writes its own slab of each dataset to the dataset's place in the file. Each rank's slab
// is one contiguous piece, which collective buffering could not improve, and every error is local, with its errno,
// until all ranks agree on it.
//
// Why HDF5 writes to memory: a file that HDF5 cannot flush can never be closed either, and crashes the program at its
// end. So HDF5 lays a file out in memory, where only its few kilobytes of metadata take room, and these are then
// written to disk.
#pragma once

#include <fcntl.h>
#include <hdf5.h>
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files.hpp"

namespace embacle::mps {

/// An HDF5 identifier, closed at the end of its scope.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close(); }
  operator hid_t() const { return id_; }  // NOLINT: stands for the identifier in HDF5 calls
  herr_t close() {
    const hid_t id = std::exchange(id_, H5I_INVALID_HID);
    return id < 0 ? 0 : closer_(id);
  }

 private:
  hid_t id_;
  Closer closer_;
};

/// HDF5 prints its error stack by default; within this scope it does not.
class QuietHdf5 {
 public:
  QuietHdf5() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// The innermost reason on HDF5's error stack, preferably the operating system's.
inline std::string hdf5_reason() {
  std::string reason;
  const auto first = [](unsigned depth, const H5E_error2_t* error, void* out) -> herr_t {
    if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first, &reason);
  const std::string mark = "error message = '";
  if (const auto start = reason.find(mark); start != std::string::npos) {
    const auto begin = start + mark.size();
    return reason.substr(begin, reason.find('\'', begin) - begin);
  }
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

/// Throws the SystemError of an HDF5 call that failed (negative result); passes the result on otherwise.
template <typename Result>
Result check(Result result, const std::filesystem::path& path) {
  if (result < 0) throw coupling::SystemError("cannot write " + path.string() + ": " + hdf5_reason());
  return result;
}

/// A file descriptor, closed at the end of its scope.
class Descriptor {
 public:
  Descriptor(int descriptor, const std::filesystem::path& path) : descriptor_(descriptor) {
    if (descriptor < 0) throw coupling::SystemError(cannot_write(path, errno));
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  operator int() const { return descriptor_; }  // NOLINT: stands for the descriptor in system calls
  [[nodiscard]] int close() { return ::close(std::exchange(descriptor_, -1)) == 0 ? 0 : errno; }

 private:
  int descriptor_;
};

/// errno, or 0 if all of `data` stands in the file at `offset`.
inline int write_at(int file, std::span<const std::byte> data, std::int64_t offset) {
  while (!data.empty()) {
    const ssize_t written = ::pwrite(file, data.data(), data.size(), offset);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    data = data.subspan(static_cast<std::size_t>(written));
    offset += written;
  }
  return 0;
}

/// Makes `size` bytes of a file certain, so that a full disk, quota or size limit shows before anybody writes; a file
/// system that cannot reserve is accepted. Returns errno or 0.
inline int reserve(int file, std::int64_t size) {
  if (::ftruncate(file, size) != 0) return errno;
  if (::fallocate(file, 0, 0, size) == 0 || errno == EOPNOTSUPP || errno == ENOSYS) return 0;
  return errno;
}

inline void* resized(void* kept, std::size_t size) {
  auto& bytes = *static_cast<std::vector<std::byte>*>(kept);
  bytes.resize(size);
  return bytes.data();
}

/// What HDF5's core driver keeps of a file: these callbacks let the bytes outlive the closing of the file.
inline H5FD_file_image_callbacks_t keep_in(std::vector<std::byte>& image) {
  H5FD_file_image_callbacks_t callbacks{};
  callbacks.image_malloc = [](std::size_t size, H5FD_file_image_op_t, void* kept) { return resized(kept, size); };
  callbacks.image_realloc = [](void*, std::size_t size, H5FD_file_image_op_t, void* kept) {
    return resized(kept, size);
  };
  callbacks.image_memcpy = [](void* to, const void* from, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::memcpy(to, from, size);
  };
  callbacks.image_free = [](void*, H5FD_file_image_op_t, void*) -> herr_t { return 0; };
  callbacks.udata_copy = [](void* kept) { return kept; };
  callbacks.udata_free = [](void*) -> herr_t { return 0; };
  callbacks.udata = &image;
  return callbacks;
}

/// Writes the HDF5 file that `build` fills. Datasets into which `build` writes nothing take no memory, but have their
/// space on the disk.
template <typename Build>
void write_hdf5(const std::filesystem::path& path, Build build) {
  std::vector<std::byte> image;
  hsize_t size = 0;
  {
    const QuietHdf5 quiet;
    auto callbacks = keep_in(image);
    const Handle access(check(H5Pcreate(H5P_FILE_ACCESS), path), H5Pclose);
    check(H5Pset_fapl_core(access, 4096, false), path);
    check(H5Pset_file_image_callbacks(access, &callbacks), path);
    check(H5Pset_meta_block_size(access, 32768), path);  // metadata first, all together: the image ends with them
    Handle file(check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), path), H5Fclose);
    build(static_cast<hid_t>(file));
    check(H5Fget_filesize(file, &size), path);
    check(file.close(), path);
  }
  Descriptor disk(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), path);
  int code = reserve(disk, static_cast<std::int64_t>(std::max<std::uint64_t>(size, image.size())));
  if (code == 0) code = write_at(disk, image, 0);
  if (const int closing = disk.close(); code == 0) code = closing;
  if (code != 0) throw coupling::SystemError(cannot_write(path, code));
}

inline void write_attribute(hid_t object, const char* name, hid_t type, const void* value,
                            const std::filesystem::path& path) {
  const Handle space(check(H5Screate(H5S_SCALAR), path), H5Sclose);
  const Handle attribute(check(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), path), H5Aclose);
  check(H5Awrite(attribute, type, value), path);
}

inline void write_text_attribute(hid_t object, const char* name, const std::string& text,
                                 const std::filesystem::path& path) {
  const Handle type(check(H5Tcopy(H5T_C_S1), path), H5Tclose);
  check(H5Tset_size(type, text.size()), path);
  write_attribute(object, name, type, text.data(), path);
}

template <typename Value>
void write_list(hid_t file, const char* name, hid_t type, const std::vector<Value>& values,
                const std::filesystem::path& path) {
  const hsize_t size = values.size();
  const Handle space(check(H5Screate_simple(1, &size, nullptr), path), H5Sclose);
  const Handle set(check(H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), path), H5Dclose);
  check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
}

/// Runs `work` where `active`; an error on any rank becomes a SystemError on every rank.
template <typename Work>
void in_agreement(MPI_Comm comm, bool active, Work work) {
  std::string error;
  if (active) {
    try {
      work();
    } catch (const std::exception& failure) {
      error = failure.what();
    }
  }
  throw_on_all_if_any(comm, error);
}

}  // namespace embacle::mps
