// LIGGGHTS' errors as exceptions.
#pragma once

namespace embacle::liggghts {

/// Thrown by the script's command `quit`: ends the reading of the script.
struct ScriptQuit {};

}  // namespace embacle::liggghts
