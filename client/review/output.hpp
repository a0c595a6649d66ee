// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace eti::review {

/// A file that cannot be written; the text names it, and says why and what to do.
class ExportError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws ExportError where there is such a file: nothing is replaced. `option` names it otherwise.
void refuse_existing(const std::filesystem::path& path, std::string_view option);

/// Writes a file that shows under its name only when it is complete, in place of one that is there; makes its
/// folder. Throws ExportError, or as make_folder() does.
void write_file(const std::filesystem::path& path, std::string_view text, std::string_view option);

/// The same, but throws also for a file that is there already.
void write_new_file(const std::filesystem::path& path, std::string_view text, std::string_view option);

/// As an element's text or an attribute's value in HTML.
[[nodiscard]] std::string html_text(std::string_view text);

/// As a value of CSV (RFC 4180), quoted.
[[nodiscard]] std::string csv_text(std::string_view text);

/// As a value of JSON, which has no NaN: null instead.
[[nodiscard]] nlohmann::ordered_json number_or_null(double value);

}  // namespace eti::review
