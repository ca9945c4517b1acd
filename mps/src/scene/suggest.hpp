// Messages that help: the nearest right name, and all problems of a scene in one error.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::mps {
namespace detail {

/// Lower case, with - and blanks as _.
[[nodiscard]] inline std::string normalised(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-' || c == ' ') c = '_';
  }
  return result;
}

/// Fewest insertions, deletions, substitutions and swaps of neighbours that turn a into b (optimal string alignment).
[[nodiscard]] inline std::size_t typing_errors(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace detail

/// The candidate that `name` was probably meant to be (few typing errors away, or a part of it); empty if none is near.
[[nodiscard]] inline std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t longest_name = 80;  // longer ones are no typing errors, and the search is quadratic
  if (name.empty() || name.size() > longest_name) return {};
  const std::string wanted = detail::normalised(name);
  const std::size_t tolerated = 1 + (wanted.size() - 1) / 4;
  std::size_t fewest = tolerated + 1;
  std::string best;
  for (const std::string& candidate : candidates) {
    const std::size_t errors = detail::typing_errors(wanted, detail::normalised(candidate));
    if (errors >= std::max(wanted.size(), candidate.size()) || errors >= fewest) continue;
    fewest = errors;
    best = candidate;
  }
  if (!best.empty() || wanted.size() < 3) return best;
  double largest_share = 0;
  for (const std::string& candidate : candidates) {
    const std::string other = detail::normalised(candidate);
    const auto [shorter, longer] = std::minmax(wanted, other, [](auto& a, auto& b) { return a.size() < b.size(); });
    const double share = static_cast<double>(shorter.size()) / static_cast<double>(longer.size());
    if (shorter.size() < 3 || longer.find(shorter) == std::string::npos || share <= largest_share) continue;
    largest_share = share;
    best = candidate;
  }
  return best;
}

/// "a, b, c".
[[nodiscard]] inline std::string join(const std::vector<std::string>& words) {
  std::string result;
  for (const std::string& word : words) result += (result.empty() ? "" : ", ") + word;
  return result;
}

/// "; did you mean 'density'?" or nothing.
[[nodiscard]] inline std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string candidate = nearest(name, candidates);
  return candidate.empty() ? "" : "; did you mean '" + candidate + "'?";
}

/// "; did you mean 'b'? allowed: a, b", with `heading` in place of "allowed", and "none" for an empty list.
[[nodiscard]] inline std::string suggestion(std::string_view name, const std::vector<std::string>& candidates,
                                            std::string_view heading = "allowed") {
  const std::string question = did_you_mean(name, candidates);
  return question + (question.empty() ? "; " : " ") + std::string(heading) + ": " +
         (candidates.empty() ? "none" : join(candidates));
}

/// Collects problems and throws them together.
class Problems {
 public:
  /// `location`: "scene.toml:12" or "--set key=value"; `line` orders the report; `key`: dotted path of the key.
  /// Without text the key just counts as not sound: what is wrong with it is reported elsewhere.
  void add(std::string location, int line, std::string key, std::string text) {
    problems_.push_back({std::move(location), line, std::move(key), std::move(text)});
  }

  /// Whether neither `key`, nor anything below it, nor a section that holds it has a problem.
  [[nodiscard]] bool none_at(std::string_view key) const {
    const auto holds = [](std::string_view outer, std::string_view inner) {
      return inner.starts_with(outer) &&
             (inner.size() == outer.size() || inner[outer.size()] == '.' || inner[outer.size()] == '[');
    };
    return std::none_of(problems_.begin(), problems_.end(), [&](const Problem& problem) {
      return !problem.key.empty() && (holds(key, problem.key) || holds(problem.key, key));
    });
  }

  /// Throws coupling::InputError with the first ten, one a line, in the order of the file.
  void throw_if_any() const {
    std::vector<Problem> sorted;
    std::copy_if(problems_.begin(), problems_.end(), std::back_inserter(sorted),
                 [](const Problem& problem) { return !problem.text.empty(); });
    if (sorted.empty()) return;
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.line < b.line; });
    constexpr std::size_t most = 10;
    std::string message;
    for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
      const Problem& problem = sorted[i];
      message += (i == 0 ? "" : "\n") + problem.location + ": ";
      if (!problem.key.empty()) message += problem.key + ": ";
      message += problem.text;
    }
    if (sorted.size() > most) message += "\n... and " + std::to_string(sorted.size() - most) + " more";
    throw coupling::InputError(message);
  }

 private:
  struct Problem {
    std::string location;
    int line;
    std::string key;
    std::string text;
  };
  std::vector<Problem> problems_;
};

}  // namespace embacle::mps
