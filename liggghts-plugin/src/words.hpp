// Reading the arguments of a style: words in order, strict numbers, unknown keywords answered with what is allowed.
#pragma once

#include <string>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::liggghts {

/// The member of `allowed` with the smallest edit distance to `word`; empty if none is close.
std::string nearest_word(const std::string& word, const std::vector<std::string>& allowed);

/// Strict number: the whole text must be one finite number. Returns false otherwise.
bool parse_number(const std::string& text, double& value);

/// The words of one command, read in order. Every error is an InputError that begins with `where`.
class Words {
 public:
  Words(std::string where, std::vector<std::string> words) : where_(std::move(where)), words_(std::move(words)) {}

  [[nodiscard]] bool empty() const { return next_ == words_.size(); }
  /// The next word without taking it; empty string at the end.
  [[nodiscard]] std::string peek() const { return empty() ? std::string() : words_[next_]; }
  /// Takes the next word; `what` says what was expected, for the message if there is none.
  std::string word(const std::string& what);
  double number(const std::string& what);
  double positive_number(const std::string& what);
  coupling::Vec3 vector(const std::string& what);
  /// An integer of at least `least`.
  int integer(const std::string& what, int least);

  [[noreturn]] void fail(const std::string& message) const;
  [[noreturn]] void fail_unknown(const std::string& what, const std::string& word,
                                 const std::vector<std::string>& allowed) const;

 private:
  std::string where_;
  std::vector<std::string> words_;
  std::size_t next_ = 0;
};

}  // namespace embacle::liggghts
