// Reads a scene file strictly: unknown keys, wrong types, wrong units and values out of range are errors that name
// file, line, key, what is allowed and the nearest right name. One schema drives reading, checking and the reference
// page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace embacle::mps {

/// `path` is a scene file or a folder that holds scene.toml. `overrides`: "key.path=value" (value as in TOML; a bare
/// word or quantity such as 2.5cm is taken as a string), applied before checking; array elements of named tables are
/// addressed by name (water.upstream.level). Throws coupling::InputError.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides = {});

/// The reference page of all keys (Markdown), generated from the schema.
[[nodiscard]] std::string scene_reference();

}  // namespace embacle::mps
