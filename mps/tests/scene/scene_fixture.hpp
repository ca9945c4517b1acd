// What the tests of the scene reader share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"
#include "scene/reader.hpp"

namespace embacle::mps {

namespace fs = std::filesystem;

inline const fs::path here = fs::path(__FILE__).parent_path();
inline const fs::path scenes = here / "scenes";

inline std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  EXPECT_TRUE(stream) << file;
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline void write(const fs::path& file, const std::string& text) {
  fs::remove(file);  // a fresh file: some file systems flush a truncated one to disk, which is slow
  std::ofstream(file, std::ios::binary) << text;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// The message with which reading ends; empty if it succeeds.
inline std::string message_of(const fs::path& scene, const std::vector<std::string>& overrides = {}) {
  try {
    (void)read_scene(scene, overrides);
    return {};
  } catch (const coupling::InputError& error) {
    EXPECT_EQ(error.status(), coupling::ExitStatus::input);
    return error.what();
  }
}

/// A folder of its own with the files that full.toml refers to.
class SceneFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("scene_test_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    for (const char* file : {"in.blocks", "paddle.csv", "flap.csv", "start.csv", "flood.csv", "block.stl"})
      fs::copy_file(scenes / file, folder_ / file, fs::copy_options::overwrite_existing);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path scene(const std::string& text) const {
    write(folder_ / "scene.toml", text);
    return folder_ / "scene.toml";
  }
  std::string error(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    std::string message = message_of(scene(text), overrides);
    const std::string shown = folder_.string() + "/";
    for (auto at = message.find(shown); at != std::string::npos; at = message.find(shown))
      message.erase(at, shown.size());
    return message;
  }
  /// The message for full.toml with one piece replaced.
  std::string error_with(const std::string& from, const std::string& to) const {
    return error(replaced(full_, from, to));
  }

  fs::path folder_;
  const std::string full_ = text_of(scenes / "full.toml");
  const std::string flat_ = text_of(scenes / "flat.toml");
};

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
#define EXPECT_HAS(text, part) EXPECT_PRED2(has, text, part)

}  // namespace embacle::mps
