#include "csv.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "files.hpp"

namespace embacle::mps {
namespace {

/// The shortest text that reads back to the same double (at most 17 significant digits); whole numbers without
/// exponent.
void append_number(std::string& line, double value) {
  std::array<char, 32> digits{};
  const bool whole = std::abs(value) < 1e15 && value == std::trunc(value) && !(value == 0 && std::signbit(value));
  const auto end = whole ? std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<std::int64_t>(value))
                         : std::to_chars(digits.data(), digits.data() + digits.size(), value);
  line.append(digits.data(), end.ptr);
}

std::string quoted_if_needed(const std::string& name) {
  if (name.find_first_of(",\"\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

CsvWriter::CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns)
    : path_(std::move(path)), columns_(columns.size()) {
  report_file_size_limit_as_error();
  if (path_.has_parent_path()) {
    std::error_code code;
    std::filesystem::create_directories(path_.parent_path(), code);
    if (code) throw coupling::SystemError(cannot_write(path_, code.value()));
  }
  errno = 0;
  stream_.open(path_, std::ios::trunc | std::ios::binary);
  if (!stream_) throw coupling::SystemError(cannot_write(path_, errno));
  std::string line;
  for (const auto& column : columns) {
    if (!line.empty()) line += ',';
    line += quoted_if_needed(column);
  }
  stream_ << line << '\n';
  flush();
}

void CsvWriter::row(std::span<const double> values) {
  if (values.size() != columns_) {
    throw std::logic_error("a row of " + std::to_string(values.size()) + " values for the " + std::to_string(columns_) +
                           " columns of " + path_.string());
  }
  std::string line;
  for (const double value : values) {
    if (!line.empty()) line += ',';
    append_number(line, value);
  }
  line += '\n';
  stream_ << line;
  flush();
}

void CsvWriter::flush() {
  errno = 0;
  stream_.flush();
  if (!stream_) throw coupling::SystemError(cannot_write(path_, errno));
}

}  // namespace embacle::mps
