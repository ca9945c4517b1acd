#include "csv.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <iterator>
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

CsvWriter::CsvWriter(std::filesystem::path path, const std::vector<std::string>& columns,
                     std::optional<double> keep_until)
    : path_(std::move(path)), columns_(columns.size()) {
  report_file_size_limit_as_error();
  if (path_.has_parent_path()) {
    std::error_code code;
    std::filesystem::create_directories(path_.parent_path(), code);
    if (code) throw coupling::SystemError(cannot_write(path_, code.value()));
  }
  std::string line;
  for (const auto& column : columns) {
    if (!line.empty()) line += ',';
    line += quoted_if_needed(column);
  }
  line += '\n';
  std::error_code ignored;
  const bool continued = keep_until && std::filesystem::file_size(path_, ignored) > 0 && !ignored;
  if (continued) drop_rows_after(*keep_until, line);
  errno = 0;
  stream_.open(path_, (continued ? std::ios::app : std::ios::trunc) | std::ios::binary);
  if (!stream_) throw coupling::SystemError(cannot_write(path_, errno));
  if (!continued) stream_ << line;
  flush();
}

/// Cuts the file behind its last row of interest: the first values rise, and a row without its end is none.
void CsvWriter::drop_rows_after(double last, const std::string& header) const {
  std::ifstream file(path_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!text.starts_with(header)) {
    throw coupling::InputError(path_.string() +
                               ": cannot be continued, its columns are not those of this run; choose another folder");
  }
  std::size_t kept = header.size();
  for (std::size_t end = 0; (end = text.find('\n', kept)) != std::string::npos; kept = end + 1) {
    double first = 0;
    const auto [next, error] = std::from_chars(text.data() + kept, text.data() + end, first);
    if (error != std::errc{} || first > last) break;
  }
  std::error_code code;
  std::filesystem::resize_file(path_, kept, code);
  if (code) throw coupling::SystemError(cannot_write(path_, code.value()));
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
