#include "words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace embacle::liggghts {

namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& allowed) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : allowed) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

bool parse_number(const std::string& text, double& value) {
  const char* begin = text.data() + (!text.empty() && text.front() == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end && begin != end && std::isfinite(value);
}

std::string Words::word(const std::string& what) {
  if (empty()) fail(fmt::format("{} is missing at the end of the command", what));
  return words_[next_++];
}

double Words::number(const std::string& what) {
  const std::string text = word(what);
  double value = 0;
  if (!parse_number(text, value)) fail(fmt::format("{} must be a number, not '{}'", what, text));
  return value;
}

double Words::positive_number(const std::string& what) {
  const double value = number(what);
  if (value <= 0) fail(fmt::format("{} must be greater than zero, not {}", what, value));
  return value;
}

coupling::Vec3 Words::vector(const std::string& what) {
  coupling::Vec3 value;
  for (int k = 0; k < 3; ++k) value[k] = number(fmt::format("{} ({} component)", what, "xyz"[k]));
  return value;
}

int Words::integer(const std::string& what, int least) {
  const std::string text = word(what);
  int value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value < least) {
    fail(fmt::format("{} must be a whole number of at least {}, not '{}'", what, least, text));
  }
  return value;
}

void Words::fail(const std::string& message) const { throw coupling::InputError(where_ + ": " + message); }

void Words::fail_unknown(const std::string& what, const std::string& word,
                         const std::vector<std::string>& allowed) const {
  const std::string near = nearest_word(word, allowed);
  fail(fmt::format("unknown {} '{}'{}; allowed: {}", what, word,
                   near.empty() ? "" : fmt::format(" (did you mean '{}'?)", near), fmt::join(allowed, ", ")));
}

}  // namespace embacle::liggghts
