#include <fmt/format.h>

#include "embacle/liggghts/driver.hpp"

namespace embacle::liggghts {

std::string to_json(const SolidReport& report) {
  return fmt::format(R"({{
  "coupled": {},
  "ranks": {},
  "bodies": {},
  "covering_spheres": {},
  "simulated_seconds": {},
  "windows": {},
  "sub_steps": {{"total": {}, "fewest_per_window": {}, "mean_per_window": {}, "most_per_window": {}}},
  "resolved_windows": {},
  "skin_limited_windows": {},
  "wall_seconds": {{"script": {}, "steps": {}, "waiting": {}, "total": {}}},
  "link": {{"windows": {}, "messages_sent": {}, "bytes_sent": {}, "plan_messages_sent": {}}}
}})",
                     report.coupled, report.ranks, report.bodies, report.covering_spheres, report.simulated_seconds,
                     report.windows, report.sub_steps, report.fewest_sub_steps, report.mean_sub_steps(),
                     report.most_sub_steps, report.resolved_windows, report.skin_limited_windows, report.script_seconds,
                     report.step_seconds, report.waiting_seconds, report.total_seconds, report.counters.windows,
                     report.counters.messages_sent, report.counters.bytes_sent, report.counters.plan_messages_sent);
}

}  // namespace embacle::liggghts
