// What of a scene a checkpoint depends on, as text to compare.
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace embacle::mps {

/// One line `key = value` for every setting that a restart must not change: all but the title, parameters, [run],
/// [output], [[gauge]], [coupling] and numerics.rebalance_imbalance.
[[nodiscard]] std::string lasting_settings(const Scene& scene);

/// Throws InputError if `now` differs from `then` (of the checkpoint `file`); the message names the first few keys with
/// both values.
void compare_settings(const Scene& scene, const std::string& now, const std::string& then, const std::string& file);

}  // namespace embacle::mps
