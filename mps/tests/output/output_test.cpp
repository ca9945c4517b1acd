// The output folder: fields that h5py and ParaView read back, tables and summaries, and what happens when a disk is
// full.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>

#include "embacle/coupling/types.hpp"
#include "output/csv.hpp"
#include "output/fields.hpp"
#include "output/summary.hpp"

namespace embacle::mps {
namespace {

namespace fs = std::filesystem;
using coupling::SystemError;

int world_rank() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}

int world_size() {
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// A fresh folder, the same on every rank, gone at the end of the test.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "embacle-output-XXXXXX").string();
    if (world_rank() == 0) {
      if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    }
    MPI_Bcast(name.data(), static_cast<int>(name.size()), MPI_CHAR, 0, MPI_COMM_WORLD);
    path_ = name;
  }
  ~Folder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (world_rank() == 0) fs::remove_all(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The fields that read_fields.py expects: rank r of R contributes 100 r particles, so rank 0 none; one rank, 50.
struct Particles {
  std::vector<float> position, velocity, pressure;
  std::vector<std::int8_t> type;
  std::vector<std::int32_t> body_tag;
  FieldFrame frame;

  explicit Particles(int index, int scale = 1) {
    const int rank = world_rank();
    const int count = scale * (world_size() == 1 ? 50 : 100 * rank);
    const int first = scale * 50 * rank * (rank - 1);
    for (int k = first; k < first + count; ++k) {
      for (const int value : {k, rank, index}) {
        position.push_back(static_cast<float>(value));
        velocity.push_back(2 * static_cast<float>(value));
      }
      pressure.push_back(static_cast<float>(k - 7));
      type.push_back(static_cast<std::int8_t>(k % 3));
      body_tag.push_back(k % 3 == 2 ? k : -1);
    }
    frame = {0.25 * index, 10 * index, position, velocity, pressure, type, body_tag};
  }
};

int total_particles() { return world_size() == 1 ? 50 : 50 * world_size() * (world_size() - 1); }

/// Runs a Python script of this folder on rank 0, outside MPI's environment; every rank gets its exit status.
int run_script(const std::string& interpreter, const std::string& script, const std::string& arguments) {
  int status = 0;
  if (world_rank() == 0) {
    const fs::path file = fs::path(__FILE__).parent_path() / script;
    status = std::system(
        fmt::format("env -i HOME=/tmp PATH=/usr/bin:/bin {} '{}' {}", interpreter, file.string(), arguments).c_str());
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return status;
}

int read_back(const fs::path& folder, int frames) {
  return run_script("/usr/bin/python3", "read_fields.py",
                    fmt::format("'{}' {} {}", folder.string(), world_size(), frames));
}

/// The message of the SystemError that writing gives on this rank; empty if it gives none.
std::string failure(FieldWriter& writer, const FieldFrame& frame) {
  try {
    writer.write(frame);
  } catch (const SystemError& error) {
    return error.what();
  }
  return {};
}

/// Within this scope this process can write no file beyond `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST(Fields, ReadBackInOrderOfRank) {
  const Folder folder;
  FieldWriter writer(MPI_COMM_WORLD, folder.path() / "run");
  for (int index = 0; index < 3; ++index) {
    writer.write(Particles(index).frame);
    EXPECT_EQ(writer.frames(), index + 1);
    EXPECT_EQ(read_back(folder.path() / "run", index + 1), 0);  // whole after every frame
  }
}

TEST(Fields, FrameWithoutParticles) {
  const Folder folder;
  FieldWriter writer(MPI_COMM_WORLD, folder.path());
  EXPECT_NO_THROW(writer.write(FieldFrame{}));
  EXPECT_EQ(writer.frames(), 1);
}

TEST(Fields, NewRunForgetsFramesOfAnEarlierOne) {
  const Folder folder;
  {
    FieldWriter writer(MPI_COMM_WORLD, folder.path());
    for (int index = 0; index < 2; ++index) writer.write(Particles(index).frame);
  }
  FieldWriter writer(MPI_COMM_WORLD, folder.path());
  EXPECT_FALSE(fs::exists(folder.path() / "fields.xdmf"));
  writer.write(Particles(0).frame);
  EXPECT_EQ(read_back(folder.path(), 1), 0);
}

// One rank after the other is the only one that cannot write: all must end with the same message, none may wait.
TEST(Fields, FailureOfAnyRankIsAnErrorOnAll) {
  const int size = world_size();
  for (int culprit = size > 1 ? 1 : 0; culprit <= size; ++culprit) {
    const int failing = culprit % size;
    const Folder folder;
    FieldWriter writer(MPI_COMM_WORLD, folder.path());
    writer.write(Particles(0).frame);
    const Particles large(1, 1000);
    std::string message;
    if (world_rank() == failing) {
      const FileSizeLimit limit(16384);
      message = failure(writer, large.frame);
    } else {
      message = failure(writer, large.frame);
    }
    EXPECT_NE(message.find(folder.path().string() + "/fields/000001.h5"), std::string::npos) << message;
    EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    EXPECT_EQ(writer.frames(), 1);
    EXPECT_EQ(read_back(folder.path(), 1), 0);  // what was there is still whole, and nothing half-written is left
    writer.write(Particles(1).frame);           // and once there is space again, the run can go on
    EXPECT_EQ(read_back(folder.path(), 2), 0);
  }
}

TEST(Fields, LimitBelowTheFirstByteIsSilentlyAnError) {
  const Folder folder;
  FieldWriter writer(MPI_COMM_WORLD, folder.path());
  testing::internal::CaptureStderr();
  std::string message;
  {
    const FileSizeLimit limit(0);
    message = failure(writer, Particles(0).frame);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // HDF5 must not print its error stack
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  writer.write(Particles(0).frame);
  EXPECT_EQ(read_back(folder.path(), 1), 0);
}

TEST(Fields, FullDisk) {
  if (world_size() > 1) GTEST_SKIP() << "mounts a small disk that only one process sees";
  const Folder folder;
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=256k") != 0) {
    GTEST_SKIP() << "needs the right to mount a small disk (root)";
  }
  const std::shared_ptr<const char> mounted(folder.path().c_str(), [](const char* at) { umount2(at, MNT_DETACH); });
  FieldWriter writer(MPI_COMM_WORLD, folder.path());
  writer.write(Particles(0).frame);
  const Particles large(1, 1000);
  EXPECT_NE(failure(writer, large.frame).find("No space left on device"), std::string::npos);
  EXPECT_EQ(read_back(folder.path(), 1), 0);
  std::ofstream(folder.path() / "filler") << std::string(1 << 20, 'x');  // now not a byte is left
  EXPECT_NE(failure(writer, Particles(1).frame).find("No space left on device"), std::string::npos);
  fs::remove(folder.path() / "filler");
  writer.write(Particles(1).frame);
  EXPECT_EQ(read_back(folder.path(), 2), 0);
}

TEST(Fields, FolderThatCannotBe) {
  const Folder folder;
  if (world_rank() == 0) std::ofstream(folder.path() / "file") << "not a folder";
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_THROW(FieldWriter(MPI_COMM_WORLD, folder.path() / "file"), SystemError);
}

TEST(Fields, OpensInParaView) {
  int found = 0;
  if (world_rank() == 0) found = fs::exists("/usr/bin/pvpython") ? 1 : 0;
  MPI_Bcast(&found, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (found == 0) GTEST_SKIP() << "ParaView is not installed: ./embacle setup --paraview installs it";
  const Folder folder;
  FieldWriter writer(MPI_COMM_WORLD, folder.path());
  for (int index = 0; index < 2; ++index) writer.write(Particles(index).frame);
  EXPECT_EQ(run_script("/usr/bin/pvpython", "read_in_paraview.py",
                       fmt::format("'{}' {} 2", folder.path().string(), total_particles())),
            0);
}

fs::path own_file(const Folder& folder, const char* name) {
  return folder.path() / std::to_string(world_rank()) / name;
}

TEST(Csv, ReadsBackToTheSameNumbers) {
  const Folder folder;
  const fs::path path = own_file(folder, "table.csv");
  CsvWriter writer(path, {"t [s]", "tag [-]", "x, y [m]"});
  writer.row(std::vector{0.1, 1234567.0, 1.0 / 3.0});
  EXPECT_EQ(text_of(path), "t [s],tag [-],\"x, y [m]\"\n0.1,1234567,0.3333333333333333\n");  // there at once
  writer.row(std::vector{-0.0, 1e300, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_NE(text_of(path).find("-0,1e+300,nan\n"), std::string::npos);
  EXPECT_EQ(std::stod("0.3333333333333333"), 1.0 / 3.0);
  EXPECT_THROW(writer.row(std::vector{1.0, 2.0}), std::logic_error);
}

TEST(Csv, FailuresNameThePath) {
  try {
    CsvWriter writer("/dev/full", {"t [s]"});
    FAIL() << "a full disk went unnoticed";
  } catch (const SystemError& error) {
    EXPECT_STREQ(error.what(), "cannot write /dev/full: No space left on device");
  }
  const Folder folder;
  CsvWriter writer(own_file(folder, "limited.csv"), {"t [s]"});
  const FileSizeLimit limit(64);
  const auto fill = [&] {
    for (int i = 0; i < 64; ++i) writer.row(std::vector{1.0});
  };
  EXPECT_THROW(fill(), SystemError);
}

TEST(Summary, OrderedNestedAndEscaped) {
  Json json;
  json.set("title", "a \"quoted\"\nback\\slash").set("steps", 3).set("wall time [s]", 0.1).set("done", true);
  json.set("gravity", Json::Array{0, 0, -9.81}).set("warnings", std::vector<std::string>{"one", "two"});
  json.set("endless", std::numeric_limits<double>::infinity());
  json.object("phases").set("search", 0.25);
  json.object("phases").set("forces", 0.5);
  json.append("bodies").set("tag", 1);
  json.append("bodies").set("tag", 2);
  json.set("steps", std::int64_t{1} << 40);
  EXPECT_EQ(json.text(), R"({
  "title": "a \"quoted\"\nback\\slash",
  "steps": 1099511627776,
  "wall time [s]": 0.1,
  "done": true,
  "gravity": [0, 0, -9.81],
  "warnings": ["one", "two"],
  "endless": null,
  "phases": {
    "search": 0.25,
    "forces": 0.5
  },
  "bodies": [
    {
      "tag": 1
    },
    {
      "tag": 2
    }
  ]
})");
}

TEST(Summary, FileIsWholeOrAsBefore) {
  const Folder folder;
  const fs::path path = folder.path() / ("summary" + std::to_string(world_rank()) + ".json");
  write_json(path, Json().set("run", 1));
  const std::string before = text_of(path);
  EXPECT_EQ(before, "{\n  \"run\": 1\n}\n");
  {
    const FileSizeLimit limit(16);
    EXPECT_THROW(write_json(path, Json().set("run", std::string(4096, 'x'))), SystemError);
  }
  EXPECT_EQ(text_of(path), before);
  EXPECT_FALSE(fs::exists(path.string() + ".part"));
  EXPECT_THROW(write_json(folder.path() / "missing" / "summary.json", Json()), SystemError);
}

}  // namespace
}  // namespace embacle::mps
