// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace eti::review {

/// A file that cannot be written; the message names it, the cause and the remedy.
class ExportError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Throws ExportError if the file exists: nothing is overwritten. `option`: the option that chooses another
/// name.
void refuse_existing(const std::filesystem::path& path, std::string_view option);

/// Writes a file atomically: it appears under its name only when complete, replacing an existing one;
/// creates its folder. Throws ExportError, or as make_folder() does.
void write_file(const std::filesystem::path& path, std::string_view text, std::string_view option);

/// The same, but also throws if the file exists.
void write_new_file(const std::filesystem::path& path, std::string_view text, std::string_view option);

/// Escapes text for HTML elements and attribute values.
[[nodiscard]] std::string html_text(std::string_view text);

/// A whole page that loads nothing. `title`: plain text; `body`: HTML.
[[nodiscard]] std::string html_page(std::string_view title, std::string_view body);

/// Quotes text as a CSV value (RFC 4180). Text that a spreadsheet would run as a formula (it begins with =,
/// +,
/// -, @, tab or carriage return) gets an apostrophe in front.
[[nodiscard]] std::string csv_text(std::string_view text);

/// A JSON number, or null for NaN, which JSON lacks.
[[nodiscard]] nlohmann::ordered_json number_or_null(double value);

}  // namespace eti::review
