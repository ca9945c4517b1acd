// The contact laws of laws/contact_law.hpp as LIGGGHTS models.
#pragma once

namespace embacle::liggghts {

/// Adds `model contact_ratio` and `model river_ice`, each with its own tangential model of the same name, to pair_style
/// gran and fix wall/gran, alone and with the stock tangential models. Every other combination with them throws
/// InputError. Calls after the first do nothing: LIGGGHTS has one list of models for all its instances.
void register_law_styles();

}  // namespace embacle::liggghts
